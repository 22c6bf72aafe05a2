#include "inspection/plan_region.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/index/rtree.hpp>

namespace meshhier::inspection {
namespace {

using Doubles = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = Exact::Point_2;

using RtreePoint = boost::geometry::model::d2::point_xy<double>;
using RtreeBox = boost::geometry::model::box<RtreePoint>;

/// A border of a polygon.
struct Edge {
  PlanPoint from, to;
  std::uint32_t polygon = 0;
};

using RtreeEntry = std::pair<RtreeBox, std::uint32_t>;
using Rtree = boost::geometry::index::rtree<RtreeEntry, boost::geometry::index::rstar<16>>;

RtreeBox box_of(PlanPoint a, PlanPoint b) {
  return {{std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}};
}

template <class Kernel>
typename Kernel::Point_2 point(PlanPoint p) {
  return {p.x, p.y};
}

RtreeBox box_of(const std::array<PlanPoint, 3>& corners) {
  RtreeBox box = box_of(corners[0], corners[1]);
  boost::geometry::expand(box, RtreePoint(corners[2].x, corners[2].y));
  return box;
}

/// Exact, then rounded: the same for all who compute the same number, whatever the way.
double rounded(const Exact::FT& number) {
  return CGAL::to_double(CGAL::exact(number));
}

/// Where it is on the way from `a` to `b`, which are two points.
Exact::FT part_of_way(const ExactPoint& a, const ExactPoint& b, const ExactPoint& p) {
  return a.x() != b.x() ? Exact::FT((p.x() - a.x()) / (b.x() - a.x()))
                        : Exact::FT((p.y() - a.y()) / (b.y() - a.y()));
}

using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Exact,
    CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Exact>,
                                         CGAL::Constrained_triangulation_face_base_2<Exact>>,
    CGAL::Exact_intersections_tag>;

/// A triangle seen from above.
struct PlanTriangle {
  explicit PlanTriangle(const std::array<PlanPoint, 3>& places)
      : corners{point<Exact>(places[0]), point<Exact>(places[1]), point<Exact>(places[2])},
        turn(CGAL::orientation(corners[0], corners[1], corners[2])) {}

  std::array<ExactPoint, 3> corners;
  CGAL::Orientation turn;  ///< COLLINEAR: it is vertical
};

/// The sides of a triangle, split where parts of borders end on them, and these parts. Nothing that
/// is inserted crosses another, unless polygons cross themselves or each other: points are made of
/// the input's alone, and their numbers stay short.
void insert_outline(const PlanTriangle& triangle, const std::vector<Exact::Segment_2>& parts,
                    Triangulation& plan) {
  for (std::size_t side = 0; side < 3; ++side) {
    const ExactPoint& a = triangle.corners[side];
    const ExactPoint& b = triangle.corners[(side + 1) % 3];
    std::vector<ExactPoint> stops{a, b};
    for (const Exact::Segment_2& part : parts) {
      for (const ExactPoint& end : {part.source(), part.target()}) {
        if (CGAL::orientation(a, b, end) == CGAL::COLLINEAR)
          stops.push_back(end);
      }
    }
    std::ranges::sort(stops);
    stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
    for (std::size_t i = 0; i + 1 < stops.size(); ++i)
      plan.insert_constraint(stops[i], stops[i + 1]);
  }
  for (const Exact::Segment_2& part : parts) {
    if (!part.is_degenerate())
      plan.insert_constraint(part.source(), part.target());
  }
}

/// A point of doubles within a triangle that turns left, by its middle: numbers that are quick to
/// compare. Nothing if the triangle is too small for one.
std::optional<PlanPoint> rounded_within(const std::array<ExactPoint, 3>& corners,
                                        const ExactPoint& middle) {
  const PlanPoint near{CGAL::to_double(middle.x()), CGAL::to_double(middle.y())};
  for (std::size_t i = 0; i < 3; ++i) {
    if (CGAL::orientation(corners[i], corners[(i + 1) % 3], point<Exact>(near)) != CGAL::LEFT_TURN)
      return std::nullopt;
  }
  return near;
}

/// Numbers the vertices of a cut triangle, each once.
class CutVertices {
 public:
  explicit CutVertices(const PlanTriangle& triangle) : triangle_(triangle) {}

