#include "partition/top_tree.h"

#include "partition/parallel_parts.h"
#include "partition/parallel_sort.h"
#include "partition/select.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

namespace meshhier::partition {
namespace {

// Half the width of a window in standard deviations of the sample median's rank. At 4 one window in
// 16,000 misses; each more half sigma keeps an eighth more vertices aside.
constexpr double kWindowSigmas = 4;

// The variance of a median's rank in a sample of m is m / 4; the planes above, themselves
// estimates, shift the sample of a node: half of their deviation arrives one level below, at worst
// (all splits in one direction).
constexpr double kMedianVariance = 0.25;
constexpr double variance_below(double variance) {
  return kMedianVariance + variance / 2;
}

// The least memory of select().
constexpr std::uint64_t kSelectBytes = 1 << 20;

// Undecided vertices are read back in blocks of this many.
constexpr std::size_t kReadBlock = 4096;

constexpr std::uint64_t hash(std::uint64_t x) {  // splitmix64 (Steele, Lea, Flood 2014)
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

NodeId node_at(std::uint32_t heap) {
  const int level = std::bit_width(heap + 1) - 1;
  return {static_cast<Level>(level), heap + 1 - (1U << level)};
}

std::uint64_t left_target(const Tree& tree, NodeId node) {
  return tree.ranks(tree.children(node).nodes[0]).size();
}

std::vector<Vec3f> positions_of(std::span<const IdPoint> points) {
  std::vector<Vec3f> positions(points.size());
  std::transform(points.begin(), points.end(), positions.begin(),
                 [](const IdPoint& p) { return p.position; });
  return positions;
}

/// A point of the sample on its way to its place.
struct Keyed {
  std::uint64_t projection;
  std::uint32_t id;
  std::uint32_t place;  ///< before
  SplitKey key() const { return {projection, id}; }
};

/// Below so many points, planning in parallel does not pay its bookkeeping.
constexpr std::size_t kParallelPoints = 8192;

/// Sorts the sample along the direction; returns the keys in order.
std::vector<Keyed> sort_along(Vec3d direction, std::span<IdPoint> sample) {
  std::vector<Keyed> keyed(sample.size());
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const SplitKey key = key_along(direction, sample[i].position, sample[i].id);
    keyed[i] = {key.projection, key.id, static_cast<std::uint32_t>(i)};
  }
  parallel_sort(std::span(keyed), [](const Keyed& a, const Keyed& b) { return a.key() < b.key(); });
  const std::vector<IdPoint> unsorted(sample.begin(), sample.end());
  for (std::size_t i = 0; i < sample.size(); ++i)
    sample[i] = unsorted[keyed[i].place];
  return keyed;
}

/// The window around the sample's quantile. A sample that is the whole node still gets one: nothing
/// depends on it.
void set_window(PlannedSplit& split, std::span<const Keyed> sorted, double fraction,
                double variance) {
  const auto count = static_cast<double>(sorted.size());
  const double reach = kWindowSigmas * std::sqrt(variance * count) + 2;
  const double low = fraction * count - reach;
  const double high = fraction * count + reach;
  split.low = low < 0 ? SplitKey::lowest() : sorted[static_cast<std::size_t>(low)].key();
  split.high = high >= count ? SplitKey::highest() : sorted[static_cast<std::size_t>(high)].key();
}

template <class Split, class Convert>
std::vector<SplitCells::Split> cell_splits(const std::vector<Split>& splits,
                                           const Convert& convert) {
  std::vector<SplitCells::Split> converted(splits.size());
  std::transform(splits.begin(), splits.end(), converted.begin(), convert);
  return converted;
}

class Planner {
 public:
  Planner(TopPlan& plan, const Tree& tree) : plan_(plan), tree_(tree) {}

  /// Chooses directions and windows of all nodes.
  void plan(Axis axis) { plan_node(0, plan_.sample, kMedianVariance, &axis); }
  /// Chooses new windows of the nodes that are not settled.
  void plan_again() { plan_node(0, plan_.sample, kMedianVariance, nullptr); }

