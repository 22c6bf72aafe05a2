// Addresses on the web: whether a text is one, and its host.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meshhier::storage {

/// The parts of an address that a request needs. A text that is no address has none.
struct WebAddressParts {
  std::optional<std::string> origin;          ///< scheme, host and port, "https://example.org:443"
  std::optional<std::string> user, password;  ///< as they are meant, without %20
};

/// Parses an address. An address without a port has that of its scheme. Thread-safe.
WebAddressParts address_parts(const std::string& address);

/// Returns whether scheme, host and port of two addresses are the same; false for what is no
/// address.
bool is_same_host(const std::string& a, const std::string& b);

/// Returns whether a text begins as an address of the web does, with "http://" or "https://" in
/// letters of any case; what follows may be no host.
bool is_web_address(std::string_view text);

}  // namespace meshhier::storage
