// The choice of attributes that are read besides normals, colours and texture coordinates.
#pragma once

#include "hierarchy/scalar_value.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

struct AttributeChoice {
  enum class Which : std::uint8_t { all, none, named };

  Which which = Which::all;
  std::vector<std::string> names{};  ///< names that are read, if `which` is `named`
  /// Names of labels; none: all values of integer types are labels.
  std::optional<std::vector<std::string>> labels{};

  bool takes(std::string_view name) const {
    return which == Which::all || (which == Which::named && has(names, name));
  }
  bool is_label(std::string_view name, ValueType type) const {
    return labels ? has(*labels, name) : is_integer(type);
  }
  friend bool operator==(const AttributeChoice&, const AttributeChoice&) = default;

 private:
  static bool has(const std::vector<std::string>& list, std::string_view name) {
    return std::ranges::find(list, name) != list.end();
  }
};

}  // namespace meshhier::mesh_io
