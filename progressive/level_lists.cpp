#include "progressive/level_lists.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "hierarchy/cut.h"
#include "progressive/stream_plan.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::progressive {
namespace {

using progressive::Lifted;
using progressive::Losses;
using progressive::Sector;
using progressive::TracedTile;
using progressive::VertexValues;

/// The part of one level's lists that a subtree makes.
struct LevelPart {
  Losses lost;
  std::vector<StandIn> stand_ins;
  VertexValues stand_in_values;
  std::vector<std::uint32_t> foreign_ranks;
  VertexValues foreign_values;
};

struct Subtree {
  TracedTile root;
  std::vector<LevelPart> levels;
};

void append(Losses& to, Losses&& more) {
  const auto join = [](auto& list, auto& behind) {
    if (list.empty())
      list = std::move(behind);
    else
      list.insert(list.end(), behind.begin(), behind.end());
  };
  join(to.ranks, more.ranks);
  join(to.values.values, more.values.values);
  join(to.triangles, more.triangles);
  join(to.corners, more.corners);
}

void append(LevelLists& to, const LevelPart& part, std::uint64_t first_index) {
  to.lost_ranks.append(part.lost.ranks);
  to.lost_values.append(part.lost.values.values);
  std::vector<LostTriangle> triangles;
  for (std::size_t i = 0; i < part.lost.triangles.size(); ++i) {
    const std::uint64_t index = first_index + part.lost.triangles[i];
    triangles.push_back({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32),
                         part.lost.corners[i]});
  }
  to.lost_triangles.append(triangles);
  to.stand_ins.append(part.stand_ins);
  to.stand_in_values.append(part.stand_in_values.values);
  to.foreign_ranks.append(part.foreign_ranks);
  to.foreign_values.append(part.foreign_values.values);
}

class Tracer {
 public:
  Tracer(const storage::HierarchyReader& reader, const Sector& sector, const TraceOptions& options,
         execution::Progress& progress, const execution::CancelToken& cancel)
      : reader_(reader),
        tree_(reader.tree()),
        sector_(sector),
        options_(options),
        progress_(progress),
        cancel_(cancel) {}

  /// Traces the tile of `node` and adds the losses below it; triangles are counted from
  /// `first_index` on.
  TracedTile trace(NodeId node, std::uint64_t first_index, std::vector<LevelPart>& levels) const {
    if (tree_.is_partition(node))
      return trace_partition(node, first_index, levels);
    const auto children = tree_.children(node);
    TracedTile left = trace(children.nodes[0], first_index, levels);
    if (children.count == 1)
      return raise_early(std::move(left), levels);
    const std::uint64_t middle = left.end_index;
    return raise(std::move(left), trace(children.nodes[1], middle, levels), levels);
  }

  /// Lifts two complete siblings into their parent.
  TracedTile raise(TracedTile left, TracedTile right, std::vector<LevelPart>& levels) const {
    const NodeId node = tree_.parent(left.node);
    const PublishedTile parent = read(node);
    Lifted lifted = progressive::lift(tree_, sector_, std::move(left), std::move(right), parent);
    append(levels[raw(node.level) + 1U].lost, std::move(lifted.losses));
    list(lifted.tile, parent, levels);
    return std::move(lifted.tile);
  }

 private:
  PublishedTile read(NodeId node) const {
    cancel_.check();
    PublishedTile tile = reader_.read_tile(node);
    progress_.advance(1);
    return tile;
  }

  TracedTile trace_partition(NodeId node, std::uint64_t first_index,
                             std::vector<LevelPart>& levels) const {
    const PublishedTile published = read(node);
    TracedTile tile = progressive::trace_partition(tree_, sector_, published, first_index);
    list(tile, published, levels);
    return tile;
  }

  TracedTile raise_early(TracedTile partition, std::vector<LevelPart>& levels) const {
    Lifted lifted = progressive::lift_early(tree_, sector_, std::move(partition));
    append(levels[raw(tree_.depth())].lost, std::move(lifted.losses));
    list_early(lifted.tile, levels);
    return std::move(lifted.tile);
  }

  bool is_listed(const TracedTile& tile) const { return options_.listed[raw(tile.node.level)]; }

  progressive::StandIns list_own(const TracedTile& tile, LevelPart& part) const {
    progressive::StandIns found = progressive::find_stand_ins(sector_, tile);
    for (const auto& own : found.own) {
      part.stand_ins.push_back({own.rank, tile.ranks[own.vertex]});
      part.stand_in_values.append(tile.values[own.vertex]);
    }
    return found;
  }

  static void list_foreign(std::uint32_t rank, const VertexArray& vertices, std::size_t vertex,
                           LevelPart& part) {
    const Vec3f p = vertices.positions[vertex];
    part.foreign_ranks.push_back(rank);
    part.foreign_values.append(std::array{p.x, p.y, p.z});
    part.foreign_values.append(vertices.attributes_of(vertex));
  }

