#include "storage/io/hash.h"

#include <new>

#include <md5.h>
#include <xxhash.h>

namespace meshhier::storage {

struct Checksum::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t before) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), before);
}

Checksum::Checksum() : state_(std::make_unique<State>()) {
  if (state_->xxh == nullptr)
    throw std::bad_alloc();
  XXH3_64bits_reset(state_->xxh);
}
Checksum::~Checksum() = default;

void Checksum::add(std::span<const std::byte> bytes) {
  XXH3_64bits_update(state_->xxh, bytes.data(), bytes.size());
}

std::uint64_t Checksum::value() const {
  return XXH3_64bits_digest(state_->xxh);
}

std::array<std::byte, 16> md5(std::string_view text) {
  MD5_CTX state;
  MD5Init(&state);
  MD5Update(&state, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  std::array<std::byte, 16> digest{};
  MD5Final(reinterpret_cast<std::uint8_t*>(digest.data()), &state);
  return digest;
}

}  // namespace meshhier::storage
