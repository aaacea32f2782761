#pragma once

#include <string>

#include "devices/lcm/url.h"

namespace headpin::devices {

/// Connects to the server of tcpq once, as liblcm does. liblcm 1.3.1 goes on without a server, waits
/// for ever for one that is silent, and takes this computer for every host that is not a number.
///
/// @return  the server's URL with the host as a number
/// @throws std::runtime_error  naming the URL, when no server of LCM answers within some seconds
std::string find_server(const LcmUrl& url);

}  // namespace headpin::devices
