// Conditions that choose objects by what is known of them: "storey = 3 and area > 20".
//
// The language is a part of SQL and of OGC's CQL2 text, and means what it means there:
//
//   condition   and, or, not, parentheses; a boolean alone is one, too
//   comparison  = <> != < <= > >=, between A and B, in (A, B), like 'Main%', is null; the last four
//               also with not
//   value       a property, number, 'text', true, false; dates are texts
//   property    its name; in "double quotes" if it is no word, or one of these
//
// Facts about all objects are `name`, `area` and `triangles`. A property of that name comes first;
// the fact is then object.name, object.area, object.triangles.
//
// Invariant. Logic has three values: a comparison with a missing value is unknown, and so is its
// negation. Only what is true is met.
//
// Cost. A condition becomes functions that call each other; a row takes one call a comparison.
#pragma once

#include "hierarchy/object_row.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace meshhier::exporting {

class ObjectCondition {
 public:
  /// Throws Error(usage) that tells the place, if it is none, names what objects do not have, or
  /// compares unlike values. Does not keep the arguments.
  ObjectCondition(std::string_view text, std::span<const ObjectProperty> properties);

  /// Requires a row of the properties' values. O(length of the condition). Thread-safe.
  bool is_met_by(const ObjectRow& row) const { return test_(row) == Truth::yes; }

  enum class Truth : std::uint8_t { no, unknown, yes };
  using Test = std::function<Truth(const ObjectRow& row)>;

 private:
  Test test_;
};

/// Returns whether a text is like a pattern: % stands for any characters, _ for one, and a
/// backslash takes the meaning of what follows away. Both are UTF-8. O(text x pattern).
bool is_like(std::string_view text, std::string_view pattern);

}  // namespace meshhier::exporting
