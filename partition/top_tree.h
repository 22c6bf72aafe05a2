// Finds the upper part of the kd-tree: from the whole mesh down to chunks that fit in memory, with
// exact medians from one streaming pass (docs/decisions/002).
//
// Problem. Partition sizes differ by one vertex at most, so each split needs the exact median of
// its node. The mesh does not fit in memory; split node by node, it would be read and written once
// for each level.
//
// Idea. A sample of fixed size plans everything that decides a split: its direction, and a window
// of keys that all but surely holds the exact median. One sweep over all vertices then counts the
// vertices left of each window; the few inside of a window are kept aside, and settle the exact
// medians afterwards, node by node from the root.
//
//      keys of one node's vertices along its direction
//
//      |     counted only       |  window: kept aside  |        sent right           |
//      +------------------------+-----------x----------+-----------------------------+
//      <---- left_counts ------>        the median: the key with as many keys before it
//                                       as the left child has vertices
//
//      node by node:        0            A vertex inside of node 0's window ends its sweep there:
//                         /   \          which child it belongs to is not known. Once node 0 is
//                        1     2         settled, its vertices are handed down to 1 and 2, and
//                       / \   / \        count there.
//                      3   4 5   6
//
// If a median misses its window, the windows of its node and of those below are planned again, now
// with the exact planes above them, and the sweep is repeated; a second miss opens the window
// wide: slower, never wrong.
//
// Invariants. When a node is settled, all above it are; those counted and those kept aside or
// handed down are together exactly its vertices. Keys are distinct, for they end with the vertex
// id: "the median" is one vertex, whatever the order of reading. The splits are a function of mesh,
// sample and tree alone: neither memory nor threads decide anything.
//
// Cost. O(n) for the sweep, as split_cells.h skips most levels. The vertices kept aside are a tenth
// of 10 million and a fifth of 30 million; they wait in spools. The sample takes 8 MiB.
#pragma once

#include "base/bounds.h"
#include "hierarchy/tree.h"
#include "partition/bucketed.h"
#include "partition/direction.h"
#include "partition/split_cells.h"
#include "partition/split_plane.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

namespace meshhier::partition {

/// The vertices that a chunk has at most: it then works in some 20 MB, which fits the least budget.
inline constexpr std::uint64_t kChunkVertices = 131072;

/// The vertices that the splits above the chunks are planned with. They take 8 MiB, and the deepest
/// of 8 levels still sees 4096 of them.
inline constexpr std::uint64_t kSampleVertices = 524288;

/// The level whose nodes are the chunks: the first on which no node has more than kChunkVertices.
Level chunk_level(const Tree& tree);

/// The ids of the sampled vertices, ascending: one at a hashed place in each of kSampleVertices
/// equal strides (all, if there are no more than that).
class SampleIds {
 public:
  explicit SampleIds(std::uint64_t vertex_count) : vertex_count_(vertex_count) {}
  std::uint64_t count() const;
  std::uint64_t operator[](std::uint64_t i) const;
  /// The least i with (*this)[i] >= id; count() if there is none.
  std::uint64_t first_from(std::uint64_t id) const;

 private:
  std::uint64_t vertex_count_;
};

struct PlannedSplit {
  Vec3d direction;       ///< planned once, from the sample; never changed
  SplitKey low, high;    ///< the window, both ends inclusive
  bool settled = false;  ///< the exact median is known: low == high
  int misses = 0;        ///< sweeps in which the median was outside the window
};

/// Splits of all nodes above the chunks, in heap order: node (l, i) at 2^l - 1 + i.
struct TopPlan {
  Level chunks{};
  std::vector<PlannedSplit> splits;
  std::vector<IdPoint> sample;  ///< kept, in case windows must be planned again
  Bounds box;                   ///< of the sample
};

/// Plans all splits from the vertices of SampleIds. In parallel on the caller's TBB arena.
TopPlan plan_top(std::vector<IdPoint> sample, const Tree& tree, Axis axis);

/// The counts of one block of vertices.
struct SweepBlock {
  std::vector<std::uint32_t> left_counts;  ///< per node: vertices certainly left of it
  Bucketed<IdPoint> undecided;             ///< by node, in heap order
  std::vector<std::uint32_t> passed;       ///< per node, leaves included: vertices certainly in it
};

/// One sweep over the vertices, block by block. Thread-safe for different blocks.
class Sweep {
 public:
  /// Refers to the plan, which must not change meanwhile.
  explicit Sweep(const TopPlan& plan);
  /// `first`: the id of the first vertex. `block`: overwritten; keeps its memory.
  void count(std::span<const Vec3f> positions, std::uint32_t first, SweepBlock& block) const;
  /// Likewise of vertices with these ids, ascending; as many as positions.
  void count(std::span<const Vec3f> positions, std::span<const std::uint32_t> ids,
             SweepBlock& block) const;