  std::uint32_t at(const ExactPoint& p) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (p == triangle_.corners[i])
        return i;
    }
    return number(p, -1, [&] { return vertex_at(p); });
  }
  /// Of a vertical triangle, whose edges lie above each other. Between its ends.
  std::uint32_t on_edge(int edge, const ExactPoint& p) {
    return number(p, edge, [&] { return on_way(edge, p); });
  }
  std::vector<TriangleCut::Vertex> take() { return std::move(made_); }

 private:
  template <class Make>
  std::uint32_t number(const ExactPoint& p, int edge, const Make& make) {
    const auto [found, is_new] =
        numbers_.try_emplace({p, edge}, static_cast<std::uint32_t>(3 + made_.size()));
    if (is_new)
      made_.push_back(make());
    return found->second;
  }
  TriangleCut::Vertex on_way(int edge, const ExactPoint& p) const {
    const auto first = static_cast<std::size_t>(edge);
    const Exact::FT to =
        part_of_way(triangle_.corners[first], triangle_.corners[(first + 1) % 3], p);
    return {edge, rounded(to), rounded(1 - to)};
  }
  TriangleCut::Vertex vertex_at(const ExactPoint& p) const {
    const auto& [a, b, c] = triangle_.corners;
    for (int edge = 0; edge < 3; ++edge) {
      const auto first = static_cast<std::size_t>(edge);
      if (CGAL::orientation(triangle_.corners[first], triangle_.corners[(first + 1) % 3], p) ==
          CGAL::COLLINEAR)
        return on_way(edge, p);
    }
    const Exact::FT whole = CGAL::area(a, b, c);
    return {-1, rounded(CGAL::area(a, p, c) / whole), rounded(CGAL::area(a, b, p) / whole)};
  }

  const PlanTriangle& triangle_;
  std::map<std::pair<ExactPoint, int>, std::uint32_t> numbers_;
  std::vector<TriangleCut::Vertex> made_;
};

}  // namespace

struct PlanRegion::Parts {
  UpAxis up;
  std::vector<Edge> edges;
  Rtree tree;

  std::vector<std::uint32_t> edges_in(const RtreeBox& box) const {
    std::vector<std::uint32_t> found;
    for (auto entry = tree.qbegin(boost::geometry::index::intersects(box)); entry != tree.qend();
         ++entry)
      found.push_back(entry->second);
    std::ranges::sort(found);  // what the tree makes of them decides nothing
    return found;
  }

  /// Counts the borders that a ray to the east crosses, those of each polygon.
  template <class Kernel>
  bool contains(const typename Kernel::Point_2& p, const RtreeBox& ray) const {
    std::vector<std::uint32_t> crossed;
    for (const std::uint32_t number : edges_in(ray)) {
      const Edge& edge = edges[number];
      const auto a = point<Kernel>(edge.from), b = point<Kernel>(edge.to);
      const bool is_up = b.y() > p.y();
      if ((a.y() > p.y()) != is_up &&
          CGAL::orientation(a, b, p) == (is_up ? CGAL::LEFT_TURN : CGAL::RIGHT_TURN))
        crossed.push_back(edge.polygon);
    }
    std::ranges::sort(crossed);
    for (auto run = crossed.begin(); run != crossed.end();) {
      const auto end = std::upper_bound(run, crossed.end(), *run);
      if ((end - run) % 2 == 1)
        return true;
      run = end;
    }
    return false;
  }
  double east_end() const {
    return tree.empty() ? 0 : boost::geometry::get<0>(tree.bounds().max_corner());
  }
  bool contains(PlanPoint p) const {
    if (p.x > east_end())
      return false;
    return contains<Doubles>(point<Doubles>(p), {{p.x, p.y}, {east_end(), p.y}});
  }
  bool contains(const ExactPoint& p) const {
    const double west = CGAL::to_interval(p.x()).first;
    const auto [south, north] = CGAL::to_interval(p.y());
    if (west > east_end())
      return false;
    return contains<Exact>(p, {{west, south}, {east_end(), north}});
  }

