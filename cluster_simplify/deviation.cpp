#include "cluster_simplify/deviation.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::cluster_simplify {
namespace {

/// Rounding, as a part of the largest coordinate: a point built by the deepest cuts is off by some
/// hundred units in the last place of a double, 2^-53; this is two thousand. Floats, which the
/// positions are, have steps of 2^-24.
constexpr double kRounding = 0x1p-42;

/// Point-triangle distances a fine triangle, on average, for what cannot be mapped. With 8 the
/// head's bounds are up to four times as large, with 512 no scan runs out of them.
constexpr std::uint64_t kSplitDistances = 512;

/// Widening goes in steps of 2 %: what is lost where a triangle cannot be mapped at once.
constexpr double kWidening = 1.02 * 1.02;

double largest_coordinate(std::span<const Vec3f> positions) {
  float largest = 0;
  for (const Vec3f& p : positions)
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

unsigned next_corner(unsigned corner) {
  return corner == 2 ? 0 : corner + 1;
}

}  // namespace

/// Finds a vertex's nearest point. If its distance is a lower bound of the result, the reach grows
/// to it, but not before it was looked for farther away.
void DeviationMeter::land(Course& course, const TargetSurface& target, std::uint32_t vertex,
                          bool counts) {
  const std::uint32_t key = course.surface.key(vertex);
  const Vec3d point = course.surface.position(vertex);
  Spot& spot = course.spots[vertex];
  spot = nearest_around(target, key, point);
  if (!spot.found() || !counts || spot.squared_distance() <= reach_)
    return;
  spot = descend(target, spot.near[0], point);
  reach_ = std::max(reach_, spot.squared_distance());
}

void DeviationMeter::land_fine_vertices(const DeviationInput& input, Deviation& deviation) {
  const TargetSurface& fine = fine_.surface;
  const TargetSurface& coarse = coarse_.surface;
  fine_.spots.assign(fine.vertex_count(), {});
  for (std::uint32_t v = 0; v < fine.vertex_count(); ++v) {
    const std::uint32_t key = fine.key(v);
    if (!fine.is_used(v) || coarse.around(key).empty())
      continue;
    // Vertices that a contraction leaves in place are many: nothing needs to be searched.
    if (fine.position(v) == coarse.position(key))
      fine_.spots[v] = spot_on_vertex(coarse, key, coarse.around(key)[0]);
    else
      land(fine_, coarse, v, fine.is_own(v));
    if (!fine.is_own(v))
      continue;
    const double weight = input.weights[v];
    deviation.squared_sum += weight * fine_.spots[v].squared_distance();
    deviation.weight_sum += weight;
  }
}

/// Sees to it that every corner has landed, and within reach where it is certified. False if there
/// is nothing to land on.
bool DeviationMeter::land_corners(Course& course, const TargetSurface& target,
                                  std::uint32_t triangle) {
  const TargetSurface::Corners& corners = course.surface.corners(triangle);
  std::uint32_t start = kNone;
  for (const std::uint32_t v : corners) {
    if (start == kNone)
      start = course.spots[v].near[0];
  }
  if (start == kNone)
    return false;
  for (const std::uint32_t v : corners) {
    Spot& spot = course.spots[v];
    if (!spot.found())
      spot = descend(target, start, course.surface.position(v));
    if (border_ == BorderShare::whole || course.surface.is_own(v))
      reach_ = std::max(reach_, spot.squared_distance());
  }
  return true;
}

/// Returns how many triangles have nothing to land on.
std::uint64_t DeviationMeter::certify_fine() {
  const TargetSurface& fine = fine_.surface;
  fine_.passages.assign(fine.triangle_count(), {});
  fine_.mapped.assign(fine.triangle_count(), 0);
  mapped_area_.assign(coarse_.surface.triangle_count(), 0);
  cover_.start(coarse_.surface);
  std::uint64_t collapsed = 0;
  for (std::uint32_t t = 0; t < fine.triangle_count(); ++t) {
    if (!fine.has_own_corner(t))
      continue;
    if (!land_corners(fine_, coarse_.surface, t)) {
      ++collapsed;
      continue;
    }
    certify(fine_, coarse_.surface, t);
    if (fine_.mapped[t] == 0)
      continue;
    for (const MappedPiece& piece : cover_.pieces())
      mapped_area_[piece.triangle] += piece.area;
  }
  return collapsed;
}

/// Returns how many triangles have nothing to land on.
std::uint64_t DeviationMeter::certify_coarse() {
  const TargetSurface& coarse = coarse_.surface;
  coarse_.spots.assign(coarse.vertex_count(), {});
  coarse_.passages.assign(coarse.triangle_count(), {});
  coarse_.mapped.assign(coarse.triangle_count(), 0);
  cover_.start(fine_.surface);
  std::uint64_t missing = 0;
  for (std::uint32_t t = 0; t < coarse.triangle_count(); ++t) {
    if (!coarse.has_own_corner(t) || is_covered(t))
      continue;
    for (const std::uint32_t v : coarse.corners(t)) {
      if (!coarse_.spots[v].found())
        land(coarse_, fine_.surface, v, border_ == BorderShare::whole || coarse.is_own(v));
    }
    if (land_corners(coarse_, fine_.surface, t))
      certify(coarse_, fine_.surface, t);
    else
      ++missing;
  }
  return missing;
}

void DeviationMeter::certify(Course& course, const TargetSurface& target, std::uint32_t triangle) {
  const auto [a, b, c] = course.surface.corners(triangle);
  const bool whole =
      border_ == BorderShare::whole ||
      (course.surface.is_own(a) && course.surface.is_own(b) && course.surface.is_own(c));
  if (whole)
    certify_whole(course, target, triangle);
  else
    certify_part(course, target, triangle);
}

void DeviationMeter::certify_whole(Course& course, const TargetSurface& target,
                                   std::uint32_t triangle) {
  const auto [a, b, c] = course.surface.corners(triangle);
  const std::vector<Spot>& spots = course.spots;
  bool mapped = cover_.covers_at_once(spots[a], spots[b], spots[c]);
  if (!mapped) {
    mapped = cover_.covers(
        {side_of(course, triangle, 0), side_of(course, triangle, 1), side_of(course, triangle, 2)},
        reach_);
  }
  course.mapped[triangle] = mapped ? 1 : 0;
  if (!mapped)
    widen(target, spots[a], spots[b], spots[c]);
}

/// A side with its passage, which the triangle beyond it may have found before.
SurfaceCover::Side DeviationMeter::side_of(Course& course, std::uint32_t triangle, unsigned edge) {
  const TargetSurface::Corners& corners = course.surface.corners(triangle);
  const std::uint32_t from = corners[edge];
  const std::uint32_t to = corners[next_corner(edge)];
  Passage& passage = course.passages[triangle][edge];
  const std::uint32_t other = course.surface.across(triangle, edge);
  if (other < triangle) {
    const unsigned there = course.surface.edge_across(triangle, edge);
    const Passage& known = course.passages[other][there];
    if (known.state == Passage::found && course.surface.corners(other)[there] == to) {
      passage = known;
      return {&course.spots[from], passage, true};
    }
  }
  passage = cover_.find_passage(course.spots[from], course.spots[to], reach_);
  return {&course.spots[from], passage, false};
}

Spot DeviationMeter::spot_between(const TargetSurface& target, Vec3d point, const Spot& start) {
  const Spot spot = descend(target, start.near[0], point);
  reach_ = std::max(reach_, spot.squared_distance());
  return spot;
}

/// The quadrangles around own corners, with the middles of their edges and the triangle's middle.
void DeviationMeter::certify_part(const Course& course, const TargetSurface& target,
                                  std::uint32_t triangle) {
  const TargetSurface::Corners& corners = course.surface.corners(triangle);
  const auto point = [&](std::size_t i) { return course.surface.position(corners[i]); };
  for (std::size_t i = 0; i < 3; ++i) {
    if (!course.surface.is_own(corners[i]))
      continue;
    const Spot own = course.spots[corners[i]];
    const Vec3d middle = (point(0) + point(1) + point(2)) * (1.0 / 3);
    const Spot centre = spot_between(target, middle, own);
    for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3}) {
      const Spot half = spot_between(target, (point(i) + point(j)) * 0.5, own);
      if (!cover_.covers(own, half, centre, reach_))
        widen(target, own, half, centre);
    }
  }
}

