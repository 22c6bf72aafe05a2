#include "mesh_io/ply_words.h"

#include "mesh_io/number_text.h"

namespace meshhier::mesh_io {

IntegerRange range_of(PlyType type) {
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
  if (is_integer(type))
    return integer_of(type, word);
  if (type == PlyType::f32)
    return parse_real<float>(word);
  return parse_real<double>(word);
}

}  // namespace meshhier::mesh_io
