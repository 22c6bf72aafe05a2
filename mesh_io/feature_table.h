// Tables of what features of a mesh are: a row each, and columns of values.
#pragma once

#include "hierarchy/object_row.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// For one thread. Its file must outlive it.
class FeatureTable {
 public:
  virtual ~FeatureTable() = default;

  virtual std::uint64_t rows() const = 0;
  virtual const std::vector<std::string>& columns() const = 0;
  /// Returns what a column is said to mean: "ID", "NAME"; empty: nothing is said.
  virtual std::string_view meaning(std::size_t /*column*/) const { return {}; }
  /// Returns the names of parts that no column has: they are not read.
  virtual std::vector<std::string> unread() const { return {}; }
  /// Returns a value: of each column quick for rows that ascend from call to call. Lists are texts
  /// of JSON. Throws Error(input) if it does not lie where the table says, Error(io).
  virtual ObjectValue value(std::size_t column, std::uint64_t row) = 0;
};

}  // namespace meshhier::mesh_io
