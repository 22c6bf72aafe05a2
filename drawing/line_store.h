// The lines of all tiles, joined: more than memory holds.
//
// Problem. A line runs through many tiles. Its stretches come tile by tile, and none knows the
// next; all points together may be more than memory holds.
//
// Idea. Points go to a spool as they come. Each open stretch has two ends, by the names of the
// edges where they lie; sorted by level and name, ends that meet are neighbours. What stays in
// memory is 32 bytes a stretch: where its points are, and what is joined with it.
//
//    tiles --> stretches --> points:  spool          lines, level by level: their points are
//                       \--> ends:    sort -> pairs  read from the spool, stretch by stretch
//
// Invariant. The result depends on the order of tiles alone.
#pragma once

#include "drawing/line_chains.h"
#include "drawing/tile_lines.h"
#include "execution/cancel.h"
#include "partition/external_sort.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

namespace meshhier::drawing {

/// A line that is whole.
struct JoinedLine {
  std::uint32_t level = 0;
  bool is_closed = false;    ///< its last point is joined with its first
  std::uint64_t points = 0;  ///< 2 or more
  double length = 0;         ///< in units of the input
};

/// Takes lines, one after another.
class LineSink {
 public:
  virtual ~LineSink() = default;
  virtual void begin(const JoinedLine& line) = 0;
  /// `place`: in the input's coordinates. No two that follow each other are equal.
  virtual void point(Vec3d place) = 0;
  virtual void end() = 0;
};

/// For one thread.
class LineStore {
 public:
  /// `memory_bytes`: for sorting and for what stays in memory. `cancel` must outlive it.
  LineStore(storage::ScratchFile& scratch, std::uint64_t memory_bytes,
            const execution::CancelToken& cancel);

  /// Takes the lines of the next tile. Throws Error(budget) if the stretches exceed the memory.
  void add(const TileLines& lines);
  /// Joins what was added.
  void join();

  /// Returns how many lines there are; a few may turn out to have no length.
  std::uint64_t size() const { return heads_.size(); }
  /// Hands lines to the sink, level by level.
  void for_each_line(LineSink& sink) const;

 private:
  struct Stretch {
    std::uint64_t first = 0;  ///< in the spool
    std::uint32_t points = 0;
    std::uint32_t level = 0;
  };
  struct End {
    std::uint32_t level = 0;
    std::uint32_t end = 0;
    EdgeName edge{};
  };
  struct PointOf {
    auto operator()(const End& end) const { return std::tuple(end.level, end.edge); }
  };
  /// A line by where it starts.
  struct Head {
    std::uint32_t level = 0;
    std::uint32_t entry = 0;
  };

  void pair_ends();
  template <class Visit>
  void for_each_point(const Head& head, const Visit& visit) const;
  JoinedLine measured(const Head& head) const;

  const execution::CancelToken& cancel_;
  std::uint64_t most_stretches_;
  storage::RecordSpool<Vec3d> points_;
  partition::ExternalSort<End, PointOf> ends_;
  std::vector<Stretch> stretches_;
  std::vector<bool> is_ring_;  ///< of stretches that are closed by themselves
  std::optional<LineChains> chains_;
  std::vector<Head> heads_;
};

}  // namespace meshhier::drawing
