#include "pipeline/measure_stage.h"

#include "cluster_simplify/closest_point.h"
#include "cluster_simplify/deviation.h"
#include "cluster_simplify/motion.h"
#include "cluster_simplify/nearest.h"
#include "cluster_simplify/seams.h"
#include "cluster_simplify/target_surface.h"
#include "pipeline/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

namespace meshhier::pipeline {
namespace {

using cluster_simplify::kNone;
using cluster_simplify::TargetSurface;

/// How far one contraction moved the surface: that of a tile, measured with what is around it.
struct Step {
  double certain = 0;
  double mean_square = 0;
  std::vector<std::uint32_t> finer_neighbours;  ///< tiles of the children's level, ascending
};

/// A tile, or two joined, and what is near in the neighbours.
struct Surroundings {
  TileMesh mesh;                     ///< border: also triangles of the neighbours' bands
  std::vector<GhostRef> references;  ///< of the vertices from own_count on, ascending
};

std::vector<Band> neighbours_bands(const Forest& forest, Level level,
                                   std::span<const GhostRef> ghosts) {
  std::vector<Band> bands;
  for (std::size_t i = 0; i < ghosts.size(); ++i) {
    if (i == 0 || ghosts[i].tile != ghosts[i - 1].tile)
      bands.push_back(forest.band({level, ghosts[i].tile}));
  }
  return bands;
}

/// Adds the neighbours' bands, without the triangles that have corners in `own_tiles`: the mesh has
/// those. Ghosts get new places.
Surroundings surround(const Forest& forest, Level level, TileMesh mesh,
                      std::span<const NodeId> own_tiles) {
  const auto is_own = [&](const GhostRef& ref) {
    return std::any_of(own_tiles.begin(), own_tiles.end(),
                       [&](NodeId tile) { return tile.index == ref.tile; });
  };
  const std::vector<Band> bands = neighbours_bands(forest, level, mesh.ghosts);
  std::vector<std::pair<GhostRef, Vec3f>> others;
  for (std::size_t i = 0; i < mesh.ghosts.size(); ++i)
    others.emplace_back(mesh.ghosts[i], mesh.vertices.positions[mesh.own_count + i]);
  for (const Band& band : bands) {
    for (std::size_t i = 0; i < band.vertices.size(); ++i) {
      if (!is_own(band.vertices[i]))
        others.emplace_back(band.vertices[i], band.positions[i]);
    }
  }
  const auto by_reference = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::sort(others.begin(), others.end(), by_reference);
  others.erase(std::unique(others.begin(), others.end(),
                           [](const auto& a, const auto& b) { return a.first == b.first; }),
               others.end());
  const auto place_of = [&](const GhostRef& ref) {
    const auto found =
        std::lower_bound(others.begin(), others.end(), std::pair(ref, Vec3f{}), by_reference);
    return TileVertex{mesh.own_count + static_cast<std::uint32_t>(found - others.begin())};
  };

  for (Triangle& t : mesh.border) {
    for (TileVertex& v : t)
      v = mesh.is_own(v) ? v : place_of(mesh.ghost(v));
  }
  std::vector<Triangle> beside;
  for (const Band& band : bands) {
    std::vector<TileVertex> place;
    for (const GhostRef& ref : band.vertices)
      place.push_back(is_own(ref) ? TileVertex{0} : place_of(ref));
    for (const Triangle& t : band.triangles) {
      if (std::none_of(t.begin(), t.end(),
                       [&](TileVertex v) { return is_own(band.vertices[raw(v)]); }))
        beside.push_back({place[raw(t[0])], place[raw(t[1])], place[raw(t[2])]});
    }
  }
  normalize_triangles(beside, true);  // two bands have the triangles between them
  mesh.border.insert(mesh.border.end(), beside.begin(), beside.end());
  mesh.vertices.positions.resize(mesh.own_count);
  std::vector<GhostRef> references;
  for (const auto& [ref, position] : others) {
    mesh.vertices.positions.push_back(position);
    references.push_back(ref);
  }
  return {std::move(mesh), std::move(references)};
}

/// A tile and its children as they meet.
struct Contracted {
  Surroundings fine;
  std::vector<float> weights;  ///< of the fine own vertices
  Surroundings coarse;
  std::vector<std::uint32_t> coarse_of;  ///< fine vertex -> coarse vertex, or kNone
};

/// The coarse vertices that fine vertices of other tiles have become, kNone for those not around.
std::vector<std::uint32_t> coarse_of_others(const Forest& forest, NodeId node,
                                            const Surroundings& fine, const Surroundings& coarse) {
  const std::vector<GhostRef>& around = coarse.references;
  std::vector<std::uint32_t> result;
  result.reserve(fine.references.size());
  for (const GhostRef& image : forest.mapped(node, fine.references)) {
    const auto found = std::lower_bound(around.begin(), around.end(), image);
    const bool known = found != around.end() && *found == image;
    result.push_back(
        known ? coarse.mesh.own_count + static_cast<std::uint32_t>(found - around.begin()) : kNone);
  }
  return result;
}

Contracted load(const Forest& forest, NodeId node) {
  const Tree::Children children = forest.tree().children(node);
  BuildTile joined =
      cluster_simplify::join(forest.load(children.nodes[0]), children.nodes[0].index,
                             forest.load(children.nodes[1]), children.nodes[1].index);
  Contracted result;
  result.weights = std::move(joined.history.weights);
  result.fine = surround(forest, finer(node.level), std::move(joined.mesh), children.span());
  result.coarse = surround(forest, node.level, forest.load(node).mesh, std::array{node});
  for (const NodeId child : children.span()) {
    const std::vector<std::uint16_t> map = forest.parent_map(child);
    result.coarse_of.insert(result.coarse_of.end(), map.begin(), map.end());
  }
  const std::vector<std::uint32_t> others =
      coarse_of_others(forest, node, result.fine, result.coarse);
  result.coarse_of.insert(result.coarse_of.end(), others.begin(), others.end());
  return result;
}

/// Own fine triangles of which nothing is drawn any more.
std::vector<Triangle> lost_triangles(const Contracted& step, const TargetSurface& drawn) {
  const auto is_lost = [&](TileVertex v) {
    const std::uint32_t image = step.coarse_of[raw(v)];
    return image == kNone || !drawn.is_used(image);
  };
  const auto is_own = [&](TileVertex v) { return step.fine.mesh.is_own(v); };
  std::vector<Triangle> lost;
  for (const auto* triangles : {&step.fine.mesh.interior, &step.fine.mesh.border})
    std::copy_if(triangles->begin(), triangles->end(), std::back_inserter(lost),
                 [&](const Triangle& t) {
                   return std::all_of(t.begin(), t.end(), is_lost) &&
                          std::any_of(t.begin(), t.end(), is_own);
                 });
  return lost;
}

/// How far no point of triangle `lost` is from one of the triangles around a drawn vertex: the
/// distance to a triangle is convex, so it is largest at a corner.
double distance_to_star(const TargetSurface& drawn, std::uint32_t vertex, const Triangle& lost,
                        const std::vector<Vec3f>& lost_positions) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : drawn.around(vertex)) {
    double farthest = 0;
    for (const TileVertex v : lost) {
      farthest = std::max(farthest, cluster_simplify::squared_distance(
                                        to_double(lost_positions[raw(v)]), drawn.frame(t)));
    }
    least = std::min(least, farthest);
  }
  return std::sqrt(least) * (1 + 0x1p-40);
}