 private:
  /// `variance`: of the median's rank, per vertex of the sample. `axis`: null to keep the
  /// direction.
  void plan_node(std::uint32_t heap, std::span<IdPoint> sample, double variance, const Axis* axis) {
    if (heap >= plan_.splits.size())
      return;
    PlannedSplit& split = plan_.splits[heap];
    const NodeId node = node_at(heap);
    const double fraction = static_cast<double>(left_target(tree_, node)) /
                            static_cast<double>(tree_.ranks(node).size());
    if (axis != nullptr)
      split.direction = direction_of(sample, fraction, *axis);
    const Cut cut = cut_sample(split, sample, fraction, variance);
    const auto plan_left = [&] {
      plan_node(2 * heap + 1, sample.first(cut.left), cut.variance, axis);
    };
    const auto plan_right = [&] {
      plan_node(2 * heap + 2, sample.subspan(cut.left), cut.variance, axis);
    };
    if (sample.size() > kParallelPoints) {
      tbb::parallel_invoke(plan_left, plan_right);
    } else {
      plan_left();
      plan_right();
    }
  }

  struct Cut {
    std::size_t left;  ///< points that go left
    double variance;   ///< below
  };
  /// Sorts the sample, sets the node's window, and tells how the sample goes on.
  static Cut cut_sample(PlannedSplit& split, std::span<IdPoint> sample, double fraction,
                        double variance) {
    const std::vector<Keyed> sorted = sort_along(split.direction, sample);
    if (split.settled) {
      const auto cut = std::partition_point(sorted.begin(), sorted.end(),
                                            [&](const Keyed& k) { return k.key() < split.low; });
      return {static_cast<std::size_t>(cut - sorted.begin()), kMedianVariance};
    }
    // Missed twice, or nothing to plan with: all vertices are kept aside, so the median is inside.
    if (split.misses > 1 || sample.size() < 2) {
      split.low = SplitKey::lowest();
      split.high = SplitKey::highest();
    } else {
      set_window(split, sorted, fraction, variance);
    }
    return {static_cast<std::size_t>(fraction * static_cast<double>(sample.size())),
            variance_below(variance)};
  }

  static Vec3d direction_of(std::span<const IdPoint> sample, double fraction, Axis axis) {
    if (sample.size() < 2)
      return {1, 0, 0};
    const std::vector<Vec3f> positions = positions_of(sample);
    return thinnest_direction(positions, fraction, candidate_directions(positions, axis));
  }

