// Checksums and content hashes: XXH3; and MD5, where a format of others wants it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace meshhier::storage {

/// XXH3-64 of `bytes`.
std::uint64_t checksum(std::span<const std::byte> bytes);
/// The same, of `bytes` behind something whose checksum is `before`: what a chain of them is made
/// of.
std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t before);

/// XXH3-64 of a sequence of blocks: equal to checksum() of them joined.
class Checksum {
 public:
  Checksum();
  ~Checksum();
  void add(std::span<const std::byte> bytes);
  std::uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// MD5 (RFC 1321) of `text`.
std::array<std::byte, 16> md5(std::string_view text);

}  // namespace meshhier::storage