/// The distance of triangles of which nothing is drawn any more to what is.
double lost_distance(const Contracted& step) {
  std::vector<Vec3f> positions = step.coarse.mesh.vertices.positions;
  TargetSurface surface;
  surface.assign(cluster_simplify::patch_of(step.coarse.mesh), {},
                 static_cast<std::uint32_t>(positions.size()));
  std::vector<std::uint32_t> drawn;
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (surface.is_used(v))
      drawn.push_back(v);
  }
  const std::vector<Triangle> lost = lost_triangles(step, surface);
  if (drawn.empty() || lost.empty())
    return 0;
  const std::vector<Vec3f>& fine = step.fine.mesh.vertices.positions;
  std::vector<std::uint32_t> asked;
  for (const Triangle& t : lost) {
    asked.push_back(static_cast<std::uint32_t>(positions.size()));
    positions.push_back(fine[raw(t[0])]);
  }
  const std::vector<std::uint32_t> nearest = cluster_simplify::nearest_of(positions, drawn, asked);
  double farthest = 0;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    farthest = std::max(farthest, distance_to_star(surface, nearest[i], lost[i], fine));
  }
  return farthest;
}

void make_unique(std::vector<std::uint32_t>& tiles) {
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
}

Step measure_step(const Forest& forest, NodeId node, cluster_simplify::Method method) {
  if (forest.tree().children(node).count == 1)
    return {};
  const Contracted step = load(forest, node);
  const cluster_simplify::DeviationInput input{
      .fine = cluster_simplify::patch_of(step.fine.mesh),
      .coarse = cluster_simplify::patch_of(step.coarse.mesh),
      .coarse_of = step.coarse_of,
      .weights = step.weights};
  const cluster_simplify::Deviation found = method == cluster_simplify::Method::cluster
                                                ? cluster_simplify::measure_motion(input)
                                                : cluster_simplify::DeviationMeter().measure(input);
  const double lost = found.collapsed_triangles > 0 ? lost_distance(step) : 0;
  Step result{std::max(found.bound, lost),
              found.weight_sum > 0 ? found.squared_sum / found.weight_sum : 0,
              {}};
  for (const GhostRef& other : step.fine.references)
    result.finer_neighbours.push_back(other.tile);
  make_unique(result.finer_neighbours);
  return result;
}

