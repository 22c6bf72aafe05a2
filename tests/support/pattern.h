// Bytes to write and to read back.
#pragma once

#include <cstddef>
#include <vector>

namespace meshhier::tests {

/// Bytes without a period shorter than 65536; other seeds give other ones.
inline std::vector<std::byte> pattern(std::size_t size, std::size_t seed = 0) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::byte>(((i + seed) * 31) ^ (i >> 8));
  return bytes;
}

}  // namespace meshhier::tests
