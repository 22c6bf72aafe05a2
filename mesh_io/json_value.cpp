#include "mesh_io/json_value.h"

#include "storage/io/json_text.h"

#include <cmath>

namespace meshhier::mesh_io {

ObjectValue value_of_json(const nlohmann::json& value) {
  constexpr double kMostWhole = 9007199254740992;  // 2^53
  if (value.is_null())
    return {};
  if (value.is_boolean())
    return value.get<bool>();
  if (value.is_string())
    return value.get<std::string>();
  const bool is_exact =
      value.is_number_float() || (value.is_number() && std::abs(value.get<double>()) < kMostWhole);
  if (is_exact && std::isfinite(value.get<double>()))
    return value.get<double>();
  return storage::json_text(value);
}

}  // namespace meshhier::mesh_io
