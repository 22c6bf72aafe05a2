#include "partition/bisect.h"

#include "partition/direction.h"
#include "partition/split_plane.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>

namespace meshhier::partition {
namespace {

// Only so many planes are refined, those of the shortest lines. All twelve would make lines shorter
// by a fiftieth, and splitting takes half as long again.
constexpr std::size_t kPlanes = 2;

// Regions are grown from so many vertices, evenly spread over the numbers. They follow the surface
// where planes cut through all of its shells: with none, the head's partitions are 6 % less
// compact.
constexpr std::uint64_t kSeeds = 1;

// Most rounds of refinement of a try: the first ones balance it.
constexpr int kRefineRounds = 3;

class Bisector {
 public:
  Bisector(const Graph& graph, std::span<const std::uint32_t> targets, RefineCounts& counts)
      : graph_(graph),
        targets_(targets),
        part_of_(graph.size()),
        place_(graph.size()),
        counts_(counts) {
    heaviest_ = *std::max_element(graph.weight.begin(), graph.weight.end());
  }

  std::vector<std::uint32_t> run() {
    std::vector<std::uint32_t> vertices(graph_.size());
    std::iota(vertices.begin(), vertices.end(), 0U);
    split({0, static_cast<std::uint32_t>(targets_.size())}, vertices);
    return std::move(part_of_);
  }

 private:
  struct Parts {
    std::uint32_t begin, end;
    std::uint32_t middle() const { return begin + (end - begin + 1) / 2; }
  };
  struct Try {
    std::int64_t imbalance = 0;
    std::int64_t cut = 0;
    friend auto operator<=>(const Try&, const Try&) = default;
  };

  /// The vertices of a node of the tree.
  void split(Parts parts, std::span<std::uint32_t> vertices) {
    if (parts.end - parts.begin == 1) {
      for (const std::uint32_t v : vertices)
        part_of_[v] = parts.begin;
      return;
    }
    if (vertices.empty())
      return;
    const Graph node = subgraph(graph_, vertices, place_);
    const std::vector<std::uint32_t> side =
        bisect(node, weight_of(parts.begin, parts.middle()), weight_of(parts.middle(), parts.end));
    for (std::size_t i = 0; i < vertices.size(); ++i)
      part_of_[vertices[i]] = side[i];  // until it has its part
    const auto second = std::stable_partition(vertices.begin(), vertices.end(),
                                              [&](std::uint32_t v) { return part_of_[v] == 0; });
    split({parts.begin, parts.middle()}, {vertices.begin(), second});
    split({parts.middle(), parts.end}, {second, vertices.end()});
  }

  std::uint32_t weight_of(std::uint32_t begin, std::uint32_t end) const {
    return std::accumulate(targets_.begin() + begin, targets_.begin() + end, 0U);
  }

  /// The best of several tries: each vertex's side, 0 or 1.
  std::vector<std::uint32_t> bisect(const Graph& node, std::uint32_t left, std::uint32_t right) {
    // The vertices' weight is shared as the targets are.
    const auto total = std::accumulate(node.weight.begin(), node.weight.end(), std::uint64_t{0});
    const double share = static_cast<double>(left) / (static_cast<double>(left) + right);
    const auto left_target = static_cast<std::uint32_t>(static_cast<double>(total) * share);
    const std::array<std::uint32_t, 2> targets{left_target,
                                               static_cast<std::uint32_t>(total) - left_target};
    std::vector<std::uint32_t> side(node.size()), best;
    Try best_try;
    const auto consider = [&] {
      const Try found = refine(node, targets, side);
      if (best.empty() || found < best_try) {
        best_try = found;
        best = side;
      }
    };
    for (const Vec3d& direction : best_planes(node, share)) {
      cut_by_plane(node, direction, share, side);
      consider();
    }
    for (std::uint64_t i = 0; i < kSeeds; ++i) {
      std::fill(side.begin(), side.end(), 0U);
      side[(2 * i + 1) * node.size() / (2 * kSeeds)] = 1;
      consider();
    }
    return best;
  }

  static std::vector<Vec3d> best_planes(const Graph& node, double share) {
    struct Plane {
      std::int64_t cut;
      Vec3d direction;
    };
    std::vector<Plane> planes;
    std::vector<std::uint32_t> side(node.size());
    for (const Vec3d& direction : candidate_directions(node.center, Axis::compactness)) {
      cut_by_plane(node, direction, share, side);
      planes.push_back({cut_weight(node, side), direction});
    }
    std::stable_sort(planes.begin(), planes.end(),
                     [](const Plane& a, const Plane& b) { return a.cut < b.cut; });
    std::vector<Vec3d> best;
    for (std::size_t i = 0; i < std::min(planes.size(), kPlanes); ++i)
      best.push_back(planes[i].direction);
    return best;
  }

  /// Sides of a plane, by numbers of vertices: their weights differ little, and refining sees to
  /// it.
  static void cut_by_plane(const Graph& node, Vec3d direction, double left_share,
                           std::vector<std::uint32_t>& side) {
    std::vector<SplitKey> keys(node.size());
    for (std::uint32_t v = 0; v < node.size(); ++v)
      keys[v] = key_along(direction, node.center[v], v);
    const auto first_right =
        keys.begin() + static_cast<std::ptrdiff_t>(left_share * static_cast<double>(node.size()));
    std::nth_element(keys.begin(), first_right, keys.end());
    for (auto key = keys.begin(); key != keys.end(); ++key)
      side[key->id] = key >= first_right ? 1 : 0;
  }

  static std::int64_t cut_weight(const Graph& node, const std::vector<std::uint32_t>& side) {
    std::int64_t sum = 0;
    for (std::uint32_t v = 0; v < node.size(); ++v) {
      for (const Graph::Arc& arc : node.arcs_of(v))
        sum += side[v] != side[arc.to] ? arc.weight : 0;
    }
    return sum;
  }

  Try refine(const Graph& node, std::span<const std::uint32_t> targets,
             std::vector<std::uint32_t>& side) {
    Refiner refiner(node, side, targets, std::vector<char>(node.size(), 1));
    const Slack slack{2 * std::int64_t{heaviest_}, 2 * std::int64_t{heaviest_}};
    refiner.refine_all(kRefineRounds, slack);
    counts_ += refiner.counts();
    const std::int64_t imbalance = std::abs(refiner.excess(0) - refiner.excess(1));
    return {std::max<std::int64_t>(0, imbalance - slack.kept), cut_weight(node, side)};
  }

  const Graph& graph_;
  std::span<const std::uint32_t> targets_;
  std::vector<std::uint32_t> part_of_;
  std::vector<std::uint32_t> place_;  ///< subgraph()'s workspace
  std::uint32_t heaviest_ = 0;
  RefineCounts& counts_;
};

}  // namespace

std::vector<std::uint32_t> bisect_recursively(const Graph& graph,
                                              std::span<const std::uint32_t> targets,
                                              RefineCounts& counts) {
  return Bisector(graph, targets, counts).run();
}

}  // namespace meshhier::partition
