// Polylines: traced from loose segments, and simplified.
#pragma once

#include "base/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::outline {

/// Chain i is the nodes [starts[i], starts[i + 1]); a closed one repeats its first node as its
/// last.
struct Chains {
  std::vector<std::uint32_t> nodes;
  std::vector<std::uint32_t> starts{0};

  std::size_t size() const { return starts.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t chain) const {
    return std::span(nodes).subspan(starts[chain], starts[chain + 1] - starts[chain]);
  }
};

/// Joins segments into chains, each segment in exactly one. Chains run between junctions, the nodes
/// that have one, three or more segments; what has no junction is a closed chain that starts at its
/// least node. `segments`: pairs of different nodes < node_count, without repeats. The result
/// depends on their set only. O(n log n).
Chains trace_chains(std::uint32_t node_count,
                    std::span<const std::array<std::uint32_t, 2>> segments);

/// Distance of p from the segment a b (from its nearer end, if p lies beyond).
double distance_to_segment(Vec3d p, Vec3d a, Vec3d b);

/// Sum of the distances between consecutive points.
double length_of(std::span<const Vec3f> points);

/// For every point of a polyline the tolerance up to which Douglas & Peucker (1973) keep it: the
/// points whose number is above t are the polyline simplified with tolerance t, no original point
/// farther than t from it; for every t >= `least` (what only smaller tolerances would keep has 0).
/// The ends are kept always (infinity). A closed polyline (points.front() == points.back(), so
/// `closed`) is split at its point farthest from the start and keeps that and a third point always:
/// it never gets less than a triangle. Requires two points or more and least >= 0. O(n log n),
/// without recursion: ranges more than 8 log2(n) splits deep, which only contrived lines have, are
/// halved instead of split at their farthest point; that keeps the tolerance, with a few points
/// more.
std::vector<double> significance(std::span<const Vec3f> points, bool closed, double least);

}  // namespace meshhier::outline
