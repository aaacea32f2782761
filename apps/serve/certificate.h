#pragma once

#include <string>

#include "apps/serve/web.h"

namespace headpin::apps {

/// A self-signed certificate with a new key (ECDSA, P-256), for 90 days.
///
/// @param address  that it is for
/// @throws std::runtime_error  when GnuTLS cannot make it
Certificate self_signed(const std::string& address);

/// @throws std::runtime_error  naming the file that cannot be read
Certificate read_certificate(const std::string& certificate, const std::string& key);

}  // namespace headpin::apps
