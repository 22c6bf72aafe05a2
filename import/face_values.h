// Values of faces on their way to the vertices of their corners, out of core.
#pragma once

#include "execution/spool_cursor.h"
#include "hierarchy/scalar_value.h"
#include "import/place_lookup.h"
#include "import/raw_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::importing {

/// Takes the values of triangles and tells which triangles have the same. For one thread.
class FaceValues {
 public:
  FaceValues(const std::vector<ScalarAttribute>& attributes, const ImportRoom& room);

  bool any() const { return !attributes_.empty(); }
  /// Takes the values of the next triangle, one an attribute; none: it has no values (NaN, or 0 for
  /// an integer). Throws Error(input) if there are 2^32 triangles or more.
  void add(std::span<const double> values);
  /// Ends adding. Two sorts an attribute.
  void compare();
  /// Returns a number from 1 on that is equal for equal values, bit for bit; 0 if faces have none.
  /// Asked for ascending triangles.
  std::uint32_t number_of(std::uint64_t triangle) {
    return any() ? numbers_cursor_.at(triangle) + 1 : 0;
  }
  /// Returns the channels of the values of that number, as AttributeLayout has them; for 0 those of
  /// no values. Valid until the next call.
  std::span<const float> channels(std::uint32_t number);

 private:
  void split_groups(std::size_t attribute);

  const std::vector<ScalarAttribute>& attributes_;
  const ImportRoom& room_;
  storage::RecordSpool<double> values_;  ///< one for each triangle and attribute
  /// For each triangle the first one that has the same.
  storage::RecordSpool<std::uint32_t> numbers_;
  execution::SpoolCursor<std::uint32_t> numbers_cursor_;
  SpoolLookup<double> lookup_;
  std::uint64_t triangles_ = 0;
  std::vector<double> none_;
  std::vector<float> channels_;
};

}  // namespace meshhier::importing
