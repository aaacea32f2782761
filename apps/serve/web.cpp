#include "apps/serve/web.h"

#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "apps/command.h"
#include "apps/serve/guests.h"
#include "base/lock.h"

namespace headpin::apps {

namespace {

constexpr unsigned kMostConnections = 500;
constexpr unsigned kSilence = 20;            // s, after which a connection is closed
constexpr std::size_t kConnection = 32'768;  // bytes of memory for lines and headers
constexpr const char* kTooLong = "this is too long";

/// An address with its port, of either family.
struct Address {
  sockaddr_storage storage{};
  bool v6 = false;

  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

[[noreturn]] void refuse_address(const std::string& address) {
  throw UsageError(fmt::format(
      "--bind: expected an address of this machine, such as 127.0.0.1 or 0.0.0.0, found '{}'",
      address));
}

Address address_of(const std::string& text, int port) {
  Address out;
  auto* const v4 = reinterpret_cast<sockaddr_in*>(&out.storage);
  auto* const v6 = reinterpret_cast<sockaddr_in6*>(&out.storage);
  if (inet_pton(AF_INET, text.c_str(), &v4->sin_addr) == 1) {
    v4->sin_family = AF_INET;
    v4->sin_port = htons(static_cast<std::uint16_t>(port));
    return out;
  }
  if (inet_pton(AF_INET6, text.c_str(), &v6->sin6_addr) == 1) {
    v6->sin6_family = AF_INET6;
    v6->sin6_port = htons(static_cast<std::uint16_t>(port));
    out.v6 = true;
    return out;
  }
  refuse_address(text);
}

/// Says why nothing could listen. @param error  errno; 0: what the system was asked for was right
[[noreturn]] void throw_why(const WebServer::Options& options, int error) {
  if (error == EADDRNOTAVAIL) refuse_address(options.address);
  const std::string what =
      fmt::format("cannot listen at {}, port {}: {}", options.address, options.port,
                  error != 0 ? std::strerror(error) : "the certificate or its key is unusable");
  if (error == EADDRINUSE) throw base::Busy(what);
  throw std::runtime_error(what);
}

/// A request while its body comes.
struct Coming {
  WebRequest request;
  std::size_t most = 0;
  bool too_long = false;
};

WebAnswer told(const std::function<WebAnswer()>& answer) {
  try {
    return answer();
  } catch (const Refused& no) {
    return {.status = no.status, .body = fmt::format("{}\n", no.what())};
  } catch (const std::exception&) {
    return {.status = 500, .body = "this request failed here\n"};
  }
}

MHD_Result send(MHD_Connection* connection, const WebAnswer& answer) {
  MHD_Response* const response = MHD_create_response_from_buffer(
      answer.body.size(), const_cast<char*>(answer.body.data()), MHD_RESPMEM_MUST_COPY);
  if (response == nullptr) return MHD_NO;
  for (const auto& [name, value] : {std::pair{"Content-Type", answer.type.c_str()},
                                    {"Cache-Control", "no-store"},
                                    {"Referrer-Policy", "no-referrer"},
                                    {"X-Content-Type-Options", "nosniff"},
                                    {"X-Frame-Options", "DENY"}}) {
    MHD_add_response_header(response, name, value);
  }
  const MHD_Result queued =
      MHD_queue_response(connection, static_cast<unsigned>(answer.status), response);
  MHD_destroy_response(response);
  return queued;
}

std::size_t length_of(MHD_Connection* connection) {
  const char* const text =
      MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_CONTENT_LENGTH);
  return text == nullptr ? 0 : std::strtoull(text, nullptr, 10);
}

}  // namespace

struct WebServer::Daemon {
  Most most;
  Answer answer;
  std::string certificate, key;
  MHD_Daemon* daemon = nullptr;

  ~Daemon() {
    if (daemon != nullptr) MHD_stop_daemon(daemon);
  }

  /// The head of a request has come.
  MHD_Result begin(MHD_Connection* connection, Coming& coming) const {
    coming.request.query = [connection](const char* name) -> std::string {
      const char* const text = MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, name);
      return text == nullptr ? "" : text;
    };
    const WebAnswer refusal = told([&] {
      coming.most = most(coming.request);
      if (length_of(connection) > coming.most) throw Refused(413, kTooLong);
      return WebAnswer{.status = 0};
    });
    return refusal.status == 0 ? MHD_YES : send(connection, refusal);
  }

  static MHD_Result on_request(void* self, MHD_Connection* connection, const char* url,
                               const char* method, const char* /*version*/, const char* data,
                               std::size_t* size, void** state) {
    const Daemon& daemon = *static_cast<Daemon*>(self);
    if (*state == nullptr) {
      auto* const coming = new Coming{.request = {.method = method, .path = url}};
      *state = coming;
      return daemon.begin(connection, *coming);
    }
    Coming& coming = *static_cast<Coming*>(*state);
    if (*size > 0) {
      coming.too_long |= coming.request.body.size() + *size > coming.most;
      if (!coming.too_long) coming.request.body.append(data, *size);
      *size = 0;
      return MHD_YES;
    }
    return send(connection, told([&] {
                  if (coming.too_long) throw Refused(413, kTooLong);
                  return daemon.answer(coming.request);
                }));
  }

  static void on_end(void* /*self*/, MHD_Connection* /*connection*/, void** state,
                     MHD_RequestTerminationCode /*why*/) {
    delete static_cast<Coming*>(*state);
    *state = nullptr;
  }
};

WebServer::WebServer(const Options& options, Most most, Answer answer)
    : daemon_(std::make_unique<Daemon>()) {
  daemon_->most = std::move(most);
  daemon_->answer = std::move(answer);
  const Address address = address_of(options.address, options.port);
  unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD;
  if (address.v6) flags |= MHD_USE_IPv6;
  std::vector<MHD_OptionItem> items = {
      {MHD_OPTION_SOCK_ADDR, 0, const_cast<sockaddr*>(address.get())},
      {MHD_OPTION_CONNECTION_LIMIT, kMostConnections, nullptr},
      {MHD_OPTION_CONNECTION_TIMEOUT, kSilence, nullptr},
      {MHD_OPTION_CONNECTION_MEMORY_LIMIT, static_cast<std::intptr_t>(kConnection), nullptr},
      {MHD_OPTION_NOTIFY_COMPLETED, reinterpret_cast<std::intptr_t>(&Daemon::on_end), nullptr}};
  if (options.certificate) {
    flags |= MHD_USE_TLS;
    daemon_->certificate = options.certificate->certificate;
    daemon_->key = options.certificate->key;
    items.push_back({MHD_OPTION_HTTPS_MEM_CERT, 0, daemon_->certificate.data()});
    items.push_back({MHD_OPTION_HTTPS_MEM_KEY, 0, daemon_->key.data()});
  }
  items.push_back({MHD_OPTION_END, 0, nullptr});
  errno = 0;
  daemon_->daemon = MHD_start_daemon(flags, static_cast<std::uint16_t>(options.port), nullptr,
                                     nullptr, &Daemon::on_request, daemon_.get(), MHD_OPTION_ARRAY,
                                     items.data(), MHD_OPTION_END);
  if (daemon_->daemon != nullptr) return;
  throw_why(options, errno);
}

WebServer::~WebServer() = default;

int WebServer::port() const {
  return MHD_get_daemon_info(daemon_->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

}  // namespace headpin::apps
