#include "compare/tile_trees.h"

#include <numeric>
#include <utility>

namespace meshhier::comparing {

TileTree::TileTree(TileSurface surface)
    : search(std::move(surface.triangles)), facts(std::move(surface.facts)) {}

std::uint64_t TileTree::memory_bytes() const {
  return search.memory_bytes() +
         (facts.border.size() + facts.objects.size() + facts.numbers.size()) *
             sizeof(std::uint32_t);
}

ShownTriangle TileTree::shown(std::uint32_t tile, std::uint32_t triangle) const {
  ShownTriangle shown{search[triangle], tile, facts.number_in_tile(triangle), {}};
  if (!facts.objects.empty())
    shown.object = facts.objects[triangle];
  return shown;
}

std::vector<std::shared_ptr<const TileTree>> TreeCache::get(
    std::span<const std::uint32_t> positions) {
  std::vector<std::shared_ptr<const TileTree>> trees(positions.size());
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto found = places_.find(positions[i]);
    if (found == places_.end()) {
      missing.push_back(i);
      continue;
    }
    entries_.splice(entries_.begin(), entries_, found->second);
    trees[i] = found->second->tree;
  }
  execution::parallel_for(missing.size(), [&](std::size_t i) {
    trees[missing[i]] = std::make_shared<const TileTree>(surface_.load(positions[missing[i]]));
  });
  for (std::size_t i : missing)
    insert(positions[i], trees[i]);
  return trees;
}

void TreeCache::insert(std::uint32_t position, std::shared_ptr<const TileTree> tree) {
  was_read_[position] = true;
  used_bytes_ += tree->memory_bytes();
  entries_.push_front({position, std::move(tree)});
  places_[position] = entries_.begin();
  while (used_bytes_ > limit_bytes_ && entries_.size() > 1) {
    used_bytes_ -= entries_.back().tree->memory_bytes();
    places_.erase(entries_.back().position);
    entries_.pop_back();
  }
}

std::vector<TileQuery> by_tile(std::span<const TileQuery> queries, std::size_t tiles, Sweep sweep) {
  const auto turn = [&](const TileQuery& query) {
    return sweep == Sweep::up ? query.tile : tiles - 1 - query.tile;
  };
  std::vector<std::size_t> ends(tiles + 1);
  for (const TileQuery& query : queries)
    ++ends[turn(query) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<TileQuery> sorted(queries.size());
  for (const TileQuery& query : queries)
    sorted[ends[turn(query)]++] = query;
  return sorted;
}

BatchTrees::BatchTrees(TreeCache& trees, std::span<const TileQuery> batch) {
  for (const TileQuery& query : batch) {
    if (tiles_.empty() || tiles_.back() != query.tile)
      tiles_.push_back(query.tile);
  }
  held_ = trees.get(tiles_);
}

}  // namespace meshhier::comparing
