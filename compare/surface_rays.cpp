#include "compare/surface_rays.h"

#include "execution/parallel.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace meshhier::comparing {
namespace {

std::vector<std::uint32_t> drawing_tiles(const CutSurface& surface) {
  std::vector<std::uint32_t> tiles;
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (surface.facts(i).triangles > 0 && !surface.facts(i).bounds.empty())
      tiles.push_back(i);
  }
  return tiles;
}

/// Returns triangles that have the boxes of the tiles.
std::vector<SurfaceTriangle> diagonals_of(const CutSurface& surface,
                                          std::span<const std::uint32_t> tiles) {
  std::vector<SurfaceTriangle> diagonals;
  diagonals.reserve(tiles.size());
  for (const std::uint32_t tile : tiles) {
    const Bounds& box = surface.facts(tile).bounds;
    diagonals.push_back({box.min, box.max, box.max});
  }
  return diagonals;
}

double entry_of(const Ray& ray, const Bounds& box) {
  const Ray::Span span = ray.span(box.min, box.max);
  return span.is_empty() ? kBehindAll : std::max(span.entry, 0.0);
}

/// What rays hit, as far as it is found.
class HitsSoFar {
 public:
  using Answer = HitOnSurface;

  HitsSoFar(const CutSurface& surface, std::span<const Ray> rays, const TakeShown& take)
      : found(rays.size()), surface_(surface), rays_(rays), take_(take) {}

  static bool any_order() { return true; }
  bool is_open(const TileQuery& query) const {
    const double entry = entry_of(rays_[query.point], surface_.facts(query.tile).bounds);
    return entry < kBehindAll && entry <= found[query.point].distance;
  }
  HitOnSurface ask(const TileTree& tree, const TileQuery& query, std::uint32_t&) const {
    const HitTriangle hit = tree.search.first_hit(rays_[query.point], found[query.point].distance);
    return {hit.distance, query.tile, hit.triangle};
  }
  void take(const TileTree& tree, const TileQuery& query, const HitOnSurface& answer) {
    HitOnSurface& now = found[query.point];
    const auto rank = [](const HitOnSurface& hit) {
      return std::tuple(hit.distance, hit.tile, hit.triangle);
    };
    if (!answer.is_there() || rank(now) <= rank(answer))
      return;
    now = answer;
    take_(query.point, tree.shown(answer.tile, answer.triangle));
  }

  std::vector<HitOnSurface> found;

 private:
  const CutSurface& surface_;
  std::span<const Ray> rays_;
  const TakeShown& take_;
};

}  // namespace

SurfaceRays::SurfaceRays(const CutSurface& surface, TreeCache& trees)
    : surface_(surface),
      trees_(trees),
      tiles_(drawing_tiles(surface)),
      boxes_(diagonals_of(surface, tiles_), 1) {}

/// Returns of each ray that enters a tile the one that it enters first.
std::vector<TileQuery> SurfaceRays::first_tiles(std::span<const Ray> rays) const {
  std::vector<TileQuery> first(rays.size());
  std::vector<double> entries(rays.size(), kBehindAll);
  execution::parallel_for(block_count(rays.size()), [&](std::size_t block) {
    const std::size_t begin = block * kSearchedPoints;
    for (std::size_t i = begin; i < std::min(begin + kSearchedPoints, rays.size()); ++i) {
      first[i].point = static_cast<std::uint32_t>(i);
      boxes_.look_nearest(rays[i], entries[i], [&](std::uint32_t leaf) {
        const std::uint32_t tile = tiles_[boxes_.triangles(leaf).front()];
        const double entry = entry_of(rays[i], surface_.facts(tile).bounds);
        if (std::pair(entry, tile) < std::pair(entries[i], first[i].tile)) {
          first[i].tile = tile;
          entries[i] = entry;
        }
      });
    }
  });
  std::erase_if(first, [&](const TileQuery& query) { return entries[query.point] == kBehindAll; });
  return first;
}

std::vector<HitOnSurface> SurfaceRays::first_hits(std::span<const Ray> rays, const TakeShown& take,
                                                  const execution::CancelToken& cancel) {
  HitsSoFar so_far(surface_, rays, take);
  const std::vector<TileQuery> first = first_tiles(rays);
  answer_queries(trees_, first, so_far, cancel);
  const auto others = [&](std::size_t block) {
    std::vector<TileQuery> more;
    for (const TileQuery& asked : block_of(std::span(first), block)) {
      const double reach = so_far.found[asked.point].distance;
      boxes_.look_nearest(rays[asked.point], reach, [&](std::uint32_t leaf) {
        const std::uint32_t tile = tiles_[boxes_.triangles(leaf).front()];
        if (tile != asked.tile)
          more.push_back({tile, asked.point});
      });
    }
    return more;
  };
  answer_collected(trees_, first.size(), others, so_far, cancel);
  return std::move(so_far.found);
}

}  // namespace meshhier::comparing
