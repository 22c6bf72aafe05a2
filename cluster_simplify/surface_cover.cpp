#include "cluster_simplify/surface_cover.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

/// A vertex may have as many triangles as the tile; so many bound the time, whatever the mesh. Six
/// and ten are usual on the coarse and on the fine side.
constexpr std::size_t kMostCandidates = 128;

/// Steps of one walk along an edge: a coarse triangle may be a hundred times larger than the fine
/// ones below it where the surface is flat.
constexpr int kMostSteps = 64;

/// Rings of one triangle, with all its parts.
constexpr int kMostRings = 128;

/// Moves of one descent; two or three are usual.
constexpr int kMostMoves = 16;

std::span<const std::uint32_t> candidates(const TargetSurface& target, std::uint32_t key) {
  const auto all = target.around(key);
  return all.first(std::min(all.size(), kMostCandidates));
}

}  // namespace

std::span<const std::uint32_t> candidates_around(const TargetSurface& target,
                                                 std::uint32_t vertex) {
  return candidates(target, target.key(vertex));
}

namespace {

Spot spot_in(const TargetSurface& target, std::uint32_t triangle, Vec3d point) {
  const ClosestPoint closest = closest_point(point, target.frame(triangle));
  Spot spot{point, closest.point, {triangle, kNone}, kNone};
  const auto feature = static_cast<unsigned>(closest.feature);
  if (closest.feature >= Feature::corner_0)
    spot.vertex = target.corners(triangle)[feature - static_cast<unsigned>(Feature::corner_0)];
  else if (closest.feature >= Feature::edge_0)
    spot.near[1] = target.across(triangle, feature - static_cast<unsigned>(Feature::edge_0));
  return spot;
}

}  // namespace

Spot nearest_around(const TargetSurface& target, std::uint32_t key, Vec3d point) {
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t best = kNone;
  for (const std::uint32_t t : candidates(target, key)) {
    const double distance = squared_distance(point, target.frame(t));
    if (distance < least) {
      least = distance;
      best = t;
    }
  }
  return best == kNone ? Spot{point, {}, {kNone, kNone}, kNone} : spot_in(target, best, point);
}

Spot descend(const TargetSurface& target, std::uint32_t start, Vec3d point) {
  std::uint32_t best = start;
  double least = squared_distance(point, target.frame(start));
  for (int move = 0; move < kMostMoves; ++move) {
    const std::uint32_t at = best;
    for (const std::uint32_t corner : target.corners(at)) {
      for (const std::uint32_t t : candidates_around(target, corner)) {
        const double distance = squared_distance(point, target.frame(t));
        if (distance < least) {
          least = distance;
          best = t;
        }
      }
    }
    if (best == at)
      break;
  }
  return spot_in(target, best, point);
}

Spot spot_on_vertex(const TargetSurface& target, std::uint32_t vertex, std::uint32_t triangle) {
  const Vec3d point = target.position(vertex);
  return {point, point, {triangle, kNone}, vertex};
}

bool SurfaceCover::holds(std::uint32_t triangle, const Spot& spot) const {
  return spot.near[0] == triangle || spot.near[1] == triangle ||
         (spot.vertex != kNone && target_->has_corner(triangle, spot.vertex));
}

/// A triangle with all these corners, or kNone.
std::uint32_t SurfaceCover::joining(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  for (const std::uint32_t t : candidates_around(*target_, a)) {
    if (target_->has_corner(t, a) && target_->has_corner(t, b) && target_->has_corner(t, c))
      return t;
  }
  return kNone;
}

/// One target triangle holds both images.
bool SurfaceCover::common(const Spot& a, const Spot& b) const {
  for (const std::uint32_t t : a.near) {
    if (t != kNone && holds(t, b))
      return true;
  }
  if (a.vertex == kNone)
    return false;
  for (const std::uint32_t t : b.near) {
    if (t != kNone && target_->has_corner(t, a.vertex))
      return true;
  }
  return b.vertex != kNone && joining(a.vertex, b.vertex, b.vertex) != kNone;
}

