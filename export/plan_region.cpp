#include "export/plan_region.h"

#include "base/error.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/intersections.h>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/index/rtree.hpp>

namespace meshhier::exporting {
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

/// Rounds an exact number: the result is the same whatever the way to the number.
double rounded(const Exact::FT& number) {
  return CGAL::to_double(CGAL::exact(number));
}

/// Returns the part of the way from `a` to another point `b` that `p` lies at.
Exact::FT part_of_way(const ExactPoint& a, const ExactPoint& b, const ExactPoint& p) {
  return a.x() != b.x() ? Exact::FT((p.x() - a.x()) / (b.x() - a.x()))
                        : Exact::FT((p.y() - a.y()) / (b.y() - a.y()));
}

/// The side of a face of a cut triangle.
enum class Side : std::uint8_t { unknown, outside, inside };

using Face =
    CGAL::Triangulation_face_base_with_info_2<Side, Exact,
                                              CGAL::Constrained_triangulation_face_base_2<Exact>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Exact, CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Exact>, Face>,
    CGAL::Exact_intersections_tag>;

/// A triangle seen from above.
struct PlanTriangle {
  explicit PlanTriangle(const std::array<PlanPoint, 3>& places)
      : corners{point<Exact>(places[0]), point<Exact>(places[1]), point<Exact>(places[2])},
        turn(CGAL::orientation(corners[0], corners[1], corners[2])) {}

  std::array<ExactPoint, 3> corners;
  CGAL::Orientation turn;  ///< COLLINEAR: it is vertical
};

/// The part of a border within a triangle.
struct Part {
  Exact::Segment_2 segment;  ///< perhaps a point
  std::uint32_t polygon = 0;
};

/// Polygons whose borders run along an edge, an odd number of times each.
class BordersOfEdges {
 public:
  using Vertex = Triangulation::Vertex_handle;

  void add(const Triangulation& plan, Vertex from, Vertex to, std::uint32_t polygon) {
    Triangulation::Face_handle ignored;
    int side = 0;
    for (Vertex next; from != to; from = next) {
      if (!plan.includes_edge(from, to, next, ignored, side))
        throw Error(ErrorCode::internal, "a border is not among the edges of a cut triangle");
      toggle(polygons_[ends(from, next)], polygon);
    }
  }
  const std::vector<std::uint32_t>& of(Triangulation::Face_handle face, int side) const {
    static const std::vector<std::uint32_t> none;
    const auto found = polygons_.find(
        ends(face->vertex(Triangulation::cw(side)), face->vertex(Triangulation::ccw(side))));
    return found == polygons_.end() ? none : found->second;
  }

 private:
  using Ends = std::pair<const void*, const void*>;

  static Ends ends(Vertex a, Vertex b) { return std::minmax<const void*>(&*a, &*b, std::less<>()); }
  static void toggle(std::vector<std::uint32_t>& polygons, std::uint32_t polygon) {
    if (std::erase(polygons, polygon) == 0)
      polygons.push_back(polygon);
  }