  TopPlan& plan_;
  const Tree& tree_;
};

}  // namespace

Level chunk_level(const Tree& tree) {
  Level level{0};
  while (level < tree.depth()) {
    std::uint64_t largest = 0;
    for (std::uint32_t i = 0; i < tree.node_count(level); ++i)
      largest = std::max(largest, tree.ranks({level, i}).size());
    if (largest <= kChunkVertices)
      break;
    level = finer(level);
  }
  return level;
}

std::uint64_t SampleIds::count() const {
  return std::min(vertex_count_, kSampleVertices);
}

std::uint64_t SampleIds::operator[](std::uint64_t i) const {
  if (vertex_count_ <= kSampleVertices)
    return i;
  const std::uint64_t begin = i * vertex_count_ / kSampleVertices;  // < 2^51
  const std::uint64_t end = (i + 1) * vertex_count_ / kSampleVertices;
  return begin + hash(i) % (end - begin);
}

std::uint64_t SampleIds::first_from(std::uint64_t id) const {
  if (id >= vertex_count_)
    return count();
  // The stride that holds `id`, or by rounding the one after it; what lies in it may be before
  // `id`.
  std::uint64_t i = id * count() / vertex_count_;
  while (i > 0 && (*this)[i - 1] >= id)
    --i;
  while (i < count() && (*this)[i] < id)
    ++i;
  return i;
}

TopPlan plan_top(std::vector<IdPoint> sample, const Tree& tree, Axis axis) {
  TopPlan plan;
  plan.chunks = chunk_level(tree);
  plan.splits.resize((std::size_t{1} << raw(plan.chunks)) - 1);
  plan.sample = std::move(sample);
  for (const IdPoint& p : plan.sample)
    plan.box.add(p.position);
  Planner(plan, tree).plan(axis);
  return plan;
}

Sweep::Sweep(const TopPlan& plan)
    : plan_(plan),
      cells_(cell_splits(plan.splits,
                         [](const PlannedSplit& split) {
                           return SplitCells::Split{split.direction, split.low.projection,
                                                    split.high.projection};
                         }),
             plan.box) {}

template <class IdOf>
void Sweep::count_all(std::span<const Vec3f> positions, const IdOf& id_of,
                      SweepBlock& block) const {
  const std::vector<PlannedSplit>& splits = plan_.splits;
  block.passed.assign(2 * splits.size() + 1, 0);
  block.undecided.clear(splits.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::uint32_t id = id_of(i);
    std::uint32_t node = cells_.start(positions[i]);
    while (node < splits.size()) {
      const SplitKey key = key_along(splits[node].direction, positions[i], id);
      if (key < splits[node].low) {
        node = 2 * node + 1;
      } else if (key > splits[node].high) {
        node = 2 * node + 2;
      } else {
        block.undecided.add(node, {positions[i], id});
        break;
      }
    }
    ++block.passed[node];
  }
  // A vertex was counted once, where its way ends so far; it came through all nodes above. From the
  // leaves up, sums give each node's left child, with one addition a node instead of one a level.
  block.left_counts.resize(splits.size());
  for (std::size_t node = splits.size(); node-- > 0;) {
    block.left_counts[node] = block.passed[2 * node + 1];
    block.passed[node] += block.passed[2 * node + 1] + block.passed[2 * node + 2];
  }
}

void Sweep::count(std::span<const Vec3f> positions, std::uint32_t first, SweepBlock& block) const {
  count_all(
      positions, [first](std::size_t i) { return static_cast<std::uint32_t>(first + i); }, block);
}

void Sweep::count(std::span<const Vec3f> positions, std::span<const std::uint32_t> ids,
                  SweepBlock& block) const {
  count_all(
      positions, [ids](std::size_t i) { return ids[i]; }, block);
}

ChunkSearch::ChunkSearch(const TopTree& top, const Bounds& box)
    : top_(top),
      cells_(cell_splits(top.planes_,
                         [](const SplitPlane& plane) {
                           const std::uint64_t at = plane.first_right.projection;
                           return SplitCells::Split{plane.direction, at, at};
                         }),
             box) {}

void ChunkSearch::find(std::span<const Vec3f> positions, std::uint32_t first,
                       std::span<std::uint32_t> chunks) const {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    chunks[i] = top_.chunk_below(cells_.start(positions[i]), positions[i],
                                 static_cast<std::uint32_t>(first + i));
  }
}

void ChunkSearch::find(std::span<const Vec3f> positions, std::span<const std::uint32_t> ids,
                       std::span<std::uint32_t> chunks) const {
  for (std::size_t i = 0; i < positions.size(); ++i)
    chunks[i] = top_.chunk_below(cells_.start(positions[i]), positions[i], ids[i]);
}

TopSelector::TopSelector(const TopPlan& plan, const Tree& tree, storage::ScratchFile& scratch,
                         std::uint64_t memory_bytes)
    : tree_(tree),
      memory_bytes_(memory_bytes),
      left_counts_(plan.splits.size()),
      locks_(plan.splits.size()) {
  // The open blocks of all nodes together stay within 4 MiB; below 1 KiB a block is not worth its
  // bookkeeping.
  const std::size_t block = std::clamp<std::size_t>(
      (4U << 20) / std::max<std::size_t>(plan.splits.size(), 1), 1024, 65536);
  undecided_.reserve(plan.splits.size());
  for (std::size_t i = 0; i < plan.splits.size(); ++i)
    undecided_.emplace_back(scratch, block);
}

void TopSelector::add(const SweepBlock& block) {
  for (std::uint32_t node = 0; node < left_counts_.size(); ++node) {
    if (block.left_counts[node] == 0 && !block.undecided.has(node))
      continue;
    const std::lock_guard lock(locks_[node]);
    left_counts_[node] += block.left_counts[node];
    block.undecided.for_each(node, [&](const IdPoint& point) { undecided_[node].append(point); });
  }
}

std::vector<SplitPlane> TopSelector::settle(TopPlan& plan) {
  bool all = true;
  for (std::uint32_t first = 0; first < left_counts_.size(); first = 2 * first + 1)
    all = settle_level(first, first + 1, plan) && all;
  if (!all) {
    Planner(plan, tree_).plan_again();
    return {};
  }
  std::vector<SplitPlane> planes;
  for (const PlannedSplit& split : plan.splits)
    planes.push_back({split.direction, split.low});
  return planes;
}