/// A target triangle that holds all three images, or kNone.
std::uint32_t SurfaceCover::common(const Spot& a, const Spot& b, const Spot& c) const {
  for (const std::uint32_t t : a.near) {
    if (t != kNone && holds(t, b) && holds(t, c))
      return t;
  }
  if (a.vertex == kNone)
    return kNone;
  for (const std::uint32_t t : b.near) {
    if (t != kNone && target_->has_corner(t, a.vertex) && holds(t, c))
      return t;
  }
  if (b.vertex == kNone)
    return kNone;
  for (const std::uint32_t t : c.near) {
    if (t != kNone && target_->has_corner(t, a.vertex) && target_->has_corner(t, b.vertex))
      return t;
  }
  return c.vertex == kNone ? kNone : joining(a.vertex, b.vertex, c.vertex);
}

/// Maps abc linearly if that is possible.
bool SurfaceCover::add_piece(const Spot& a, const Spot& b, const Spot& c) {
  const std::uint32_t t = common(a, b, c);
  if (t == kNone)
    return false;
  const Vec3d normal = cross(target_->edge(t, 0).direction, target_->edge(t, 1).direction);
  pieces_.push_back({t, dot(cross(b.image - a.image, c.image - a.image), normal)});
  return true;
}

/// Takes an edge as the way out if the path passes it within reach, and later than the best so far.
bool SurfaceCover::try_edge(const Segment& path, std::uint32_t triangle, unsigned edge,
                            Exit& best) const {
  const std::uint32_t next = target_->across(triangle, edge);
  if (next == kNone)
    return false;
  const Encounter meet = closest(path, target_->edge(triangle, edge));
  if (meet.squared_distance > reach_ || meet.on_first <= best.meet.on_first)
    return false;
  best = {triangle, next, edge, meet};
  return true;
}

void SurfaceCover::leave_start(const Segment& path, std::uint32_t triangle, Exit& best) const {
  for (unsigned edge = 0; edge < 3; ++edge)
    try_edge(path, triangle, edge, best);
}

/// Of the two edges ahead, first the one on whose side of their common corner the path passes.
void SurfaceCover::leave_onwards(const Segment& path, std::uint32_t behind, std::uint32_t triangle,
                                 Exit& best) const {
  unsigned entry = 0;
  while (entry < 2 && target_->across(triangle, entry) != behind)
    ++entry;
  const unsigned right = entry == 2 ? 0 : entry + 1;
  const unsigned left = right == 2 ? 0 : right + 1;
  const TargetSurface::Corners& corners = target_->corners(triangle);
  const Vec3d u = target_->position(corners[entry]);
  const Vec3d w = target_->position(corners[left]);
  const Vec3d normal = cross(target_->position(corners[right]) - u, w - u);
  const bool go_left = dot(cross(path.direction, w - path.start), normal) < 0;
  if (!try_edge(path, triangle, go_left ? left : right, best))
    try_edge(path, triangle, go_left ? right : left, best);
}

void SurfaceCover::leave_fan(const Segment& path, std::uint32_t vertex, Exit& best) const {
  for (const std::uint32_t t : candidates_around(*target_, vertex)) {
    const TargetSurface::Corners& corners = target_->corners(t);
    for (unsigned i = 0; i < 3; ++i) {
      if (corners[i] == vertex)
        try_edge(path, t, i == 2 ? 0 : i + 1, best);
    }
  }
}

Spot SurfaceCover::spot_of(const Segment& path, const Exit& exit) const {
  const Segment side = target_->edge(exit.triangle, exit.edge);
  const TargetSurface::Corners& corners = target_->corners(exit.triangle);
  const double along = exit.meet.on_second;
  Spot spot{path.start + path.direction * exit.meet.on_first,
            side.start + side.direction * along,
            {exit.triangle, exit.next},
            kNone};
  if (along <= 0)
    spot.vertex = corners[exit.edge];
  else if (along >= 1)
    spot.vertex = corners[exit.edge == 2 ? 0 : exit.edge + 1];
  return spot;
}

/// The usual case: the ends are near triangles with a common edge.
bool SurfaceCover::step_across(std::vector<Spot>& out, const Spot& from, const Spot& to) const {
  const Segment path{from.point, to.point - from.point};
  for (const std::uint32_t t : from.near) {
    for (unsigned edge = 0; t != kNone && edge < 3; ++edge) {
      const std::uint32_t next = target_->across(t, edge);
      Exit exit{.meet = {.on_first = -1}};
      if (next == kNone || !holds(next, to) || !try_edge(path, t, edge, exit))
        continue;
      out.push_back(spot_of(path, exit));
      return true;
    }
  }
  return false;
}

