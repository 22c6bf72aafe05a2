// Numbers of a PLY file in text, as the types in its header have them.
#pragma once

#include "mesh_io/ply_header.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace meshhier::mesh_io {

struct IntegerRange {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

/// Returns the integers of a type; for u64 those up to 2^63 - 1. Requires is_integer(type).
IntegerRange range_of(PlyType type);

/// Parses an integer that `type`, one of integers, can hold.
std::optional<std::int64_t> integer_of(PlyType type, std::string_view word);

/// Parses a number of any type; a float is the one nearest to the word's number. None for an
/// integer that no double is.
std::optional<double> number_of(PlyType type, std::string_view word);

/// Parses an integer that is written as a float, or that has 64 bits and is rounded to a double.
std::optional<double> odd_integer_of(PlyType type, std::string_view word);

}  // namespace meshhier::mesh_io
