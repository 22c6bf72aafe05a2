#include "outline/subdivision.h"

#include "base/bounds.h"
#include "outline/surface_normals.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>

namespace meshhier::outline {
namespace {

/// Rounds of taking the mean with the neighbours: roughness goes, the form of a sector stays.
constexpr int kNormalRounds = 16;
/// Rounds in which vertices follow their neighbours to another part.
constexpr int kPartRounds = 6;
/// A turn from one side to the other counts like so many widths of the part.
constexpr double kTurnWidths = 1;

/// Vertices are told apart by these.
struct Features {
  std::span<const Vec3f> positions, normals;
};

/// Three of the place, then three of the normal.
struct Axis {
  bool of_normals = false;
  int axis = 0;

  float of(const Features& features, std::uint32_t vertex) const {
    return (of_normals ? features.normals : features.positions)[vertex][axis];
  }
};

/// How far the vertices reach along each axis.
std::array<double, 3> reach_of(std::span<const Vec3f> values,
                               std::span<const std::uint32_t> vertices) {
  Bounds box;
  for (const std::uint32_t v : vertices)
    box.add(values[v]);
  const Vec3d size = to_double(box.max) - to_double(box.min);
  return {size.x, size.y, size.z};
}

int greatest(const std::array<double, 3>& values) {
  return static_cast<int>(std::max_element(values.begin(), values.end()) - values.begin());
}

/// Requires vertices.
Axis axis_for(const Features& features, std::span<const std::uint32_t> vertices) {
  const std::array<double, 3> sizes = reach_of(features.positions, vertices);
  const std::array<double, 3> turns = reach_of(features.normals, vertices);
  const Axis longest{false, greatest(sizes)}, widest_turn{true, greatest(turns)};
  std::array<double, 3> sorted = sizes;
  std::sort(sorted.begin(), sorted.end());
  const double width = sorted[1];
  const double turn = turns[static_cast<std::size_t>(widest_turn.axis)];
  return turn * kTurnWidths * width > sorted[2] ? widest_turn : longest;
}

/// Gives the vertices the parts from `first` on.
void cut(const Features& features, std::span<std::uint32_t> vertices, std::uint32_t first,
         std::uint32_t parts, std::vector<std::uint16_t>& part_of) {
  if (parts < 2 || vertices.size() < 2) {
    for (const std::uint32_t v : vertices)
      part_of[v] = static_cast<std::uint16_t>(first);
    return;
  }
  const Axis axis = axis_for(features, vertices);
  const std::uint32_t half = parts / 2;
  const std::size_t median = vertices.size() * half / parts;
  std::nth_element(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(median),
                   vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
                     const float x = axis.of(features, a), y = axis.of(features, b);
                     return x < y || (x == y && a < b);
                   });
  cut(features, vertices.first(median), first, half, part_of);
  cut(features, vertices.subspan(median), first + half, parts - half, part_of);
}

/// The part that most of its neighbours have, if more than half of them do; else its own.
std::uint16_t most_common(std::span<const std::uint32_t> neighbours,
                          const std::vector<std::uint16_t>& part_of, std::uint16_t own) {
  std::uint16_t candidate = own;  // Boyer & Moore, MJRTY, 1991
  std::size_t lead = 0, votes = 0;
  for (const std::uint32_t v : neighbours) {
    if (lead == 0)
      candidate = part_of[v];
    lead = part_of[v] == candidate ? lead + 1 : lead - 1;
  }
  for (const std::uint32_t v : neighbours)
    votes += part_of[v] == candidate ? 1 : 0;
  return 2 * votes > neighbours.size() ? candidate : own;
}

void even_out(std::vector<std::uint16_t>& part_of, const Neighbours& neighbours) {
  std::vector<std::uint16_t> next(part_of.size());
  for (int round = 0; round < kPartRounds; ++round) {
    for (std::uint32_t v = 0; v < part_of.size(); ++v)
      next[v] = most_common(neighbours[v], part_of, part_of[v]);
    part_of.swap(next);
  }
}

}  // namespace

std::vector<std::uint16_t> divide(const TileMesh& tile, std::uint32_t parts) {
  std::vector<std::uint16_t> part_of(tile.own_count, 0);
  if (parts < 2)
    return part_of;
  const Neighbours neighbours(tile);
  const std::vector<Vec3f> normals = smooth_normals(tile, neighbours, kNormalRounds);
  std::vector<std::uint32_t> vertices(tile.own_count);
  std::iota(vertices.begin(), vertices.end(), 0U);
  cut({tile.vertices.positions, normals}, vertices, 0, parts, part_of);
  even_out(part_of, neighbours);
  return part_of;
}

}  // namespace meshhier::outline