bool SurfaceCover::walk(std::vector<Spot>& out, const Spot& from, const Spot& to) const {
  const Segment path{from.point, to.point - from.point};
  std::uint32_t behind = kNone;
  std::uint32_t at = from.near[0];
  std::uint32_t vertex = from.vertex;
  double progress = -1;
  for (int step = 0; step < kMostSteps; ++step) {
    Exit exit{.meet = {.on_first = progress}};
    if (step > 0)
      leave_onwards(path, behind, at, exit);
    else if (vertex == kNone)
      leave_start(path, at, exit);
    if (exit.next == kNone && vertex != kNone)
      leave_fan(path, vertex, exit);
    if (exit.next == kNone)
      return false;
    const Spot spot = spot_of(path, exit);
    out.push_back(spot);
    if (common(spot, to))
      return true;
    behind = exit.triangle;
    at = exit.next;
    vertex = spot.vertex;
    progress = exit.meet.on_first;
  }
  return false;
}

/// Appends points on the way from `from` to `to`, so that one target triangle holds the images of
/// neighbours. The way is sought from the end that is in fewer triangles.
bool SurfaceCover::link(std::vector<Spot>& out, const Spot& from, const Spot& to) {
  if (common(from, to))
    return true;
  if (from.vertex == kNone || to.vertex != kNone)
    return step_across(out, from, to) || walk(out, from, to);
  const auto begin = static_cast<std::ptrdiff_t>(out.size());
  const bool found = step_across(out, to, from) || walk(out, to, from);
  std::reverse(out.begin() + begin, out.end());
  return found;
}

/// Cuts off corners of the ring whose image lies with their neighbours' in one triangle.
void SurfaceCover::clip(std::size_t begin) {
  std::size_t at = 0;
  std::size_t kept = 0;  // corners since the last cut
  for (std::size_t size = ring_.size() - begin; size > 2 && kept < size;) {
    const std::size_t before = begin + (at + size - 1) % size;
    const std::size_t after = begin + (at + 1) % size;
    if (!add_piece(ring_[before], ring_[begin + at], ring_[after])) {
      ++kept;
      at = (at + 1) % size;
      continue;
    }
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(begin + at));
    --size;
    kept = 0;
    at = (at + size - 1) % size;
  }
}

/// A point to join a ring to: the foot of the target vertex most of the ring knows; if none is
/// within reach, the ring's middle. Not found if that is out of reach too.
Spot SurfaceCover::tip_of(std::size_t begin, const TriangleFrame& frame) const {
  constexpr std::size_t kMostTried = 24;  // a ring of eight with three vertices each
  std::array<std::uint32_t, kMostTried> tried{};
  std::size_t tried_count = 0;
  std::ptrdiff_t most = 0;
  Spot tip;
  const std::span<const Spot> ring(ring_.data() + begin, ring_.data() + ring_.size());
  const auto votes_for = [&](std::uint32_t vertex) {
    return std::count_if(ring.begin(), ring.end(), [&](const Spot& spot) {
      return target_->has_corner(spot.near[0], vertex) ||
             (spot.near[1] != kNone && target_->has_corner(spot.near[1], vertex));
    });
  };
  for (const Spot& spot : ring) {
    for (const std::uint32_t vertex : target_->corners(spot.near[0])) {
      const auto end = tried.begin() + static_cast<std::ptrdiff_t>(tried_count);
      if (tried_count == kMostTried || std::find(tried.begin(), end, vertex) != end)
        continue;
      tried[tried_count++] = vertex;
      const Vec3d image = target_->position(vertex);
      const PlaneFoot foot = plane_foot(image, frame);
      if (!foot.inside || foot.squared_distance > reach_)
        continue;
      const auto votes = votes_for(vertex);
      if (votes > most) {
        most = votes;
        tip = {foot.point, image, {spot.near[0], kNone}, vertex};
      }
    }
  }
  if (most > 0)
    return tip;
  Vec3d middle;
  for (const Spot& spot : ring)
    middle = middle + spot.point * (1.0 / static_cast<double>(ring.size()));
  const Spot spot = descend(*target_, ring[0].near[0], middle);
  return spot.squared_distance() <= reach_ ? spot : Spot{};
}

