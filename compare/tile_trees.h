// Trees of a surface's tiles, and questions to them.
//
// Problem. Questions about places of a surface (which triangle is nearest, which one does a ray
// hit) need the trees of some tiles; those of all do not fit into memory, and a tile is slow to
// load.
//
// Idea. Whoever asks says which tiles may answer. Questions are sorted by tile; a few tiles are
// asked at a time, in parallel, and what is found in one batch prunes the next one:
//
//      questions     (tile 3, a) (tile 7, a) (tile 7, b) (tile 9, a) ...
//                    |------- batch: trees of 8 tiles --------|
//
// Tiles whose trees are held from the questions before come first, if the answers do not depend on
// the order of tiles: over many tiles one goes up and down.
//
// Invariant. Batches have fixed sizes (kSearchedPoints, kSearchedTiles): results do not depend on
// threads or on the cache, to the bit.
#pragma once

#include "compare/cut_surface.h"
#include "compare/triangle_search.h"
#include "execution/cancel.h"
#include "execution/parallel.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::comparing {

/// The number of points that share a list of candidate tiles, and a chain of hints. Results must
/// not depend on threads or budget, so neither may this.
inline constexpr std::size_t kSearchedPoints = 256;
/// The number of tiles that are searched at the same time: their trees are held beside the cache's,
/// 40 MiB with 32,768 vertices a tile. It is fixed, as what is found in one batch prunes the next
/// one.
inline constexpr std::size_t kSearchedTiles = 8;

/// Returns how many blocks of kSearchedPoints hold `count` items.
constexpr std::size_t block_count(std::size_t count) {
  return (count + kSearchedPoints - 1) / kSearchedPoints;
}
template <class Element>
std::span<Element> block_of(std::span<Element> all, std::size_t block) {
  const std::size_t first = block * kSearchedPoints;
  return all.subspan(first, std::min(kSearchedPoints, all.size() - first));
}

/// Facts about a triangle of a surface.
struct ShownTriangle {
  SurfaceTriangle corners{};
  std::uint32_t tile = 0;                 ///< position in the cut
  std::uint32_t number_in_tile = 0;       ///< TriangleFacts::number_in_tile()
  std::optional<std::uint32_t> object{};  ///< if the mesh has any
};

/// Takes what is found for a point or ray: it may be called again with what is better.
using TakeShown = std::function<void(std::size_t number, const ShownTriangle& triangle)>;

/// The triangles that a tile draws, in a tree, with what else TileSurface tells of them.
struct TileTree {
  explicit TileTree(TileSurface surface);
  std::uint64_t memory_bytes() const;
  /// `tile`: the position in the cut. `triangle`: the index in TileSurface::triangles.
  ShownTriangle shown(std::uint32_t tile, std::uint32_t triangle) const;

  TriangleSearch search;
  TriangleFacts facts;
};

/// The order in which tiles are asked: from the first of the cut to the last, or back.
enum class Sweep { up, down };

/// Keeps trees of a surface's tiles; the least recently used go first. For one thread.
class TreeCache {
 public:
  /// `surface` must outlive it.
  TreeCache(const CutSurface& surface, std::uint64_t limit_bytes)
      : surface_(surface), limit_bytes_(limit_bytes), was_read_(surface.size()) {}

  /// Returns the trees of some tiles, built in parallel as far as they are not there. Requires
  /// positions without repeats. Throws as CutSurface::load().
  std::vector<std::shared_ptr<const TileTree>> get(std::span<const std::uint32_t> positions);
  /// Returns how many tiles the surface has.
  std::size_t tiles() const { return was_read_.size(); }
  /// Returns the order that begins with the trees that are held, if the last ones were asked in an
  /// order.
  Sweep next_sweep() const {
    return entries_.empty() || entries_.front().position <= entries_.back().position ? Sweep::up
                                                                                     : Sweep::down;
  }
  /// Returns how many different tiles were asked for.
  std::uint64_t tiles_read() const {
    return static_cast<std::uint64_t>(std::ranges::count(was_read_, true));
  }

 private:
  struct Entry {
    std::uint32_t position = 0;
    std::shared_ptr<const TileTree> tree;
  };

  void insert(std::uint32_t position, std::shared_ptr<const TileTree> tree);

  const CutSurface& surface_;
  std::uint64_t limit_bytes_;
  std::uint64_t used_bytes_ = 0;
  std::vector<bool> was_read_;
  std::list<Entry> entries_;  ///< most recently used first
  std::map<std::uint32_t, std::list<Entry>::iterator> places_;
};

/// A point, or whatever else is asked about, to be looked up in a tile.
struct TileQuery {
  std::uint32_t tile = 0;
  std::uint32_t point = 0;
};

/// Returns queries in the order of their tiles; those of a tile as they come. O(n + tiles).
std::vector<TileQuery> by_tile(std::span<const TileQuery> queries, std::size_t tiles,
                               Sweep sweep = Sweep::up);