  /// Adds a tile to the lists of its level. Values of the vertices that stand for foreign corners
  /// are taken from the tile's own file.
  void list(const TracedTile& tile, const PublishedTile& published,
            std::vector<LevelPart>& levels) const {
    if (!is_listed(tile))
      return;
    LevelPart& part = levels[raw(tile.node.level)];
    for (const auto& foreign : list_own(tile, part).foreign) {
      const std::vector<GhostRef>& ghosts = published.mesh.ghosts;
      const auto place = std::ranges::lower_bound(ghosts, tile.ghosts[foreign.ghost]);
      if (place == ghosts.end() || *place != tile.ghosts[foreign.ghost])
        throw Error(ErrorCode::corrupt, fmt::format("tile {}: a corner of its triangles is no "
                                                    "ghost of it",
                                                    to_text(tile.node)));
      list_foreign(foreign.rank, published.mesh.vertices,
                   published.mesh.own_count + static_cast<std::size_t>(place - ghosts.begin()),
                   part);
    }
  }

  /// Adds an early node to the lists. It has no file, so its neighbours' are read.
  void list_early(const TracedTile& tile, std::vector<LevelPart>& levels) const {
    if (!is_listed(tile))
      return;
    LevelPart& part = levels[raw(tile.node.level)];
    std::optional<PublishedTile> neighbour;
    std::vector<progressive::StandIns::Foreign> foreign = list_own(tile, part).foreign;
    std::ranges::sort(foreign, {}, &progressive::StandIns::Foreign::ghost);
    for (const auto& corner : foreign) {
      const GhostRef& ghost = tile.ghosts[corner.ghost];
      const NodeId node = tree_.tile_node({tile.node.level, ghost.tile});
      if (!neighbour || neighbour->node != node)
        neighbour = reader_.read_tile(node);
      if (ghost.index >= neighbour->mesh.own_count)
        throw Error(
            ErrorCode::corrupt,
            fmt::format("tile {}: a ghost is none of its tile's vertices", to_text(tile.node)));
      list_foreign(corner.rank, neighbour->mesh.vertices, ghost.index, part);
    }
  }

  const storage::HierarchyReader& reader_;
  const Tree& tree_;
  const Sector& sector_;
  const TraceOptions& options_;
  execution::Progress& progress_;
  const execution::CancelToken& cancel_;
};

/// Joins subtrees, which come from left to right; siblings that are complete are lifted at once.
class TopOfTree {
 public:
  TopOfTree(const Tree& tree, const Sector& sector, const Tracer& tracer,
            std::vector<LevelLists>& lists)
      : tree_(tree), sector_(sector), tracer_(tracer), lists_(lists), waiting_(lists.size()) {}

  void add(Subtree subtree) {
    flush(subtree.levels, end_index_);
    TracedTile tile = std::move(subtree.root);
    for (auto& triangle : tile.triangles) {
      if (triangle.index != progressive::kCountedElsewhere)
        triangle.index += end_index_;
    }
    end_index_ = tile.end_index += end_index_;
    climb(std::move(tile));
  }

 private:
  /// Appends parts to the lists. Triangles that a subtree counts start from 0 in it; `first_index`
  /// is added to them. Those of the levels above are final.
  void flush(std::vector<LevelPart>& levels, std::uint64_t first_index) {
    for (std::size_t level = 0; level < levels.size(); ++level)
      append(lists_[level], levels[level], first_index);
  }

  void climb(TracedTile tile) {
    while (tile.node != sector_.node) {
      std::optional<TracedTile>& left = waiting_[raw(tile.node.level)];
      if (tree_.children(tree_.parent(tile.node)).nodes[0] == tile.node) {
        left = std::move(tile);
        return;
      }
      std::vector<LevelPart> levels(lists_.size());
      TracedTile parent = tracer_.raise(std::move(*left), std::move(tile), levels);
      left.reset();
      flush(levels, 0);
      tile = std::move(parent);
    }
    end(tile);
  }

  void end(const TracedTile& root) {
    LevelPart rest;
    rest.lost = progressive::all_of(root);
    append(lists_[raw(root.node.level)], rest, 0);
  }

  const Tree& tree_;
  const Sector& sector_;
  const Tracer& tracer_;
  std::vector<LevelLists>& lists_;
  std::vector<std::optional<TracedTile>> waiting_;  ///< by level, for their sibling
  std::uint64_t end_index_ = 0;
};

}  // namespace

LevelLists::LevelLists(storage::ScratchFile& scratch)
    : lost_ranks(scratch, kListBlockBytes),
      lost_values(scratch, kListBlockBytes),
      lost_triangles(scratch, kListBlockBytes),
      stand_ins(scratch, kListBlockBytes),
      stand_in_values(scratch, kListBlockBytes),
      foreign_ranks(scratch, kListBlockBytes),
      foreign_values(scratch, kListBlockBytes) {}

void trace_sector(const storage::HierarchyReader& reader, const Sector& sector,
                  const TraceOptions& options, std::vector<LevelLists>& lists,
                  execution::Progress& progress, const execution::CancelToken& cancel) {
  const Tree& tree = reader.tree();
  const int below = raw(options.subtrees) - raw(sector.node.level);
  const NodeId first{options.subtrees, sector.node.index << below};
  const std::uint32_t count = std::uint32_t{1} << below;
  const Tracer tracer(reader, sector, options, progress, cancel);
  TopOfTree top(tree, sector, tracer, lists);
  execution::ordered_for(
      count, options.in_flight, cancel,
      [&](std::size_t i) {
        Subtree subtree;
        subtree.levels.resize(lists.size());
        subtree.root = tracer.trace({first.level, first.index + static_cast<std::uint32_t>(i)}, 0,
                                    subtree.levels);
        return subtree;
      },
      [&](std::size_t, Subtree subtree) { top.add(std::move(subtree)); });
}

}  // namespace meshhier::progressive