/// Every edge of the ring with the tip, and what is cut off by passages to the tip.
bool SurfaceCover::cover_cone(std::size_t begin, const Spot& tip) {
  const std::size_t end = ring_.size();
  const std::size_t first_spoke = spokes_.size();
  std::vector<std::size_t>& ends = spoke_ends_;
  const std::size_t first_end = ends.size();
  bool covered = true;
  for (std::size_t i = begin; covered && i < end; ++i) {
    covered = link(spokes_, ring_[i], tip);
    ends.push_back(spokes_.size());
  }
  const auto spoke = [&](std::size_t i) {  // of the ring's i-th corner, from the corner to the tip
    const std::size_t from = i == 0 ? first_spoke : ends[first_end + i - 1];
    return std::pair(from, ends[first_end + i]);
  };
  const std::size_t size = end - begin;
  for (std::size_t i = 0; covered && i < size; ++i) {
    const std::size_t j = i + 1 < size ? i + 1 : 0;
    const Spot a = ring_[begin + i];
    const Spot b = ring_[begin + j];
    if (add_piece(a, b, tip))
      continue;
    const auto [a_from, a_to] = spoke(i);
    const auto [b_from, b_to] = spoke(j);
    ring_.push_back(a);
    ring_.push_back(b);
    for (std::size_t k = b_from; k < b_to; ++k)
      ring_.push_back(spokes_[k]);
    ring_.push_back(tip);
    for (std::size_t k = a_to; k-- > a_from;)
      ring_.push_back(spokes_[k]);
    covered = cover_ring(end, {a.point, b.point, tip.point});
    ring_.resize(end);
  }
  spokes_.resize(first_spoke);
  ends.resize(first_end);
  return covered;
}

bool SurfaceCover::cover_ring(std::size_t begin, const TriangleFrame& frame) {
  clip(begin);
  if (ring_.size() - begin <= 2)
    return true;
  if (--budget_ < 0)
    return false;
  const Spot tip = tip_of(begin, frame);
  return tip.found() && cover_cone(begin, tip);
}

void SurfaceCover::start(const TargetSurface& target) {
  target_ = &target;
  passages_.clear();
}

Passage SurfaceCover::find_passage(const Spot& a, const Spot& b, double squared_reach) {
  reach_ = squared_reach;
  Passage passage;
  passage.begin = static_cast<std::uint32_t>(passages_.size());
  passage.state = link(passages_, a, b) ? Passage::found : Passage::failed;
  passage.count = static_cast<std::uint32_t>(passages_.size()) - passage.begin;
  return passage;
}

bool SurfaceCover::covers(const std::array<Side, 3>& sides, double squared_reach) {
  reach_ = squared_reach;
  budget_ = kMostRings;
  ring_.clear();
  pieces_.clear();
  for (const Side& side : sides) {
    if (side.passage.state != Passage::found)
      return false;
    ring_.push_back(*side.from);
    const auto begin = passages_.begin() + side.passage.begin;
    const auto end = begin + side.passage.count;
    if (side.reversed)
      ring_.insert(ring_.end(), std::reverse_iterator(end), std::reverse_iterator(begin));
    else
      ring_.insert(ring_.end(), begin, end);
  }
  return cover_ring(0, {sides[0].from->point, sides[1].from->point, sides[2].from->point});
}

bool SurfaceCover::covers_at_once(const Spot& a, const Spot& b, const Spot& c) {
  pieces_.clear();
  return add_piece(a, b, c);
}

bool SurfaceCover::covers(const Spot& a, const Spot& b, const Spot& c, double squared_reach) {
  if (covers_at_once(a, b, c))
    return true;
  const std::size_t kept = passages_.size();
  const bool covered = covers(
      {Side{&a, find_passage(a, b, squared_reach)}, Side{&b, find_passage(b, c, squared_reach)},
       Side{&c, find_passage(c, a, squared_reach)}},
      squared_reach);
  passages_.resize(kept);
  return covered;
}

}  // namespace meshhier::cluster_simplify