/// Takes the queries of the next kSearchedTiles tiles away from the front of `queries`, which are
/// sorted by tile. Returns those that are open.
template <class IsOpen>
std::vector<TileQuery> take_batch(std::span<const TileQuery>& queries, const IsOpen& is_open) {
  std::vector<TileQuery> batch;
  std::size_t tiles = 0, taken = 0;
  for (; taken < queries.size(); ++taken) {
    if ((taken == 0 || queries[taken].tile != queries[taken - 1].tile) && ++tiles > kSearchedTiles)
      break;
    if (is_open(queries[taken]))
      batch.push_back(queries[taken]);
  }
  queries = queries.subspan(taken);
  return batch;
}

/// The trees that a batch of queries, sorted by tile, is looked up in.
class BatchTrees {
 public:
  BatchTrees(TreeCache& trees, std::span<const TileQuery> batch);
  const TileTree& operator[](const TileQuery& query) const {
    const auto tile = std::ranges::find(tiles_, query.tile) - tiles_.begin();
    return *held_[static_cast<std::size_t>(tile)];
  }

 private:
  std::vector<std::uint32_t> tiles_;
  std::vector<std::shared_ptr<const TileTree>> held_;
};

/// Answers queries. A Rule has:
///
///     bool any_order() const         whether tiles may be asked in any order, for the same answers
///     bool is_open(query) const      whether the tile may answer better than what is found so far
///     Answer ask(tree, query, hint) const
///                                    `hint`: of the query before, if it asked the same tile; else
///                                    0
///     void take(tree, query, answer) tile by tile, in the order of the queries
///
/// ask() runs in parallel, the others do not. Throws Error(io | corrupt | interrupted).
template <class Rule>
void answer_queries(TreeCache& trees, std::span<const TileQuery> unsorted, Rule& rule,
                    const execution::CancelToken& cancel) {
  const std::vector<TileQuery> sorted =
      by_tile(unsorted, trees.tiles(), rule.any_order() ? trees.next_sweep() : Sweep::up);
  std::span<const TileQuery> queries(sorted);
  const auto is_open = [&](const TileQuery& query) { return rule.is_open(query); };
  while (!queries.empty()) {
    cancel.check();
    const std::vector<TileQuery> batch = take_batch(queries, is_open);
    const BatchTrees held(trees, batch);
    std::vector<typename Rule::Answer> answers(batch.size());
    execution::parallel_for(block_count(batch.size()), [&](std::size_t block) {
      cancel.check();
      const auto asked = block_of(std::span(batch), block);
      const auto results = block_of(std::span(answers), block);
      std::uint32_t hint = 0;
      for (std::size_t i = 0; i < asked.size(); ++i) {
        if (i > 0 && asked[i].tile != asked[i - 1].tile)
          hint = 0;
        results[i] = rule.ask(held[asked[i]], asked[i], hint);
      }
    });
    for (std::size_t i = 0; i < batch.size(); ++i)
      rule.take(held[batch[i]], batch[i], answers[i]);
  }
}

/// Gathers queries, collect(block) for each block of kSearchedPoints of `count` items, in parallel,
/// and answers them, in the order of the blocks; at once if they are few, or else in parts that
/// memory holds. Throws as answer_queries().
template <class Collect, class Rule>
void answer_collected(TreeCache& trees, std::size_t count, const Collect& collect, Rule& rule,
                      const execution::CancelToken& cancel) {
  constexpr std::size_t kBlocksAtOnce = 32;
  constexpr std::size_t kManyQueries = std::size_t{1} << 20;  // 8 MiB, and as many sorted
  std::vector<TileQuery> queries;
  const auto answer = [&] {
    answer_queries(trees, queries, rule, cancel);
    queries.clear();
  };
  std::vector<std::vector<TileQuery>> parts(kBlocksAtOnce);
  for (std::size_t first = 0; first < block_count(count); first += kBlocksAtOnce) {
    cancel.check();
    const std::size_t blocks = std::min(kBlocksAtOnce, block_count(count) - first);
    execution::parallel_for(blocks, [&](std::size_t i) { parts[i] = collect(first + i); });
    for (std::size_t i = 0; i < blocks; ++i)
      queries.insert(queries.end(), parts[i].begin(), parts[i].end());
    if (queries.size() >= kManyQueries)
      answer();
  }
  answer();
}

/// Calls look(tree, number of the query, query) for each, in parallel, those of a few tiles at a
/// time. Requires queries that are sorted by tile.
template <class Look>
void look_up(TreeCache& trees, std::span<const TileQuery> queries,
             const execution::CancelToken& cancel, const Look& look) {
  std::size_t before = 0;
  while (!queries.empty()) {
    cancel.check();
    const std::vector<TileQuery> batch = take_batch(queries, [](const TileQuery&) { return true; });
    const BatchTrees held(trees, batch);
    execution::parallel_for(block_count(batch.size()), [&](std::size_t block) {
      cancel.check();
      const std::size_t first = block * kSearchedPoints;
      for (std::size_t i = first; i < std::min(first + kSearchedPoints, batch.size()); ++i)
        look(held[batch[i]], before + i, batch[i]);
    });
    before += batch.size();
  }
}

}  // namespace meshhier::comparing