 private:
  template <class IdOf>
  void count_all(std::span<const Vec3f> positions, const IdOf& id_of, SweepBlock& block) const;

  const TopPlan& plan_;
  SplitCells cells_;
};

/// The exact splits: a vertex's chunk is a pure function of its position and id.
class TopTree {
 public:
  TopTree(Level chunks, std::vector<SplitPlane> planes)
      : chunks_(chunks), planes_(std::move(planes)) {}
  Level chunks() const { return chunks_; }
  /// In heap order, as TopPlan::splits.
  const std::vector<SplitPlane>& planes() const { return planes_; }
  /// NodeId::index on the chunk level.
  std::uint32_t chunk_of(Vec3f position, std::uint32_t id) const {
    return chunk_below(0, position, id);
  }

 private:
  friend class ChunkSearch;
  std::uint32_t chunk_below(std::uint32_t node, Vec3f position, std::uint32_t id) const {
    while (node < planes_.size())
      node = 2 * node + (planes_[node].is_right(position, id) ? 2 : 1);
    return node - static_cast<std::uint32_t>(planes_.size());
  }

  Level chunks_;
  std::vector<SplitPlane> planes_;
};

/// chunk_of() for many vertices. Thread-safe.
class ChunkSearch {
 public:
  /// Refers to `top`. `box`: of about all vertices.
  ChunkSearch(const TopTree& top, const Bounds& box);
  /// The chunks of the vertices first, first + 1, ...; as many as positions.
  void find(std::span<const Vec3f> positions, std::uint32_t first,
            std::span<std::uint32_t> chunks) const;
  /// Likewise of vertices with these ids.
  void find(std::span<const Vec3f> positions, std::span<const std::uint32_t> ids,
            std::span<std::uint32_t> chunks) const;

 private:
  const TopTree& top_;
  SplitCells cells_;
};

/// Returns the bytes that a TopSelector keeps aside of so many vertices, about: those within the
/// window of some split.
double expected_window_bytes(std::uint64_t vertex_count);

/// Gathers sweep blocks and settles the medians.
class TopSelector {
 public:
  /// `memory_bytes`: for the selection of one median.
  TopSelector(const TopPlan& plan, const Tree& tree, storage::ScratchFile& scratch,
              std::uint64_t memory_bytes);

  /// In any order, which decides nothing. Thread-safe.
  void add(const SweepBlock& block);

  /// The planes of all splits, or none if a median missed its window: `plan` then has new windows,
  /// and wants another sweep with a new selector. Call once. In parallel on the caller's TBB arena.
  std::vector<SplitPlane> settle(TopPlan& plan);

 private:
  /// settle_node() for those of a level that are ready for it; whether all are settled.
  bool settle_level(std::uint32_t first, std::uint32_t count, TopPlan& plan);
  /// Finds the node's median and hands its kept-aside vertices down; or notes a miss. Thread-safe
  /// for nodes of one level.
  void settle_node(std::uint32_t node, PlannedSplit& split, std::uint64_t memory_bytes);

  const Tree& tree_;
  std::uint64_t memory_bytes_;
  std::vector<std::uint64_t> left_counts_;
  std::vector<storage::RecordSpool<IdPoint>> undecided_;
  std::vector<std::mutex> locks_;  ///< per node, of who adds
};

}  // namespace meshhier::partition
