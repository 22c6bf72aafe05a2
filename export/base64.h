// Bytes in text (RFC 4648, section 4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace meshhier::exporting {

std::string base64(std::span<const std::byte> bytes);

/// Returns the number of characters that base64() makes of so many bytes.
constexpr std::uint64_t base64_size(std::uint64_t bytes) {
  return (bytes + 2) / 3 * 4;
}

}  // namespace meshhier::exporting
