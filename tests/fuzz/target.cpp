#include "fuzz/target.h"

#include <cstdint>

namespace meshhier::tests::fuzz {

void require(bool kept, std::string_view promise) {
  if (!kept)
    throw Violation(std::string(promise));
}

void require_message(std::string_view message, std::string_view start) {
  constexpr std::size_t kLongest = 1000;
  const std::string told(message.substr(0, kLongest));
  require(message.starts_with(start), "a message that does not name its origin: " + told);
  require(message.size() <= kLongest, "a message without end: " + told);
  const bool clean = std::all_of(message.begin(), message.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 && byte != 0x7f;
  });
  require(clean, "a message with control characters: " + told);
}

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Bytes bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

Tree take_tree(Take& take) {
  const std::uint64_t vertices = std::uint64_t{take.upto<std::uint32_t>(UINT32_MAX - 2)} + 1;
  const auto most = static_cast<std::uint32_t>(vertices - 1);
  return {vertices, take.upto<std::uint32_t>(most) + 1};
}

}  // namespace meshhier::tests::fuzz