  TriangleCut cut_into_strips(const PlanTriangle& triangle,
                              const std::vector<std::uint32_t>& borders) const;
  std::vector<Exact::Segment_2> parts_within(const PlanTriangle& triangle,
                                             const std::vector<std::uint32_t>& borders) const;
  TriangleCut cut_by(const PlanTriangle& triangle, const std::vector<std::uint32_t>& borders) const;
};

PlanRegion::PlanRegion(const std::vector<PlanPolygon>& polygons, UpAxis up) {
  auto parts = std::make_unique<Parts>();
  parts->up = up;
  std::vector<RtreeEntry> entries;
  for (std::uint32_t polygon = 0; polygon < polygons.size(); ++polygon) {
    for (const PlanRing& ring : polygons[polygon]) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanPoint from = ring[i], to = ring[(i + 1) % ring.size()];
        if (from == to)
          continue;
        entries.emplace_back(box_of(from, to), static_cast<std::uint32_t>(parts->edges.size()));
        parts->edges.push_back({from, to, polygon});
      }
    }
  }
  parts->tree = Rtree(entries);
  parts_ = std::move(parts);
}

PlanRegion::~PlanRegion() = default;
PlanRegion::PlanRegion(PlanRegion&&) noexcept = default;
PlanRegion& PlanRegion::operator=(PlanRegion&&) noexcept = default;

bool PlanRegion::contains(Vec3d p) const {
  return parts_->contains(plan_of(p, parts_->up));
}

bool PlanRegion::may_meet(const BoundsD& box) const {
  const PlanPoint a = plan_of(box.min, parts_->up), b = plan_of(box.max, parts_->up);
  return parts_->tree.qbegin(boost::geometry::index::intersects(box_of(a, b))) !=
             parts_->tree.qend() ||
         parts_->contains(a);
}

TriangleCut PlanRegion::cut(const std::array<Vec3d, 3>& corners) const {
  std::array<PlanPoint, 3> places;
  std::ranges::transform(corners, places.begin(), [&](Vec3d p) { return plan_of(p, parts_->up); });
  std::vector<std::uint32_t> borders = parts_->edges_in(box_of(places));
  const Doubles::Triangle_2 shape(point<Doubles>(places[0]), point<Doubles>(places[1]),
                                  point<Doubles>(places[2]));
  if (!shape.is_degenerate()) {
    std::erase_if(borders, [&](std::uint32_t number) {
      const Edge& edge = parts_->edges[number];
      return !CGAL::do_intersect(
          shape, Doubles::Segment_2(point<Doubles>(edge.from), point<Doubles>(edge.to)));
    });
  }
  if (borders.empty())
    return {parts_->contains(places[0]), {}, {}};
  const PlanTriangle triangle(places);
  return triangle.turn == CGAL::COLLINEAR ? parts_->cut_into_strips(triangle, borders)
                                          : parts_->cut_by(triangle, borders);
}

/// What of the borders lies in the triangle.
std::vector<Exact::Segment_2> PlanRegion::Parts::parts_within(
    const PlanTriangle& triangle, const std::vector<std::uint32_t>& borders) const {
  const Exact::Triangle_2 shape(triangle.corners[0], triangle.corners[1], triangle.corners[2]);
  std::vector<Exact::Segment_2> parts;
  for (const std::uint32_t number : borders) {
    const auto common = CGAL::intersection(
        shape, Exact::Segment_2(point<Exact>(edges[number].from), point<Exact>(edges[number].to)));
    if (!common)
      continue;
    if (const auto* p = boost::get<ExactPoint>(&*common))
      parts.emplace_back(*p, *p);
    else if (const auto* segment = boost::get<Exact::Segment_2>(&*common))
      parts.push_back(*segment);
  }
  return parts;
}

