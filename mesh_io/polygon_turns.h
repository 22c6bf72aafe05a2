// The side of a line on which a point lies, exactly.
#pragma once

#include <array>

namespace meshhier::mesh_io {

using Point2 = std::array<double, 2>;

/// Returns 1 if a, b, c turn to the left, -1 if to the right, 0 if they lie on a line. Exact for
/// all finite numbers (CGAL's filtered predicates: floats with an error bound first, exact numbers
/// where they do not decide). O(1). Thread-safe.
int turn_of(const Point2& a, const Point2& b, const Point2& c);

}  // namespace meshhier::mesh_io