/// Bounds the triangle the thorough way; if that is above the reach, widens the reach step by step
/// as far as is needed.
void DeviationMeter::widen(const TargetSurface& target, const Spot& a, const Spot& b,
                           const Spot& c) {
  const double enough = split_.bound(target, a, b, c, reach_);
  while (reach_ < enough) {
    reach_ = std::min(enough, reach_ * kWidening);
    if (cover_.covers(a, b, c, reach_))
      return;
  }
}

/// The triangle beyond the edge was mapped too, runs along the edge the other way, and maps it in
/// the same way.
bool DeviationMeter::is_matched(std::uint32_t triangle, unsigned edge) const {
  const TargetSurface& fine = fine_.surface;
  const std::uint32_t other = fine.across(triangle, edge);
  if (other == kNone || fine_.mapped[other] == 0)
    return false;
  const unsigned there = fine.edge_across(triangle, edge);
  if (fine.across(other, there) != triangle ||
      fine.corners(other)[there] != fine.corners(triangle)[next_corner(edge)])
    return false;
  const Passage& passage = fine_.passages[triangle][edge];
  const Passage& known = fine_.passages[other][there];
  return passage.count == known.count && (passage.count == 0 || passage.begin == known.begin);
}

/// Marks the triangles whose inside may hold a part of the image of one step of an open edge. What
/// runs along an edge of a triangle leaves a sliver at most, no wider than rounding.
void DeviationMeter::mark_below(const Spot& from, const Spot& to) {
  constexpr double kSliver = 0x1p-46;  // of the largest coordinate; kRounding allows for it
  const double sliver = kSliver * largest_coordinate_;
  const auto is_on = [&](const Segment& edge, Vec3d point) {
    const Vec3d off = cross(point - edge.start, edge.direction);
    return dot(off, off) <= sliver * sliver * dot(edge.direction, edge.direction);
  };
  for (const Spot* spot : {&from, &to}) {
    for (const std::uint32_t t : spot->near) {
      if (t == kNone || !cover_.holds(t, from) || !cover_.holds(t, to))
        continue;
      bool along = false;
      for (unsigned edge = 0; edge < 3; ++edge) {
        const Segment side = coarse_.surface.edge(t, edge);
        along = along || (is_on(side, from.image) && is_on(side, to.image));
      }
      if (!along)
        open_[t] = 1;
    }
  }
}

