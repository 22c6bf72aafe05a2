#include "cluster_simplify/target_surface.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

/// Calls `visit` with each distinct known key of a triangle.
template <class Visit>
void for_each_key(const TargetSurface::Corners& keys, const Visit& visit) {
  if (keys[0] != kNone)
    visit(keys[0]);
  if (keys[1] != kNone && keys[1] != keys[0])
    visit(keys[1]);
  if (keys[2] != kNone && keys[2] != keys[0] && keys[2] != keys[1])
    visit(keys[2]);
}

/// Turns counts into the ends of rows; filling them backwards turns those into starts.
std::uint32_t sum_up(std::vector<std::uint32_t>& counts) {
  std::uint32_t sum = 0;
  for (std::uint32_t& entry : counts)
    entry = sum += entry;
  return sum;
}

}  // namespace

SurfacePatch patch_of(const TileMesh& mesh) {
  return {mesh.vertices.positions, mesh.own_count, mesh.interior, mesh.border};
}

void TargetSurface::assign(const SurfacePatch& patch, std::span<const std::uint32_t> coarse_of,
                           std::uint32_t key_count) {
  if (!coarse_of.empty() && coarse_of.size() != patch.positions.size())
    throw Error(ErrorCode::internal, "a vertex map does not fit its patch");
  positions_ = patch.positions;
  coarse_of_ = coarse_of;
  own_count_ = patch.own_count;
  triangles_.clear();
  keys_.clear();
  used_.assign(patch.positions.size(), 0);
  for (const Triangle& t : patch.interior)
    add(t, key_count);
  for (const Triangle& t : patch.border)
    add(t, key_count);
  build_stars(key_count);
  build_neighbours();
}

void TargetSurface::add(const Triangle& triangle, std::uint32_t key_count) {
  if (is_degenerate(triangle))
    return;
  Corners corners{};
  Corners keys{};
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = raw(triangle[i]);
    if (corners[i] >= positions_.size())
      throw Error(ErrorCode::internal, "a triangle's corner lies outside its patch");
    keys[i] = key(corners[i]);
    if (keys[i] >= key_count && keys[i] != kNone)
      throw Error(ErrorCode::internal, "a vertex map leads outside the coarse patch");
    used_[corners[i]] = 1;
  }
  triangles_.push_back(corners);
  keys_.push_back(keys);
}

bool TargetSurface::has_own_corner(std::uint32_t triangle) const {
  const Corners& c = triangles_[triangle];
  return is_own(c[0]) || is_own(c[1]) || is_own(c[2]);
}

void TargetSurface::build_stars(std::uint32_t key_count) {
  start_.assign(std::size_t{key_count} + 1, 0);
  for (const Corners& keys : keys_)
    for_each_key(keys, [&](std::uint32_t k) { ++start_[k]; });
  star_.resize(sum_up(start_));
  for (std::uint32_t t = triangle_count(); t-- > 0;)
    for_each_key(keys_[t], [&](std::uint32_t k) { star_[--start_[k]] = t; });
}

void TargetSurface::build_neighbours() {
  edge_start_.assign(positions_.size() + 1, 0);
  const auto ends = [&](std::uint32_t t, std::uint32_t edge) {
    const Corners& c = triangles_[t];
    const std::uint32_t from = c[edge];
    const std::uint32_t to = c[edge == 2 ? 0 : edge + 1];
    return std::pair(std::min(from, to), std::max(from, to));
  };
  for (std::uint32_t t = 0; t < triangle_count(); ++t) {
    for (std::uint32_t edge = 0; edge < 3; ++edge)
      ++edge_start_[ends(t, edge).first];
  }
  half_edges_.resize(sum_up(edge_start_));
  for (std::uint32_t t = triangle_count(); t-- > 0;) {
    for (std::uint32_t edge = 3; edge-- > 0;) {
      const auto [lower, upper] = ends(t, edge);
      half_edges_[--edge_start_[lower]] = {upper, t, edge};
    }
  }
  simple_.assign(triangles_.size(), 1);
  edge_across_.resize(triangles_.size());
  across_.assign(triangles_.size(), Corners{kNone, kNone, kNone});
  for (std::size_t v = 0; v + 1 < edge_start_.size(); ++v) {
    const std::span<HalfEdge> row(half_edges_.data() + edge_start_[v],
                                  half_edges_.data() + edge_start_[v + 1]);
    std::sort(row.begin(), row.end(), [](const HalfEdge& a, const HalfEdge& b) {
      return std::tie(a.upper, a.triangle) < std::tie(b.upper, b.triangle);
    });
    for (std::size_t begin = 0, end = 0; begin < row.size(); begin = end) {
      while (end < row.size() && row[end].upper == row[begin].upper)
        ++end;
      connect(row.subspan(begin, end - begin));
    }
  }
}

void TargetSurface::connect(std::span<const HalfEdge> around_edge) {
  const std::size_t count = around_edge.size();
  if (count < 2)
    return;
  const auto opposite = [&](const HalfEdge& half) {
    return triangles_[half.triangle][half.edge == 0 ? 2 : half.edge - 1];
  };
  const bool simple = count == 2 && opposite(around_edge[0]) != opposite(around_edge[1]);
  for (std::size_t i = 0; i < count; ++i) {
    const HalfEdge& half = around_edge[i];
    const HalfEdge& next = around_edge[i + 1 < count ? i + 1 : 0];
    across_[half.triangle][half.edge] = next.triangle;
    edge_across_[half.triangle][half.edge] = static_cast<std::uint8_t>(next.edge);
    if (!simple)
      simple_[half.triangle] = 0;
  }
}

}  // namespace meshhier::cluster_simplify
