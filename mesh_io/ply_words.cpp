#include "mesh_io/ply_words.h"

#include "mesh_io/number_text.h"
#include "mesh_io/ply_values.h"

#include <cmath>
#include <limits>

namespace meshhier::mesh_io {

IntegerRange range_of(PlyType type) {
  if (has_64_bits(type)) {
    using Limits = std::numeric_limits<std::int64_t>;
    return {is_unsigned(type) ? 0 : Limits::min(), Limits::max()};
  }
  const auto bits = static_cast<int>(8 * size_of(type));
  if (is_unsigned(type))
    return {0, (std::int64_t{1} << bits) - 1};
  return {-(std::int64_t{1} << (bits - 1)), (std::int64_t{1} << (bits - 1)) - 1};
}

std::optional<std::int64_t> integer_of(PlyType type, std::string_view word) {
  const auto value = parse_integer(word);
  const IntegerRange range = range_of(type);
  return value && *value >= range.low && *value <= range.high ? value : std::nullopt;
}

std::optional<double> number_of(PlyType type, std::string_view word) {
  if (is_integer(type)) {
    const auto value = integer_of(type, word);
    return value && !is_rounded(*value) ? std::optional(static_cast<double>(*value)) : std::nullopt;
  }
  if (type == PlyType::f32)
    return parse_real<float>(word);
  return parse_real<double>(word);
}

std::optional<double> odd_integer_of(PlyType type, std::string_view word) {
  const auto value = parse_real<double>(word);
  const auto [low, high] = range_of(type);
  // The double of the highest integer of 64 bits is one more than that.
  const double most = static_cast<double>(high) * (type == PlyType::u64 ? 2 : 1);
  const bool is_it =
      value && *value == std::floor(*value) && *value >= static_cast<double>(low) && *value <= most;
  return is_it ? value : std::nullopt;
}

}  // namespace meshhier::mesh_io
