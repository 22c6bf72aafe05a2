// Checksums and content hashes: XXH3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

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

}  // namespace meshhier::storage