bool TopSelector::settle_level(std::uint32_t first, std::uint32_t count, TopPlan& plan) {
  // A node is settled only if those above it are: else it would count other vertices than it will
  // have.
  const auto ready = [&](std::uint32_t node) {
    return node == 0 || plan.splits[(node - 1) / 2].settled;
  };
  const std::uint64_t at_once = std::clamp<std::uint64_t>(
      memory_bytes_ / kSelectBytes, 1,
      std::min<std::uint64_t>(count,
                              static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency())));
  for_each_part(count, (count + at_once - 1) / at_once,
                [&](std::uint64_t begin, std::uint64_t part) {
                  for (std::uint64_t i = begin; i < begin + part; ++i) {
                    const auto node = static_cast<std::uint32_t>(first + i);
                    if (ready(node))
                      settle_node(node, plan.splits[node], memory_bytes_ / at_once);
                    undecided_[node].clear();
                  }
                });
  return std::all_of(plan.splits.begin() + first, plan.splits.begin() + first + count,
                     [](const PlannedSplit& split) { return split.settled; });
}

void TopSelector::settle_node(std::uint32_t node, PlannedSplit& split, std::uint64_t memory_bytes) {
  const auto& spool = undecided_[node];
  const auto for_each_block = [&](const auto& visit) {
    std::vector<IdPoint> block(std::min<std::uint64_t>(kReadBlock, spool.size()));
    for (std::uint64_t at = 0; at < spool.size(); at += block.size()) {
      block.resize(std::min<std::uint64_t>(kReadBlock, spool.size() - at));
      spool.read(at, block);
      visit(std::span<const IdPoint>(block));
    }
  };
  const auto in_window = [&](const SplitKey& key) { return split.low <= key && key <= split.high; };

  // Vertices handed down by the nodes above may lie outside the window: they are certain now.
  std::uint64_t left = left_counts_[node];
  std::uint64_t inside = 0;
  for_each_block([&](std::span<const IdPoint> block) {
    for (const IdPoint& p : block) {
      const SplitKey key = key_along(split.direction, p.position, p.id);
      if (key < split.low)
        ++left;
      if (in_window(key))
        ++inside;
    }
  });
  // The plane is the first key of the right child: it has `target` keys before it, and must be one
  // of those inside.
  const std::uint64_t target = left_target(tree_, node_at(node));
  if (target < left || target >= left + inside) {
    split.settled = false;
    ++split.misses;
    return;
  }
  const KeySource keys = [&](const std::function<void(std::span<const SplitKey>)>& visit) {
    std::vector<SplitKey> found;
    for_each_block([&](std::span<const IdPoint> block) {
      found.clear();
      for (const IdPoint& p : block) {
        const SplitKey key = key_along(split.direction, p.position, p.id);
        if (in_window(key))
          found.push_back(key);
      }
      visit(found);
    });
  };
  const SplitPlane plane{split.direction, select(keys, inside, target - left, memory_bytes)};
  split.low = split.high = plane.first_right;
  split.settled = true;
  // All that was kept aside here goes on: on the last level above the chunks nobody asks for it.
  if (2 * node + 1 < left_counts_.size()) {
    for_each_block([&](std::span<const IdPoint> block) {
      for (const IdPoint& p : block)
        undecided_[2 * node + (plane.is_right(p.position, p.id) ? 2 : 1)].append(p);
    });
  }
}

double expected_window_bytes(std::uint64_t vertex_count) {
  // A window holds this part of a sample's vertices, times the root of their number.
  const double share = 2 * kWindowSigmas * std::sqrt(kMedianVariance);
  double outside = 1;
  double sample = static_cast<double>(std::min(vertex_count, kSampleVertices));
  for (double size = static_cast<double>(vertex_count); size > kChunkVertices;
       size /= 2, sample /= 2) {
    outside *= 1 - std::min(1.0, share / std::sqrt(sample));
  }
  return static_cast<double>(vertex_count) * (1 - outside) * sizeof(IdPoint);
}

}  // namespace meshhier::partition
