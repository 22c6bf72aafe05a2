// Numbers and texts as bytes of rows, in the processor's own order: they never leave it.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace meshhier::importing {

template <class Number>
void put_raw(std::string& bytes, Number number) {
  const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  bytes.append(raw.data(), raw.size());
}

template <class Number>
Number take_raw(std::string_view& bytes) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), bytes.data(), raw.size());
  bytes.remove_prefix(raw.size());
  return std::bit_cast<Number>(raw);
}

inline void put_text(std::string& bytes, std::string_view text) {
  put_raw(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

inline std::string take_text(std::string_view& bytes) {
  const auto size = take_raw<std::uint32_t>(bytes);
  std::string text(bytes.substr(0, size));
  bytes.remove_prefix(size);
  return text;
}

}  // namespace meshhier::importing
