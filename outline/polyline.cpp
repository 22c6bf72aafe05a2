#include "outline/polyline.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>
#include <numeric>

namespace meshhier::outline {
namespace {

constexpr double kAlways = std::numeric_limits<double>::infinity();

using Segment = std::array<std::uint32_t, 2>;

std::uint32_t other_end(const Segment& segment, std::uint32_t node) {
  return segment[segment[0] == node ? 1 : 0];
}

/// Segments by node: those of node v are [first[v], first[v + 1]), towards ascending nodes.
struct Adjacency {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> at;

  Adjacency(std::uint32_t node_count, std::span<const Segment> segments)
      : first(node_count + 1, 0), at(2 * segments.size()) {
    for (const auto& [a, b] : segments) {
      ++first[a + 1];
      ++first[b + 1];
    }
    for (std::uint32_t v = 0; v < node_count; ++v)
      first[v + 1] += first[v];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t s = 0; s < segments.size(); ++s) {
      for (const std::uint32_t v : segments[s])
        at[next[v]++] = s;
    }
    for (std::uint32_t v = 0; v < node_count; ++v) {
      std::ranges::sort(at.begin() + first[v], at.begin() + first[v + 1], {},
                        [&](std::uint32_t s) { return other_end(segments[s], v); });
    }
  }

  std::span<const std::uint32_t> of(std::uint32_t node) const {
    return std::span(at).subspan(first[node], first[node + 1] - first[node]);
  }
};

class Tracer {
 public:
  Tracer(std::uint32_t node_count, std::span<const Segment> segments)
      : segments_(segments), adjacency_(node_count, segments), used_(segments.size(), false) {
    // What is not used of it takes no memory; an array that grows is there twice.
    chains_.nodes.reserve(2 * segments.size());
    chains_.starts.reserve(segments.size() + 1);
  }

  /// All chains that leave `node`, as far as they are not traced yet.
  void trace_from(std::uint32_t node) {
    for (const std::uint32_t segment : adjacency_.of(node)) {
      if (!used_[segment])
        follow(node, segment);
    }
  }
  bool is_junction(std::uint32_t node) const { return adjacency_.of(node).size() != 2; }
  Chains take() { return std::move(chains_); }

 private:
  void follow(std::uint32_t start, std::uint32_t segment) {
    chains_.nodes.push_back(start);
    for (std::uint32_t node = start;;) {
      used_[segment] = true;
      node = other_end(segments_[segment], node);
      chains_.nodes.push_back(node);
      if (node == start || is_junction(node))
        break;
      const std::span<const std::uint32_t> two = adjacency_.of(node);
      segment = two[two[0] == segment ? 1 : 0];
    }
    chains_.starts.push_back(static_cast<std::uint32_t>(chains_.nodes.size()));
  }

  std::span<const Segment> segments_;
  Adjacency adjacency_;
  std::vector<bool> used_;
  Chains chains_;
};

/// The point strictly between first and last that is farthest from the segment of the two.
struct Farthest {
  std::size_t point = 0;
  double distance = -1;
};

Farthest farthest_from_chord(std::span<const Vec3f> points, std::size_t first, std::size_t last) {
  const Vec3d a = to_double(points[first]), b = to_double(points[last]);
  Farthest result;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double distance = distance_to_segment(to_double(points[i]), a, b);
    if (distance > result.distance)
      result = {i, distance};
  }
  return result;
}

/// The ends and, of a closed polyline, the two more points that are never dropped; ascending.
std::vector<std::size_t> anchors(std::span<const Vec3f> points, bool closed) {
  const std::size_t last = points.size() - 1;
  if (!closed || last < 3)
    return {0, last};
  const std::size_t opposite = farthest_from_chord(points, 0, last).point;
  const Vec3d a = to_double(points[0]), b = to_double(points[opposite]);
  Farthest third;
  for (std::size_t i = 1; i < last; ++i) {
    const double distance = distance_to_segment(to_double(points[i]), a, b);
    if (i != opposite && distance > third.distance)
      third = {i, distance};
  }
  return {0, std::min(opposite, third.point), std::max(opposite, third.point), last};
}

}  // namespace

Chains trace_chains(std::uint32_t node_count,
                    std::span<const std::array<std::uint32_t, 2>> segments) {
  Tracer tracer(node_count, segments);
  for (std::uint32_t node = 0; node < node_count; ++node) {
    if (tracer.is_junction(node))
      tracer.trace_from(node);
  }
  for (std::uint32_t node = 0; node < node_count; ++node)
    tracer.trace_from(node);
  return tracer.take();
}

double distance_to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d along = b - a, from = p - a;
  const double square = dot(along, along);
  const double t = square > 0 ? std::clamp(dot(from, along) / square, 0.0, 1.0) : 0.0;
  return length(from - along * t);
}

double length_of(std::span<const Vec3f> points) {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    sum += length(to_double(points[i]) - to_double(points[i - 1]));
  }
  return sum;
}

std::vector<double> significance(std::span<const Vec3f> points, bool closed, double least) {
  assert(points.size() >= 2);
  /// Between two kept points; a point between them is not kept beyond `limit`, where they are not.
  struct Range {
    std::size_t first, last;
    double limit;
    int depth;
  };
  // Lines that are not built to be lopsided have about 2 log2(n) levels of splits.
  const int deepest = 8 * static_cast<int>(std::bit_width(points.size()));
  std::vector<double> result(points.size(), 0.0);
  std::vector<Range> open;
  const std::vector<std::size_t> kept = anchors(points, closed);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    result[kept[i]] = kAlways;
    if (i > 0)
      open.push_back({kept[i - 1], kept[i], kAlways, 0});
  }
  while (!open.empty()) {
    const auto [first, last, above, depth] = open.back();
    open.pop_back();
    const Farthest farthest = farthest_from_chord(points, first, last);
    if (farthest.distance <= least)
      continue;
    const std::size_t split = depth < deepest ? farthest.point : std::midpoint(first, last);
    const double limit = std::min(farthest.distance, above);
    result[split] = limit;
    open.push_back({first, split, limit, depth + 1});
    open.push_back({split, last, limit, depth + 1});
  }
  return result;
}

}  // namespace meshhier::outline