void DeviationMeter::mark_open_edges() {
  const TargetSurface& fine = fine_.surface;
  open_.assign(coarse_.surface.triangle_count(), 0);
  for (std::uint32_t t = 0; t < fine.triangle_count(); ++t) {
    for (unsigned edge = 0; fine_.mapped[t] != 0 && edge < 3; ++edge) {
      if (is_matched(t, edge))
        continue;
      const TargetSurface::Corners& corners = fine.corners(t);
      cover_.for_each_step(fine_.spots[corners[edge]], fine_.passages[t][edge],
                           fine_.spots[corners[next_corner(edge)]],
                           [&](const Spot& from, const Spot& to) { mark_below(from, to); });
    }
  }
}

/// The mapped pieces cover the triangle. Its degree is a whole number but for rounding, which is
/// small if the triangle is much wider than coordinates are exact.
bool DeviationMeter::is_covered(std::uint32_t coarse_triangle) const {
  if (open_[coarse_triangle] != 0 || !coarse_.surface.is_simple(coarse_triangle))
    return false;
  constexpr double kLeastWidth = 0x1p-30;  // of the largest coordinate: a degree is right to 2^-20
  const TriangleFrame frame = coarse_.surface.frame(coarse_triangle);
  const Vec3d normal = cross(frame.ab, frame.ac);
  const double area = dot(normal, normal);
  const double least = kLeastWidth * largest_coordinate_;
  if (!(area > least * least * std::max(frame.bb, frame.cc)))
    return false;
  constexpr double kTolerance = 1e-3;
  const double degree = mapped_area_[coarse_triangle] / area;
  const double whole = std::round(degree);
  return whole != 0 && std::abs(degree - whole) < kTolerance;
}

Deviation DeviationMeter::measure(const DeviationInput& input) {
  if (input.weights.size() < input.fine.own_count ||
      input.fine.own_count > input.fine.positions.size() ||
      input.coarse_of.size() != input.fine.positions.size())
    throw Error(ErrorCode::internal, "weights or vertex map do not fit the fine patch");
  const auto key_count = static_cast<std::uint32_t>(input.coarse.positions.size());
  fine_.surface.assign(input.fine, input.coarse_of, key_count);
  coarse_.surface.assign(input.coarse, {}, key_count);
  border_ = input.border;
  largest_coordinate_ = std::max(largest_coordinate(input.fine.positions),
                                 largest_coordinate(input.coarse.positions));
  const double rounding = kRounding * largest_coordinate_;
  reach_ = rounding * rounding;

  split_.allow(kSplitDistances * fine_.surface.triangle_count());

  Deviation result;
  land_fine_vertices(input, result);
  result.collapsed_triangles = certify_fine();
  mark_open_edges();
  const std::uint64_t missing = certify_coarse();
  if (missing > 0)
    result.bound = std::numeric_limits<double>::infinity();
  else if (fine_.surface.triangle_count() + coarse_.surface.triangle_count() > 0)
    result.bound = std::sqrt(reach_) * (1 + 0x1p-40) + rounding;
  return result;
}

}  // namespace meshhier::cluster_simplify