/// Triangulates the triangle together with the borders over it: each part is within or without.
TriangleCut PlanRegion::Parts::cut_by(const PlanTriangle& triangle,
                                      const std::vector<std::uint32_t>& borders) const {
  Triangulation plan;
  insert_outline(triangle, parts_within(triangle, borders), plan);
  CutVertices vertices(triangle);
  TriangleCut cut;
  for (const auto face : plan.finite_face_handles()) {
    const std::array<ExactPoint, 3> corners{face->vertex(0)->point(), face->vertex(1)->point(),
                                            face->vertex(2)->point()};
    const ExactPoint middle = CGAL::centroid(corners[0], corners[1], corners[2]);
    const std::optional<PlanPoint> near = rounded_within(corners, middle);
    if (!(near ? contains(*near) : contains(middle)))
      continue;
    std::array<std::uint32_t, 3> t{vertices.at(corners[0]), vertices.at(corners[1]),
                                   vertices.at(corners[2])};
    if (triangle.turn == CGAL::RIGHT_TURN)
      std::swap(t[1], t[2]);
    const auto least = std::ranges::min_element(t);
    std::rotate(t.begin(), least, t.end());
    cut.triangles.push_back(t);
  }
  cut.vertices = vertices.take();
  if (plan.number_of_faces() == 1 && cut.triangles.size() == 1)
    return {true, {}, {}};
  return cut;
}

/// Along the line that it is seen as, border by border.
TriangleCut PlanRegion::Parts::cut_into_strips(const PlanTriangle& triangle,
                                               const std::vector<std::uint32_t>& borders) const {
  const auto [first, last] = std::ranges::minmax(triangle.corners);
  if (first == last)
    return {contains(first), {}, {}};
  const Exact::Segment_2 line(first, last);
  std::vector<ExactPoint> stops{first, last};
  for (const std::uint32_t number : borders) {
    const Exact::Segment_2 border(point<Exact>(edges[number].from), point<Exact>(edges[number].to));
    const auto common = CGAL::intersection(line, border);
    if (!common)
      continue;
    if (const auto* p = boost::get<ExactPoint>(&*common))
      stops.push_back(*p);
    else if (const auto* segment = boost::get<Exact::Segment_2>(&*common))
      stops.insert(stops.end(), {segment->source(), segment->target()});
  }
  std::ranges::sort(stops);
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  CutVertices vertices(triangle);
  TriangleCut cut;
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    if (!contains(CGAL::midpoint(stops[i], stops[i + 1])))
      continue;
    if (stops.size() == 2)
      return {true, {}, {}};
    // The corners and cut edges of the strip, around it.
    std::vector<std::uint32_t> around;
    for (int edge = 0; edge < 3; ++edge) {
      const auto from = static_cast<std::size_t>(edge);
      const ExactPoint& a = triangle.corners[from];
      const ExactPoint& b = triangle.corners[(from + 1) % 3];
      if (a >= stops[i] && a <= stops[i + 1])
        around.push_back(static_cast<std::uint32_t>(edge));
      std::array<ExactPoint, 2> sides{stops[i], stops[i + 1]};
      if (b < a)
        std::swap(sides[0], sides[1]);
      for (const ExactPoint& side : sides) {
        if ((a < side && side < b) || (b < side && side < a))
          around.push_back(vertices.on_edge(edge, side));
      }
    }
    for (std::size_t k = 1; k + 1 < around.size(); ++k)
      cut.triangles.push_back({around[0], around[k], around[k + 1]});
  }
  cut.vertices = vertices.take();
  return cut;
}

}  // namespace meshhier::inspection
