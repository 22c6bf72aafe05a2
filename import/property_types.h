// Types of objects' properties, by all values that they have.
//
// Tables of text (CSV) say no types: a text that reads as a number, a boolean or a date counts as
// one. A property has a type if all its values are of it, else it is a text, and its values stay as
// they are written. Numbers may have a decimal comma unless commas stand between fields, if none of
// the property has a point. Words for nothing (NA, NaN, NULL) are no value, but in a text.
#pragma once

#include "hierarchy/object_row.h"
#include "mesh_io/record_table.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

/// Returns the number that a text is: decimal, finite, without a leading zero, which codes have.
std::optional<double> number_of_text(std::string_view text);
/// Returns the same of one with a comma for its point.
std::optional<double> number_with_comma(std::string_view text);
/// Returns whether a text is a date of ISO 8601: 2031-05-17, or with a time, 2031-05-17T08:30:00Z.
bool is_date(std::string_view text);

class PropertyTypes {
 public:
  /// Takes a value of a property. `texts`: what a text may be.
  void note(std::uint8_t property, const ObjectValue& value, mesh_io::RecordTexts texts);
  ObjectPropertyType type(std::uint8_t property) const;
  /// Returns a value that was noted as one of its property's type.
  ObjectValue converted(std::uint8_t property, ObjectValue value) const;

 private:
  static constexpr std::size_t kTypes = kObjectPropertyTypes;
  std::array<std::array<bool, kTypes>, kMostObjectProperties> seen_{};
  std::array<bool, kMostObjectProperties> has_points_{}, has_commas_{};  ///< in numbers
};

}  // namespace meshhier::importing
