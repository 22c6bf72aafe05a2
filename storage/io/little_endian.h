// Numbers in files: little endian on every machine.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace meshhier::storage {

/// The numbers that files hold.
template <class T>
concept Scalar = std::unsigned_integral<T> || std::same_as<T, float> || std::same_as<T, double>;

/// Writes `value` little endian at `to`: sizeof(T) bytes, no alignment required.
template <Scalar T>
constexpr void store_little(T value, std::byte* to) {
  if constexpr (std::same_as<T, float>) {
    store_little(std::bit_cast<std::uint32_t>(value), to);
  } else if constexpr (std::same_as<T, double>) {
    store_little(std::bit_cast<std::uint64_t>(value), to);
  } else {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      to[i] = static_cast<std::byte>(value >> (8 * i));
  }
}

/// Returns the value that store_little() has written.
template <Scalar T>
constexpr T load_little(const std::byte* from) {
  if constexpr (std::same_as<T, float>) {
    return std::bit_cast<float>(load_little<std::uint32_t>(from));
  } else if constexpr (std::same_as<T, double>) {
    return std::bit_cast<double>(load_little<std::uint64_t>(from));
  } else {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      value = static_cast<T>(value | static_cast<T>(static_cast<T>(from[i]) << (8 * i)));
    }
    return value;
  }
}

/// Writes all `values` little endian at `to`, one after another.
template <Scalar T>
void store_all_little(std::span<const T> values, std::byte* to) {
  if constexpr (std::endian::native == std::endian::little) {
    if (!values.empty())
      std::memcpy(to, values.data(), values.size_bytes());
  } else {
    for (std::size_t i = 0; i < values.size(); ++i)
      store_little(values[i], to + i * sizeof(T));
  }
}

template <Scalar T>
void append_little(std::vector<std::byte>& bytes, T value) {
  bytes.resize(bytes.size() + sizeof(T));
  store_little(value, bytes.data() + bytes.size() - sizeof(T));
}

}  // namespace meshhier::storage
