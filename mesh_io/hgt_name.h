// How files of SRTM are known: they have no head.
#pragma once

#include "base/small_letters.h"
#include "mesh_io/height_raster.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// Returns the rows and columns of a file of that size: 3 seconds or 1.
constexpr std::optional<std::uint32_t> hgt_side(std::uint64_t file_bytes) {
  for (const std::uint32_t side : {1201U, 3601U}) {
    if (file_bytes == std::uint64_t{2} * side * side)
      return side;
  }
  return std::nullopt;
}

/// Returns whether a name is that of heights packed by gzip.
inline bool is_packed_hgt_name(std::string_view name) {
  return small_letters(name).ends_with(".hgt.gz");
}

/// Returns the south-western corner by a name: longitude and latitude of "N53E027.hgt".
constexpr std::optional<MapPoint> hgt_corner(std::string_view name) {
  constexpr std::size_t kLength = 7;
  if (name.size() < kLength)
    return std::nullopt;
  const auto number = [&](std::size_t first, std::size_t digits, char minus, char plus,
                          int most) -> std::optional<int> {
    const char sign = static_cast<char>(name[first] & ~0x20);  // in capitals
    int value = 0;
    for (const char digit : name.substr(first + 1, digits)) {
      if (digit < '0' || digit > '9')
        return std::nullopt;
      value = 10 * value + (digit - '0');
    }
    if ((sign != minus && sign != plus) || value > most)
      return std::nullopt;
    return sign == minus ? -value : value;
  };
  const auto latitude = number(0, 2, 'S', 'N', 90);
  const auto longitude = number(3, 3, 'W', 'E', 180);
  if (!latitude || !longitude)
    return std::nullopt;
  return MapPoint{static_cast<double>(*longitude), static_cast<double>(*latitude)};
}

}  // namespace meshhier::mesh_io
