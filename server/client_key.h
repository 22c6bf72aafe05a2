// The key that tells clients apart when threads and connections are shared out.
#pragma once

#include <string>

namespace meshhier::server {

/// Returns the key of a numeric address. An IPv6 client has a whole /64 network, so its key is that
/// network: "2001:db8:1:2::/64". IPv4 addresses are their own key, also where they are mapped into
/// IPv6. Other text is returned as it is.
std::string client_key(const std::string& address);

/// Whether a numeric address is this machine's own: 127.x.x.x, perhaps mapped into IPv6, or ::1.
bool is_loopback_client(const std::string& address);

}  // namespace meshhier::server
