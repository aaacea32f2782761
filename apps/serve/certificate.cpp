#include "apps/serve/certificate.h"

#include <array>
#include <ctime>
#include <memory>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gnutls/crypto.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <unistd.h>

#include "base/input_file.h"

namespace headpin::apps {

namespace {

constexpr std::size_t kMostPem = 1'000'000;
constexpr std::time_t kDay = 86'400;

void require(int code) {
  if (code < 0) {
    throw std::runtime_error(std::string("cannot make a certificate: ") + gnutls_strerror(code));
  }
}

using Key = std::unique_ptr<gnutls_x509_privkey_int, decltype(&gnutls_x509_privkey_deinit)>;
using Crt = std::unique_ptr<gnutls_x509_crt_int, decltype(&gnutls_x509_crt_deinit)>;

Key new_key() {
  gnutls_x509_privkey_t raw = nullptr;
  require(gnutls_x509_privkey_init(&raw));
  Key key(raw, gnutls_x509_privkey_deinit);
  require(gnutls_x509_privkey_generate(raw, GNUTLS_PK_ECDSA,
                                       GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1), 0));
  return key;
}

/// The names that a browser may have in the address: the machine's own, and the number.
void name(gnutls_x509_crt_t crt, const std::string& address) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string_view name(host.data());
  require(gnutls_x509_crt_set_dn_by_oid(crt, GNUTLS_OID_X520_COMMON_NAME, 0, "headpin", 7));
  for (const std::string_view one : {name, std::string_view("localhost")}) {
    require(gnutls_x509_crt_set_subject_alt_name(crt, GNUTLS_SAN_DNSNAME, one.data(),
                                                 static_cast<unsigned>(one.size()),
                                                 GNUTLS_FSAN_APPEND));
  }
  std::array<unsigned char, 16> number{};
  for (const auto& [family, bytes] : {std::pair{AF_INET, 4u}, {AF_INET6, 16u}}) {
    if (inet_pton(family, address.c_str(), number.data()) != 1) continue;
    require(gnutls_x509_crt_set_subject_alt_name(crt, GNUTLS_SAN_IPADDRESS, number.data(), bytes,
                                                 GNUTLS_FSAN_APPEND));
  }
}

std::string as_pem(auto&& exported) {
  gnutls_datum_t out{};
  require(exported(&out));
  std::string text(reinterpret_cast<const char*>(out.data), out.size);
  gnutls_free(out.data);
  return text;
}

std::string fingerprint(gnutls_x509_crt_t crt) {
  std::array<unsigned char, 32> hash{};
  std::size_t size = hash.size();
  require(gnutls_x509_crt_get_fingerprint(crt, GNUTLS_DIG_SHA256, hash.data(), &size));
  return fmt::format("{:02X}", fmt::join(hash, ":"));
}

}  // namespace

Certificate self_signed(const std::string& address) {
  const Key key = new_key();
  gnutls_x509_crt_t raw = nullptr;
  require(gnutls_x509_crt_init(&raw));
  const Crt crt(raw, gnutls_x509_crt_deinit);
  std::array<unsigned char, 16> serial{};
  require(gnutls_rnd(GNUTLS_RND_NONCE, serial.data(), serial.size()));
  serial[0] &= 0x7f;  // it is a positive number
  const std::time_t now = std::time(nullptr);
  require(gnutls_x509_crt_set_version(raw, 3));
  require(gnutls_x509_crt_set_serial(raw, serial.data(), serial.size()));
  require(gnutls_x509_crt_set_activation_time(raw, now - kDay));
  require(gnutls_x509_crt_set_expiration_time(raw, now + 90 * kDay));
  require(gnutls_x509_crt_set_key(raw, key.get()));
  name(raw, address);
  require(gnutls_x509_crt_set_key_usage(raw, GNUTLS_KEY_DIGITAL_SIGNATURE));
  require(gnutls_x509_crt_set_key_purpose_oid(raw, GNUTLS_KP_TLS_WWW_SERVER, 0));
  require(gnutls_x509_crt_sign2(raw, raw, key.get(), GNUTLS_DIG_SHA256, 0));
  return {.certificate = as_pem([&](gnutls_datum_t* out) {
            return gnutls_x509_crt_export2(raw, GNUTLS_X509_FMT_PEM, out);
          }),
          .key = as_pem([&](gnutls_datum_t* out) {
            return gnutls_x509_privkey_export2(key.get(), GNUTLS_X509_FMT_PEM, out);
          }),
          .sha256 = fingerprint(raw)};
}

Certificate read_certificate(const std::string& certificate, const std::string& key) {
  return {base::read_text(certificate, kMostPem), base::read_text(key, kMostPem), ""};
}

}  // namespace headpin::apps
