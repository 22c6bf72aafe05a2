// Checksums and content hashes: XXH3; and MD5, where a format of others wants it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace meshhier::storage {

/// Returns the XXH3-64 of `bytes`.
std::uint64_t checksum(std::span<const std::byte> bytes);
/// Returns the XXH3-64 of `bytes` seeded with `before`, the checksum of what stands before them: a
/// link of a chain. It is not the checksum of both joined.
std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t before);

/// Takes the XXH3-64 of a sequence of blocks: value() is checksum() of all that was added, joined.
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

/// Returns the MD5 (RFC 1321) of `text`.
std::array<std::byte, 16> md5(std::string_view text);

}  // namespace meshhier::storage
