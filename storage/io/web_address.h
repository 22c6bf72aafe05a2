// Addresses on the web: whether a text is one, and its host.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meshhier::storage {

/// The parts of an address that a request needs; none of what is no address.
struct WebAddressParts {
  std::optional<std::string> origin;          ///< scheme, host and port, "https://example.org:443"
  std::optional<std::string> user, password;  ///< as they are meant, without %20
};

WebAddressParts address_parts(const std::string& address);

/// Whether scheme, host and port of two addresses are the same; false for what is no address.
bool is_same_host(const std::string& a, const std::string& b);

/// Whether a text is the address of something on the web.
bool is_web_address(std::string_view text);

}  // namespace meshhier::storage
