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

/// Requires is_integer(type). Of 64 bits without a sign those of 63.
IntegerRange range_of(PlyType type);

/// An integer that `type`, one of integers, can hold.
std::optional<std::int64_t> integer_of(PlyType type, std::string_view word);

/// A number of any type; a float is the one nearest to what the word says. None of an integer that
/// no double is.
std::optional<double> number_of(PlyType type, std::string_view word);

/// An integer that is written as a float, or that has 64 bits and is rounded to a double.
std::optional<double> odd_integer_of(PlyType type, std::string_view word);

}  // namespace meshhier::mesh_io
