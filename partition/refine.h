// Shortens the lines between parts of a graph, without giving up the parts' sizes.
//
// Problem. Parts come from a coarser graph, projected down: they have about their sizes, but ragged
// lines. Moving any single vertex may make things worse although moving three would make them
// better.
//
// Idea (Fiduccia & Mattheyses 1982). Take two parts that touch. Move the vertex that gains most,
// even if its gain is negative, never move it back, and go on for a while; then take back all moves
// behind the best state seen. So a search climbs out of small dents:
//
//      part a : part b           total gain
//       o--o  :  o--o               |                 best state: kept
//       |   \ : /   |               |                 *
//       o--o--:v    o               |               .' '.
//       |   / :     |             0 +--.----------.'-----'.------> moves
//       o--o  :  o--o               |   '.      .'         '. taken back
//                                   |     '....'  a dent
//
//      gain of v: weight of its arcs to the other part, here three, less that of its arcs within
//      its own, here one
//
// Sizes: a move is allowed while the two parts stay within `explored` of their targets, or nears
// them; a state counts as best by its excess beyond `kept` first, by gain then. With exact sizes a
// vertex goes over and another one comes back.
//
// All pairs of parts that touch are refined in turn, in further rounds those where something
// changed (Sanders & Schulz, Engineering Multilevel Graph Partitioning Algorithms, 2011).
//
// Invariants. gain_ of a vertex that was seen is exact at all times: a move changes its neighbours'
// gains by twice the arc's weight. Heaps are lazy: a vertex has an entry that is not below its
// gain, so a heap's top, once corrected, is its best (has_top()). Ties go to the lower number, so
// the result depends on the graph alone.
//
// Cost. A round takes O(m log n), times the parts that a vertex touches: a search ends after a
// dozen moves without a better state, a vertex moves once in it, and vertices of more than 1,024
// arcs stay where they are, for a move goes through all arcs. Memory: a few numbers a vertex, the
// heaps, and an entry for each vertex and part that it touches.
#pragma once

#include "partition/graph.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::partition {

/// How far two parts that are refined may be from their sizes: |(size - target) of the one - of the
/// other|.
struct Slack {
  std::int64_t kept = 0;  ///< in the result, unless it was more at the start
  /// On the way to the result. It is best when it allows one move either way: with unit weights and
  /// exact sizes 2, a step of an exchange; with 16, lines are 4 % longer.
  std::int64_t explored = 0;
};

/// Which vertices may leave their part for another's sake.
enum class Reach {
  neighbours,  ///< those with a neighbour in the other part
  anywhere     ///< others, too, when these do not suffice
};

/// Counts the work that was done: tests hold that it is bounded.
struct RefineCounts {
  std::uint64_t pairs = 0;       ///< refinements of two parts
  std::uint64_t moves = 0;       ///< of vertices, those taken back included
  std::uint64_t kept_moves = 0;  ///< those that stayed
  RefineCounts& operator+=(const RefineCounts& other);
};

/// Moves single vertices between parts. Deterministic. One refiner serves one thread.
class Refiner {
 public:
  /// `part_of`: per vertex its part < targets.size() <= kMostParts; refined in place. `targets`:
  /// the weight of each part. `look_at`: vertices (not 0) that may have neighbours in other parts;
  /// others have none; vertices beyond its end stay where they are. All but the last must outlive
  /// the refiner.
  Refiner(const Graph& graph, std::span<std::uint32_t> part_of,
          std::span<const std::uint32_t> targets, std::span<const char> look_at);

  /// Refines all pairs of parts that touch; in further rounds those that touch a part that changed.
  void refine_all(int rounds, Slack slack);

  /// Gives every part exactly its target. Requires unit weights of what may move. Splits the parts
  /// in two halves, and those again; in each, the vertices that cost least go from the larger side
  /// to the other. False, and sizes are not exact, if there are too few that edges lead to and it
  /// may not take others.
  bool balance_exactly(Reach reach);

  /// Returns by how much a part weighs more than its target.
  std::int64_t excess(std::uint32_t part) const {
    return static_cast<std::int64_t>(size_[part]) - targets_[part];
  }
  /// Per vertex: has a neighbour in another part.
  std::vector<char> boundary() const;
  const RefineCounts& counts() const { return counts_; }

  static constexpr std::uint32_t kHubDegree = 1024;
  static constexpr std::uint32_t kMostParts = 64;

 private:
  using Key = std::uint64_t;  ///< gain, then the lower number, in one: the larger goes first
  struct Side {
    std::uint32_t part;
    std::vector<Key> heap;
  };
  /// A vertex with neighbours in another part: the pair of parts as one number.
  struct Touch {
    std::uint32_t pair, vertex;
    std::int32_t gain;
  };

  static Key key(std::int32_t gain, std::uint32_t v) {
    return Key{static_cast<std::uint32_t>(gain) ^ 0x80000000U} << 32 | (0xffffffffU - v);
  }
  static std::uint32_t vertex(Key key) { return 0xffffffffU - static_cast<std::uint32_t>(key); }
  static std::int32_t gain(Key key) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32) ^ 0x80000000U);
  }

  bool is_fixed(std::uint32_t v) const { return v >= movable_ || graph_.degree(v) > kHubDegree; }
  bool is_seen(std::uint32_t v) const { return epoch_[v] >= now_; }
  bool is_moved(std::uint32_t v) const { return epoch_[v] > now_; }
  void look_around(std::uint32_t v);
  void next_epoch();
  std::int32_t gain_of(std::uint32_t v, std::uint32_t other) const;
  void offer(std::uint32_t v, std::int32_t gain);
  bool refine_pair(std::uint32_t a, std::uint32_t b, std::span<const Touch> seeds, Slack slack);
  bool has_top(Side& side);
  Side* choose_side(std::int64_t imbalance, std::int64_t explored);
  void move(std::uint32_t v, std::uint32_t from, std::uint32_t to);
  void update_neighbours(std::uint32_t v, std::uint32_t from, std::uint32_t to);

  void add_touches(std::uint32_t v, std::vector<Touch>& touches);
  std::vector<Touch> sorted_touches();

  bool balance(std::uint32_t begin, std::uint32_t end, Reach reach);
  std::int64_t shift(std::uint32_t begin, std::uint32_t end, std::uint32_t to_begin,
                     std::uint32_t to_end, std::int64_t weight, Reach reach);

  const Graph& graph_;
  std::span<std::uint32_t> part_of_;
  std::span<const std::uint32_t> targets_;
  std::uint32_t movable_;  ///< lower vertices may move
  std::vector<std::uint32_t> size_;
  std::vector<std::uint32_t> candidates_;  ///< where the boundary is looked for
  std::vector<std::int32_t> gain_;
  std::vector<std::uint32_t> epoch_;  ///< now_: gain_ is known; now_ + 1: moved as well
  std::uint32_t now_ = 1;
  std::vector<std::uint32_t> by_part_, first_of_;  ///< candidates when balancing began
  std::vector<char> is_candidate_;
  std::vector<char> is_stale_;       ///< moved, or a neighbour was, since touches were gathered
  std::vector<std::int32_t> links_;  ///< per part: workspace, all 0
  Side left_{}, right_{};
  std::vector<std::uint32_t> log_;  ///< moves of a pair
  RefineCounts counts_;
};

}  // namespace meshhier::partition