/// A float that is certainly not below `value`, and above `below`.
float above(float below, double value) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  auto result = static_cast<float>(value);
  if (result < value)
    result = std::nextafter(result, kInfinity);
  return std::max(result, std::nextafter(below, kInfinity));
}

/// Adds steps up, level by level. A step of a tile ends where it may: in the tile or beside it. So
/// two sums are kept per tile:
///   back   from any point the tile draws down to the original: the step of the tile, then back of
///          whichever finer tile it was measured against;
///   forth  from any original point under the tile up: the largest step of all tiles that the point
///          may have come to lie in.
class BoundChain {
 public:
  explicit BoundChain(Forest& forest) : forest_(forest) {
    const Tree& tree = forest.tree();
    const std::uint32_t count = tree.node_count(tree.depth());
    below_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i)
      below_[i].reached = {i};
  }

  /// `steps`: one per node of the level, the next above the last call's.
  void add(Level level, std::span<const Step> steps) {
    std::vector<Sum> sums(steps.size());
    for (std::uint32_t i = 0; i < steps.size(); ++i)
      sums[i] = sum_of({level, i}, steps);
    for (std::uint32_t i = 0; i < steps.size(); ++i)
      note({level, i}, steps[i], sums[i]);
    below_ = std::move(sums);
  }

 private:
  struct Sum {
    double back = 0;
    double forth = 0;
    std::vector<std::uint32_t> reached;  ///< tiles that points from under this one may lie in
  };

  std::uint32_t parent(Level level, std::uint32_t finer_tile) const {
    return forest_.tree().parent({finer(level), finer_tile}).index;
  }

  Sum sum_of(NodeId node, std::span<const Step> steps) const {
    const Step& step = steps[node.index];
    Sum sum;
    for (const std::uint32_t tile : step.finer_neighbours)
      sum.back = std::max(sum.back, below_[tile].back);
    const Tree::Children children = forest_.tree().children(node);
    for (const NodeId child : children.span()) {
      const Sum& below = below_[child.index];
      sum.back = std::max(sum.back, below.back);
      sum.forth = std::max(sum.forth, below.forth);
      for (const std::uint32_t tile : below.reached)
        sum.reached.push_back(parent(node.level, tile));
    }
    make_unique(sum.reached);
    double farthest = 0;
    const std::size_t count = sum.reached.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Step& taken = steps[sum.reached[i]];
      farthest = std::max(farthest, taken.certain);
      for (const std::uint32_t tile : taken.finer_neighbours)
        sum.reached.push_back(parent(node.level, tile));
    }
    make_unique(sum.reached);
    sum.back += step.certain;
    sum.forth += farthest;
    return sum;
  }

  void note(NodeId node, const Step& step, const Sum& sum) {
    TileFacts below;
    const Tree::Children children = forest_.tree().children(node);
    for (const NodeId child : children.span()) {
      below.error = std::max(below.error, forest_.facts(child).error);
      below.bound = std::max(below.bound, forest_.facts(child).bound);
    }
    TileFacts& facts = forest_.facts(node);
    if (forest_.tree().is_early(node)) {
      facts.error = below.error;
      facts.bound = below.bound;
      return;
    }
    facts.error = above(below.error, below.error + std::sqrt(step.mean_square));
    facts.bound = std::max(above(below.bound, std::max(sum.back, sum.forth)), facts.error);
  }

  Forest& forest_;
  std::vector<Sum> below_;
};

}  // namespace

void measure(Forest& forest, cluster_simplify::Method method, const MemoryPlan& plan,
             Progress& progress, const CancelToken& cancel) {
  const Tree& tree = forest.tree();
  std::uint64_t total = 0;
  for (int l = 0; l < raw(tree.depth()); ++l)
    total += tree.node_count(static_cast<Level>(l));
  progress.stage("measure", total, "tiles");
  BoundChain chain(forest);
  for (int l = raw(tree.depth()) - 1; l >= 0; --l) {
    const auto level = static_cast<Level>(l);
    std::vector<Step> steps(tree.node_count(level));
    ordered_for(
        steps.size(), plan.measures_in_flight, cancel,
        [&](std::size_t i) {
          return measure_step(forest, {level, static_cast<std::uint32_t>(i)}, method);
        },
        [&](std::size_t i, Step step) {
          steps[i] = std::move(step);
          progress.advance(1);
        });
    chain.add(level, steps);
  }
}

}  // namespace meshhier::pipeline
