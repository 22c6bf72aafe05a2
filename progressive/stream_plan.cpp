#include "progressive/stream_plan.h"

#include "base/error.h"
#include "execution/size_text.h"
#include "execution/spool_cursor.h"
#include "hierarchy/detail.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

namespace meshhier::progressive {
namespace {

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

/// The program itself, its libraries, threads and the allocator's holes: 13 MiB and what a tile's
/// decoding leaves behind.
constexpr std::uint64_t kProgramBytes = 18 * kMebibyte;

/// A subtree has at most eight partitions: the more, the less is lifted by one thread alone.
constexpr int kMostSubtreeLevels = 3;

constexpr std::uint64_t kListsOfALevel = 7;

/// Items in flight beyond twice the threads only wait.
constexpr std::size_t kItemsAThread = 2;

/// Computes the memory of tiles and lists from the counts of the index.
class Needs {
 public:
  Needs(const storage::HierarchyReader& reader, const progressive::Sector& sector)
      : reader_(reader),
        tree_(reader.tree()),
        sector_(sector),
        width_(static_cast<std::uint64_t>(vertex_values(reader.tile_format().attributes))) {}

  /// Returns the memory that is taken whatever is in flight.
  std::uint64_t fixed() const {
    const std::uint64_t levels = raw(tree_.depth()) + std::uint64_t{1};
    return kProgramBytes + reader_.records().size() * sizeof(TileRecord) +
           levels * kListsOfALevel * kListBlockBytes;
  }

  /// Returns the memory while the trace is above `level`: a tile waits on each level, and one is
  /// made.
  std::uint64_t top(Level level) const {
    std::uint64_t largest = 0;
    std::uint64_t step = 0;
    for (const TileRecord& record : reader_.records()) {
      if (record.node.level > level)
        break;
      largest = std::max(largest, traced_bytes(record));
      step = std::max(step, step_bytes(record));
    }
    return static_cast<std::uint64_t>(raw(level) - raw(sector_.node.level) + 1) * largest + step;
  }

  /// Returns the memory of the largest item of work of that level.
  std::uint64_t subtree(Level level) const {
    const int below = raw(level) - raw(sector_.node.level);
    std::uint64_t largest = 0;
    for (std::uint32_t i = 0; i < std::uint32_t{1} << below; ++i) {
      const NodeId node{level, (sector_.node.index << below) + i};
      Sum sum;
      add(node, sum);
      largest = std::max(largest, sum.lists + sum.step + 3 * sum.traced);
    }
    return largest;
  }

  /// Returns the memory of a run, its bytes, and the packed ones.
  std::uint64_t run() const {
    return kRunEntries * std::max<std::uint64_t>(4 + 12 * width_, 20 + 2 * 24);
  }

  /// Returns the memory of a file's cursors: three lists for each level, and two levels' stand-ins.
  std::uint64_t cursors() const {
    const std::uint64_t levels = raw(tree_.depth()) + std::uint64_t{1};
    return (2 * levels + 4) * execution::SpoolCursor<float>::kBufferBytes;
  }

 private:
  struct Sum {
    std::uint64_t lists = 0;
    std::uint64_t step = 0;    ///< largest
    std::uint64_t traced = 0;  ///< largest
  };

  static std::uint64_t triangles_of(const TileRecord& record) {
    return std::uint64_t{record.interior_count} + record.border_count;
  }
  std::uint64_t traced_bytes(const TileRecord& record) const {
    return triangles_of(record) * sizeof(progressive::TracedTriangle) +
           record.own_count * (6 + 4 * width_) + record.ghost_count * std::uint64_t{24};
  }
  /// Returns the memory of a tile as its children become it: the keys by which the children's
  /// triangles, twice as many, are sorted; the decoded file; stand-ins of three corners a triangle.
  std::uint64_t step_bytes(const TileRecord& record) const {
    return triangles_of(record) * (2 * 120 + 60 + 48) +
           (std::uint64_t{record.own_count} + record.ghost_count) * (64 + 12 * width_);
  }
  /// Returns the bytes that a tile leaves behind: a partition's losses, others' stand-ins.
  std::uint64_t list_bytes(const TileRecord& record) const {
    if (tree_.is_partition(record.node))
      return triangles_of(record) * 24 + record.own_count * (8 + 8 * width_);
    return triangles_of(record) * 2 * (8 + 4 * width_);
  }

  void add(NodeId node, Sum& sum) const {
    const TileRecord& record = reader_.record(node);
    sum.lists += list_bytes(record);
    sum.step = std::max(sum.step, step_bytes(record));
    sum.traced = std::max(sum.traced, traced_bytes(record));
    const Tree::Children children = tree_.children(node);
    for (const NodeId child : children.span())
      add(child, sum);
  }

  const storage::HierarchyReader& reader_;
  const Tree& tree_;
  const progressive::Sector& sector_;
  std::uint64_t width_;
};

/// A level whose nodes may be items of work, and the memory to have one of them in flight.
struct Choice {
  Level level{};
  std::uint64_t subtree = 0;
  std::uint64_t least = 0;
};

/// Chooses the level whose nodes are items of work. It is above the last one, which is not
/// complete.
Choice choose_level(const Tree& tree, const progressive::Sector& sector, const Needs& needs,
                    std::uint64_t budget_bytes, std::size_t threads) {
  const int top = raw(sector.node.level);
  const int finest = std::max(top, raw(tree.depth()) - 1);
  Choice choice;
  for (int level = std::max(top, raw(tree.depth()) - kMostSubtreeLevels); level <= finest;
       ++level) {
    choice.level = static_cast<Level>(level);
    choice.subtree = needs.subtree(choice.level);
    const std::uint64_t trace = needs.top(choice.level) + choice.subtree;
    choice.least = needs.fixed() + std::max(trace, needs.cursors() + needs.run());
    if (choice.least + (threads - 1) * choice.subtree <= budget_bytes)
      break;
  }
  return choice;
}

}  // namespace

ProgressivePlan plan_progressive(const storage::HierarchyReader& reader,
                                 const progressive::Sector& sector, std::uint64_t budget_bytes,
                                 std::size_t threads) {
  const Needs needs(reader, sector);
  const Choice choice = choose_level(reader.tree(), sector, needs, budget_bytes, threads);
  if (budget_bytes < choice.least) {
    throw Error(ErrorCode::budget,
                fmt::format("a memory budget of {} is too small for this hierarchy: "
                            "--memory-budget {} would do",
                            execution::exact_size_text(budget_bytes),
                            execution::exact_size_text((choice.least + kMebibyte - 1) / kMebibyte *
                                                       kMebibyte)));
  }
  const std::uint64_t rest = budget_bytes - choice.least;
  const auto more = [&](std::uint64_t bytes, std::uint64_t each) {
    return 1 + static_cast<std::size_t>(std::min<std::uint64_t>(
                   bytes / std::max<std::uint64_t>(each, 1), kItemsAThread * threads - 1));
  };
  ProgressivePlan plan;
  plan.budget_bytes = budget_bytes;
  plan.pool_bytes = rest / 2;
  plan.subtrees = choice.level;
  plan.subtrees_in_flight = more(rest / 2, choice.subtree);
  plan.runs_in_flight = more(rest / 4, needs.run());
  plan.foreign_bytes = rest / ProgressivePlan::kForeignParts;
  return plan;
}

}  // namespace meshhier::progressive
