#include "mesh_io/polygon_turns.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace meshhier::mesh_io {

int turn_of(const Point2& a, const Point2& b, const Point2& c) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  return static_cast<int>(CGAL::orientation(
      Kernel::Point_2(a[0], a[1]), Kernel::Point_2(b[0], b[1]), Kernel::Point_2(c[0], c[1])));
}

}  // namespace meshhier::mesh_io
