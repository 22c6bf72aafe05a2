// Numbers and triangles in the bytes of a binary PLY file.
#pragma once

#include "mesh_io/ply_plan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace meshhier::mesh_io {

/// Returns whether the file's byte order is not this machine's. Requires a binary encoding.
constexpr bool is_swapped(PlyEncoding encoding) {
  return (encoding == PlyEncoding::big_endian) != (std::endian::native == std::endian::big);
}

/// Returns the value at `bytes`; `Swap` if the file's byte order is not this machine's.
template <class T, bool Swap>
T load(const std::byte* bytes) {
  std::array<std::byte, sizeof(T)> raw_bytes;
  std::memcpy(raw_bytes.data(), bytes, sizeof(T));
  if constexpr (Swap)
    std::reverse(raw_bytes.begin(), raw_bytes.end());
  return std::bit_cast<T>(raw_bytes);
}

/// Calls visit(T{}) with the C++ type of `type`.
template <class Visit>
auto with_type(PlyType type, Visit visit) {
  switch (type) {
    case PlyType::i8:
      return visit(std::int8_t{});
    case PlyType::u8:
      return visit(std::uint8_t{});
    case PlyType::i16:
      return visit(std::int16_t{});
    case PlyType::u16:
      return visit(std::uint16_t{});
    case PlyType::i32:
      return visit(std::int32_t{});
    case PlyType::u32:
      return visit(std::uint32_t{});
    case PlyType::f32:
      return visit(float{});
    case PlyType::f64:
      break;
    case PlyType::i64:
      return visit(std::int64_t{});
    case PlyType::u64:
      return visit(std::uint64_t{});
  }
  return visit(double{});
}

/// Returns whether a number is so large that a double does not hold all integers of its size.
template <class T>
constexpr bool is_rounded(T value) {
  constexpr std::int64_t kMostExact = std::int64_t{1} << 53;
  if constexpr (std::is_same_v<T, std::uint64_t>)
    return value > static_cast<std::uint64_t>(kMostExact);
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return value > kMostExact || value < -kMostExact;
  else
    return false;
}

/// The rows of usual faces, `list uchar int` (or uint) with perhaps scalars around it: those of
/// triangles have one size.
struct TriangleRows {
  std::size_t before = 0;  ///< bytes of a row before the list
  std::size_t stride = 0;
  std::uint64_t limit = 0;  ///< the count of vertices, which corners are below
};

/// Returns none if the faces are of another form. `faces`: of a binary file.
std::optional<TriangleRows> triangle_rows(const PlyElementPlan& faces, std::uint64_t vertex_count);

/// Calls take(a, b, c) for each of `rows` rows at `bytes`, up to the first one that is not a
/// triangle with all corners below the limit; returns how many were taken.
template <bool Swap, class Take>
std::size_t take_triangles(const TriangleRows& layout, const std::byte* bytes, std::size_t rows,
                           const Take& take) {
  const std::byte* at = bytes + layout.before;
  for (std::size_t row = 0; row < rows; ++row, at += layout.stride) {
    const auto a = load<std::uint32_t, Swap>(at + 1);
    const auto b = load<std::uint32_t, Swap>(at + 5);
    const auto c = load<std::uint32_t, Swap>(at + 9);
    if (at[0] != std::byte{3} || std::max({a, b, c}) >= layout.limit)
      return row;
    take(a, b, c);
  }
  return rows;
}

}  // namespace meshhier::mesh_io
