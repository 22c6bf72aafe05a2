#include "outline/subdivision.h"

#include "hierarchy/bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
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

/// Of own vertices, without those of other tiles.
class Neighbours {
 public:
  explicit Neighbours(const TileMesh& tile) : first_(tile.own_count + 1, 0) {
    visit(tile, [&](std::uint32_t a, std::uint32_t) { ++first_[a + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    all_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    visit(tile, [&](std::uint32_t a, std::uint32_t b) { all_[next[a]++] = b; });
  }

  /// Those behind it on the sides of its triangles: inside an oriented surface each one once.
  std::span<const std::uint32_t> operator[](std::uint32_t vertex) const {
    return std::span(all_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  template <class Visit>
  static void visit(const TileMesh& tile, const Visit& visit) {
    for (const std::vector<TileTriangle>* triangles : {&tile.interior, &tile.border}) {
      for (const TileTriangle& t : *triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t a = raw(t[i]), b = raw(t[(i + 1) % 3]);
          if (a != b && a < tile.own_count && b < tile.own_count)
            visit(a, b);
        }
      }
    }
  }

  std::vector<std::uint32_t> first_, all_;
};

inline Vec3f of_length_one(Vec3d v) {
  const double size = length(v);
  return size > 0 && std::isfinite(size) ? to_float(v * (1 / size)) : Vec3f{};
}

/// Weighted by area, of the own vertices.
std::vector<Vec3f> normals_of(const TileMesh& tile) {
  std::vector<Vec3d> sums(tile.own_count);
  for (const std::vector<TileTriangle>* triangles : {&tile.interior, &tile.border}) {
    for (const TileTriangle& t : *triangles) {
      const auto at = [&](std::size_t i) { return to_double(tile.vertices.positions[raw(t[i])]); };
      const Vec3d normal = cross(at(1) - at(0), at(2) - at(0));
      for (const TileVertex v : t) {
        if (raw(v) < tile.own_count)
          sums[raw(v)] = sums[raw(v)] + normal;
      }
    }
  }
  std::vector<Vec3f> normals;
  for (const Vec3d& sum : sums)
    normals.push_back(of_length_one(sum));
  return normals;
}

void smooth(std::vector<Vec3f>& normals, const Neighbours& neighbours) {
  // Floats, held as doubles: each is added six times for once that it is made.
  std::vector<Vec3d> now(normals.size()), next(normals.size());
  std::ranges::transform(normals, now.begin(), [](Vec3f n) { return to_double(n); });
  for (int round = 0; round < kNormalRounds; ++round) {
    for (std::uint32_t v = 0; v < now.size(); ++v) {
      Vec3d sum = now[v];
      for (const std::uint32_t other : neighbours[v])
        sum = sum + now[other];
      next[v] = to_double(of_length_one(sum));
    }
    now.swap(next);
  }
  std::ranges::transform(now, normals.begin(), [](Vec3d n) { return to_float(n); });
}

/// What vertices are told apart by.
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
  if (lead == neighbours.size())
    return candidate;  // all of them
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
  std::vector<Vec3f> normals = normals_of(tile);
  smooth(normals, neighbours);
  std::vector<std::uint32_t> vertices(tile.own_count);
  std::iota(vertices.begin(), vertices.end(), 0U);
  cut({tile.vertices.positions, normals}, vertices, 0, parts, part_of);
  even_out(part_of, neighbours);
  return part_of;
}

}  // namespace meshhier::outline