  std::map<Ends, std::vector<std::uint32_t>> polygons_;
};

/// Triangulates a triangle together with these parts. Nothing that is inserted crosses another,
/// unless polygons cross themselves or each other: points are made of the input's alone, and their
/// numbers stay short. Points follow each other, so that each is found from the last one.
BordersOfEdges triangulate(const PlanTriangle& triangle, const std::vector<Part>& parts,
                           const std::function<void()>& check, Triangulation& plan) {
  std::array<Triangulation::Vertex_handle, 3> corners;
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = plan.insert(triangle.corners[i]);
  for (std::size_t i = 0; i < 3; ++i)
    plan.insert_constraint(corners[i], corners[(i + 1) % 3]);
  std::vector<std::array<Triangulation::Vertex_handle, 2>> ends;
  Triangulation::Vertex_handle last = corners[0];
  for (const Part& part : parts) {
    check();
    const auto from = plan.insert(part.segment.source(), last->face());
    last = plan.insert(part.segment.target(), from->face());
    ends.push_back({from, last});
    if (from != last)
      plan.insert_constraint(from, last);
  }
  BordersOfEdges borders;
  for (std::size_t i = 0; i < parts.size(); ++i)
    borders.add(plan, ends[i][0], ends[i][1], parts[i].polygon);
  return borders;
}

/// Tells of all faces whether they lie in a polygon: from face to face, by the borders between
/// them. `open`: polygons that the first finite face lies in.
void tell_sides(const Triangulation& plan, const BordersOfEdges& borders,
                std::set<std::uint32_t> open) {
  struct Step {
    Triangulation::Face_handle face;
    int came = -1;  ///< the side it was entered by
    int next = 0;   ///< side to look at
  };
  const auto cross = [&](Triangulation::Face_handle face, int side) {
    for (const std::uint32_t polygon : borders.of(face, side)) {
      if (open.erase(polygon) == 0)
        open.insert(polygon);
    }
  };
  std::vector<Step> way;
  const auto enter = [&](Triangulation::Face_handle face, int came) {
    face->info() = open.empty() ? Side::outside : Side::inside;
    way.push_back({face, came});
  };
  for (const auto face : plan.all_face_handles())
    face->info() = Side::unknown;  // CGAL leaves it open
  // A walk in depth instead of sets for each face: `open` is that of the face at hand, and crossing
  // the same border on the way back restores it.
  enter(plan.finite_faces_begin(), -1);
  while (!way.empty()) {
    Step& at = way.back();
    if (at.next == 3) {
      if (at.came >= 0)
        cross(at.face, at.came);
      way.pop_back();
      continue;
    }
    const Triangulation::Face_handle from = at.face;
    const int side = at.next++;
    const Triangulation::Face_handle to = from->neighbor(side);
    if (plan.is_infinite(to) || to->info() != Side::unknown)
      continue;
    cross(from, side);
    enter(to, to->index(from));
  }
}

std::array<ExactPoint, 3> corners_of(Triangulation::Face_handle face) {
  return {face->vertex(0)->point(), face->vertex(1)->point(), face->vertex(2)->point()};
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
  /// Numbers a vertex between the ends of an edge of a vertical triangle, whose edges lie above
  /// each other.
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
  std::function<void()> check;
  std::vector<Edge> edges;
  Rtree tree;

  std::vector<std::uint32_t> edges_in(const RtreeBox& box) const {
    std::vector<std::uint32_t> found;
    for (auto entry = tree.qbegin(boost::geometry::index::intersects(box)); entry != tree.qend();
         ++entry)
      found.push_back(entry->second);
    std::ranges::sort(found);  // the tree's order decides nothing
    return found;
  }

  /// The polygons around `p`, ascending: by the borders that a ray to the east crosses.
  template <class Kernel>
  std::vector<std::uint32_t> around(const typename Kernel::Point_2& p, const RtreeBox& ray) const {
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
    std::vector<std::uint32_t> around;
    for (auto run = crossed.begin(); run != crossed.end();) {
      const auto end = std::upper_bound(run, crossed.end(), *run);
      if ((end - run) % 2 == 1)
        around.push_back(*run);
      run = end;
    }
    return around;
  }
  double east_end() const {
    return tree.empty() ? 0 : boost::geometry::get<0>(tree.bounds().max_corner());
  }
  std::vector<std::uint32_t> around(PlanPoint p) const {
    if (p.x > east_end())
      return {};
    return around<Doubles>(point<Doubles>(p), {{p.x, p.y}, {east_end(), p.y}});
  }
  std::vector<std::uint32_t> around(const ExactPoint& p) const {
    const double west = CGAL::to_interval(p.x()).first;
    const auto [south, north] = CGAL::to_interval(p.y());
    if (west > east_end())
      return {};
    return around<Exact>(p, {{west, south}, {east_end(), north}});
  }
  template <class Place>
  bool contains(const Place& p) const {
    return !around(p).empty();
  }

  TriangleCut cut_into_strips(const PlanTriangle& triangle,
                              const std::vector<std::uint32_t>& borders) const;
  std::vector<Part> parts_within(const PlanTriangle& triangle,
                                 const std::vector<std::uint32_t>& borders) const;
  TriangleCut cut_by(const PlanTriangle& triangle, const std::vector<std::uint32_t>& borders) const;
};

PlanRegion::PlanRegion(const std::vector<PlanPolygon>& polygons, UpAxis up,
                       std::function<void()> check) {
  auto parts = std::make_unique<Parts>();
  parts->up = up;
  parts->check = std::move(check);
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

std::array<PlanPoint, 2> PlanRegion::corners() const {
  const auto low = parts_->tree.bounds().min_corner(), high = parts_->tree.bounds().max_corner();
  return {PlanPoint{low.get<0>(), low.get<1>()}, PlanPoint{high.get<0>(), high.get<1>()}};
}

TriangleCut PlanRegion::cut(const std::array<Vec3d, 3>& corners) const {
  parts_->check();
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

/// Returns the parts of borders within the triangle.
std::vector<Part> PlanRegion::Parts::parts_within(const PlanTriangle& triangle,
                                                  const std::vector<std::uint32_t>& borders) const {
  const Exact::Triangle_2 shape(triangle.corners[0], triangle.corners[1], triangle.corners[2]);
  std::vector<Part> parts;
  for (const std::uint32_t number : borders) {
    check();
    const Edge& edge = edges[number];
    const auto common =
        CGAL::intersection(shape, Exact::Segment_2(point<Exact>(edge.from), point<Exact>(edge.to)));
    if (!common)
      continue;
    if (const auto* p = boost::get<ExactPoint>(&*common))
      parts.push_back({Exact::Segment_2(*p, *p), edge.polygon});
    else if (const auto* segment = boost::get<Exact::Segment_2>(&*common))
      parts.push_back({*segment, edge.polygon});
  }
  return parts;
}

/// Triangulates the triangle together with the borders over it: each part is within or without.
TriangleCut PlanRegion::Parts::cut_by(const PlanTriangle& triangle,
                                      const std::vector<std::uint32_t>& borders) const {
  Triangulation plan;
  const BordersOfEdges along = triangulate(triangle, parts_within(triangle, borders), check, plan);
  const std::array<ExactPoint, 3> first = corners_of(plan.finite_faces_begin());
  const ExactPoint middle = CGAL::centroid(first[0], first[1], first[2]);
  const std::optional<PlanPoint> near = rounded_within(first, middle);
  const std::vector<std::uint32_t> open = near ? around(*near) : around(middle);
  tell_sides(plan, along, {open.begin(), open.end()});
  CutVertices vertices(triangle);
  TriangleCut cut;
  for (const auto face : plan.finite_face_handles()) {
    check();
    if (face->info() != Side::inside)
      continue;
    const std::array<ExactPoint, 3> corners = corners_of(face);
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

/// Cuts a vertical triangle along the line that it is from above, from border to border.
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
    // Going around the triangle collects the strip's corners and cut edges in order, so a fan
    // covers the strip: it is convex.
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

}  // namespace meshhier::exporting
