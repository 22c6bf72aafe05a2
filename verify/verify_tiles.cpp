#include "export/tile_vertices.h"
#include "hierarchy/cut.h"
#include "hierarchy/drawing_rule.h"
#include "hierarchy/lattice.h"
#include "images/formats.h"
#include "partition/compactness.h"
#include "storage/format/layout.h"
#include "verify/verify_objects.h"
#include "verify/verify_parts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// Adds problems that start with the tile's file.
class TileProblems {
 public:
  TileProblems(const VerifyJob& job, NodeId node) : job_(job), node_(node) {}

  template <class... Values>
  void require(bool holds, fmt::format_string<Values...> problem, Values&&... values) const {
    if (holds)
      return;
    job_.problems.add(fmt::format("{}: {}",
                                  storage::tile_path(job_.reader.directory(), node_).string(),
                                  fmt::format(problem, std::forward<Values>(values)...)));
  }

 private:
  const VerifyJob& job_;
  NodeId node_;
};

/// A triangle with the vertices that its corners have at their places.
struct WedgedTriangle {
  TileTriangle places;
  CornerWedges wedges;
  friend auto operator<=>(const WedgedTriangle&, const WedgedTriangle&) = default;
};

/// Returns whether no corner comes twice, and the smallest comes first. `unique`: a place is a
/// corner.
bool is_canonical(const WedgedTriangle& t, bool unique) {
  const auto corner = [&](std::size_t i) {
    return std::pair(t.places[i], unique ? 0 : t.wedges[i]);
  };
  return corner(0) < corner(1) && corner(0) < corner(2) && corner(1) != corner(2);
}

/// Returns whether triangles have the order of normalize_triangles().
bool has_order(const std::vector<TileTriangle>& triangles, const std::vector<CornerWedges>& wedges,
               bool unique) {
  WedgedTriangle last{};
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const WedgedTriangle now{triangles[i], exporting::corner_wedges(wedges, i)};
    if (!is_canonical(now, unique))
      return false;
    if (i > 0 && (unique ? now.places <= last.places : now < last))
      return false;
    last = now;
  }
  return true;
}

/// Marks the corners of triangles, by exporting::vertex_numbers().
void mark_used(const TileMesh& mesh, const std::vector<TileTriangle>& triangles,
               const std::vector<CornerWedges>& wedges, std::vector<bool>& used) {
  used.resize(mesh.vertices.size() + mesh.copies.size());
  for (const TileTriangle& t : exporting::vertex_numbers(mesh).numbered(triangles, wedges)) {
    for (const TileVertex v : t)
      used[raw(v)] = true;
  }
}

std::uint64_t count_unused(const std::vector<bool>& used, std::size_t first, std::size_t count) {
  const auto begin = used.begin() + static_cast<std::ptrdiff_t>(first);
  return static_cast<std::uint64_t>(
      std::count(begin, begin + static_cast<std::ptrdiff_t>(count), false));
}

/// Returns whether a tile has no more of its neighbours' copies than its border triangles need.
bool uses_ghost_copies(const TileMesh& mesh) {
  std::vector<bool> used;
  mark_used(mesh, mesh.border, mesh.border_wedges, used);
  const std::size_t own = exporting::own_copy_count(mesh);
  return count_unused(used, mesh.vertices.size() + own, mesh.copies.size() - own) == 0;
}

/// Returns whether a tile has no more of its neighbours' splits than its border triangles need.
bool uses_ghost_splits(const PublishedTile& tile) {
  const Shading& shading = tile.shading;
  const TileMesh& mesh = tile.mesh;
  const std::size_t first = mesh.vertices.size() + mesh.copies.size();
  std::vector<bool> used(first + shading.split_of.size());
  for (const TileTriangle& t : shading.border) {
    for (const TileVertex v : t)
      used[raw(v)] = true;
  }
  const VertexNumbers numbers = exporting::vertex_numbers(mesh);
  for (std::size_t i = 0; i < shading.split_of.size(); ++i) {
    if (numbers[shading.split_of[i]].place >= mesh.own_count && !used[first + i])
      return false;
  }
  return true;
}

/// Own places of border triangles are on the boundary (which may hold more: triangles that a
/// neighbour's contraction made degenerate are gone); every ghost is in a border triangle.
bool has_sound_boundary(const TileMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size());
  for (const TileTriangle& t : mesh.border) {
    for (TileVertex v : t)
      used[raw(v)] = true;
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] ? v >= mesh.boundary_count && v < mesh.own_count : v >= mesh.own_count)
      return false;
  }
  return true;
}

void check_errors(const VerifyJob& job, const TileRecord& record, const TileProblems& problems) {
  const bool partition = job.tree().is_partition(record.node);
  const auto proper = [](float x) { return std::isfinite(x) && x >= 0; };
  problems.require(proper(record.error) && proper(record.bound),
                   "error {} and bound {} must be finite and not negative", record.error,
                   record.bound);
  const auto& quantization = job.reader.manifest().quantization;
  const float rounding = quantization ? float_above(quantization->worst_rounding) : 0;
  problems.require(!partition || (record.error == 0 && record.bound == rounding),
                   "a partition has error {} and bound {}, expected 0 and {}", record.error,
                   record.bound, rounding);
  if (record.node.level == Level{})
    return;
  const TileRecord& parent = job.reader.record(job.tree().parent_tile(record.node));
  problems.require(record.error < parent.error,
                   "error {} is not below the error {} of its parent {}", record.error,
                   parent.error, to_text(parent.node));
  problems.require(record.bound < parent.bound,
                   "bound {} is not below the bound {} of its parent {}", record.bound,
                   parent.bound, to_text(parent.node));
}

std::uint64_t vertices_below(const VerifyJob& job, NodeId node) {
  std::uint64_t sum = 0;
  const Tree::Children children = job.tree().children(node);
  for (const NodeId child : children.span())
    sum += job.reader.record(child).own_count;
  return sum;
}

/// Vertices went into tiles above the partitions only, and no more of them than there were.
void check_history(const VerifyJob& job, const TileRecord& record, const TileProblems& problems) {
  const bool partition = job.tree().is_partition(record.node);
  const std::uint64_t below = partition ? 0 : vertices_below(job, record.node);
  const std::uint64_t given_up = std::uint64_t{record.torn_count} + record.forced_count;
  problems.require(given_up <= below, "{} vertices torn or forced away of {} below it", given_up,
                   below);
  problems.require(!partition || record.target_count == record.own_count,
                   "a partition of {} vertices, of which {} were asked for", record.own_count,
                   record.target_count);
  problems.require(partition || record.compactness == 0, "a simplified tile has compactness {}",
                   record.compactness);
}

void check_compactness(const TileMesh& mesh, const TileRecord& record,
                       const TileProblems& problems) {
  const float found = partition::published_compactness(mesh);
  problems.require(record.compactness == found, "compactness {}, the index says {}", found,
                   record.compactness);
}

/// Counts own vertices, copies too, that are corners of no triangle.
std::uint64_t unreferenced_count(const TileMesh& mesh) {
  std::vector<bool> used;
  mark_used(mesh, mesh.interior, mesh.interior_wedges, used);
  mark_used(mesh, mesh.border, mesh.border_wedges, used);
  return count_unused(used, 0, mesh.own_count) +
         count_unused(used, mesh.vertices.size(), exporting::own_copy_count(mesh));
}

void check_parent_map(const VerifyJob& job, const PublishedTile& tile,
                      const TileProblems& problems) {
  if (tile.node.level == Level{}) {
    problems.require(tile.parent_map.empty(), "the root has a parent map");
    return;
  }
  const TileRecord& parent = job.reader.record(job.tree().parent_tile(tile.node));
  problems.require(tile.parent_map.size() == tile.mesh.own_count,
                   "the parent map has {} entries for {} vertices", tile.parent_map.size(),
                   tile.mesh.own_count);
  const auto wrong = std::find_if(tile.parent_map.begin(), tile.parent_map.end(),
                                  [&](std::uint16_t v) { return v >= parent.own_count; });
  problems.require(wrong == tile.parent_map.end(),
                   "the parent map leads to a vertex beyond the {} of tile {}", parent.own_count,
                   to_text(parent.node));
}

/// Sums over all tiles.
struct TileTotals {
  PartitionTotals partitions;
  std::uint64_t ghosts = 0, border = 0;
  std::size_t off_target = 0;  ///< tiles with fewer vertices than were asked for
};

void add_tile(const VerifyJob& job, const TileRecord& record, const TileMesh& mesh,
              TileTotals& totals) {
  if (job.tree().is_partition(record.node)) {
    totals.partitions.copies += exporting::own_copy_count(mesh);
    totals.partitions.unreferenced += unreferenced_count(mesh);
  }
  totals.ghosts += record.ghost_count;
  totals.border += record.border_count;
}

/// Lets tiles be read ahead in the order in which they are verified.
void will_read_all(const VerifyJob& job) {
  std::vector<NodeId> nodes;
  for (const TileRecord& record : job.reader.records())
    nodes.push_back(record.node);
  job.reader.will_read(nodes);
}

void tell_checks(const VerifyJob& job, const TileTotals& totals) {
  job.checks.push_back(fmt::format(
      "tiles: sizes, checksums and structure of {}; {} below the vertex count asked for",
      job.reader.records().size() - job.tiles.unreadable_count(), totals.off_target));
  if (const auto& textures = job.reader.manifest().textures) {
    if (const std::string missing = images::missing_coder(*textures); !missing.empty())
      job.checks.push_back("pictures: their heads alone, as " + missing);
  }
  job.checks.push_back(
      fmt::format("borders: {} ghosts and {} border triangles compared with the neighbours' own",
                  totals.ghosts, totals.border));
  job.checks.push_back("every cut: each simplified tile compared with the image of its children");
}

}  // namespace

ParentMaps make_parent_maps(const VerifyJob& job) {
  return {job.options.memory_budget / 16,
          [&job](NodeId node) {
            const auto tile = job.tiles.find(node);
            return tile ? tile->parent_map : std::vector<std::uint16_t>{};
          },
          [](const auto& map) { return map.size() * sizeof(map[0]) + sizeof(map); }};
}

void verify_tile(const VerifyJob& job, const TileRecord& record, const PublishedTile& tile) {
  const Tree& tree = job.tree();
  const TileMesh& mesh = tile.mesh;
  const TileProblems problems(job, tile.node);
  const bool partition = tree.is_partition(tile.node);
  problems.require(!partition || mesh.own_count == tree.ranks(tile.node).size(),
                   "{} vertices, but partition {} of {} has {}", mesh.own_count, tile.node.index,
                   tree.partition_count(), tree.ranks(tile.node).size());
  problems.require(record.own_count <= record.target_count,
                   "{} vertices, more than the {} asked for", record.own_count,
                   record.target_count);
  problems.require(has_order(mesh.interior, mesh.interior_wedges, !partition) &&
                       has_order(mesh.border, mesh.border_wedges, !partition),
                   "triangles are not in order, degenerate or repeated");
  problems.require(uses_ghost_copies(mesh), "a copy of a ghost has no border triangle");
  problems.require(uses_ghost_splits(tile), "a split of a ghost has no border triangle");
  problems.require(
      has_sound_boundary(mesh),
      "a border triangle has an own corner off the boundary, or a ghost has no border triangle");
  const std::uint32_t drawn = drawn_border_count(tree, tile.node, mesh);
  problems.require(drawn == record.drawn_border_count,
                   "draws {} border triangles in its level's cut, the index says {}", drawn,
                   record.drawn_border_count);
  check_parent_map(job, tile, problems);
  check_errors(job, record, problems);
  check_history(job, record, problems);
  if (partition)
    check_compactness(mesh, record, problems);
}

void verify_alone(const VerifyJob& job, const TileRecord& record, const PublishedTile& tile) {
  verify_tile(job, record, tile);
  if (!tile.image.empty() || !tile.normal_map.empty())
    verify_texture(job, tile);
  if (!job.tree().is_partition(record.node))
    verify_image(job, tile);
}

void verify_tiles(const VerifyJob& job) {
  ParentMaps maps = make_parent_maps(job);
  const auto has_texcoords = [&](NodeId node) { return job.reader.record(node).image_width > 0; };
  BorderPairs pairs(job.tree(), maps, has_texcoords, job.scratch, job.options.memory_budget / 8);
  CopyClaims claims(job.tree(), has_texcoords, job.scratch, job.options.memory_budget / 8);
  std::optional<ObjectCheck> objects;
  if (job.reader.manifest().objects)
    objects.emplace(job, job.options.memory_budget / 8);
  job.progress.stage("verify", job.reader.records().size(), "tiles");
  will_read_all(job);
  TileTotals totals;
  for (const TileRecord& record : job.reader.records()) {
    job.cancel.check();
    if (const auto tile = job.tiles.find(record.node)) {
      verify_alone(job, record, *tile);
      pairs.add(*tile);
      claims.add(*tile);
      if (objects)
        objects->add(*tile);
      add_tile(job, record, tile->mesh, totals);
    }
    totals.off_target += record.own_count != record.target_count ? 1 : 0;
    job.progress.advance(1);
  }
  const auto are_all_read = [&] { return job.tiles.unreadable_count() == 0; };
  if (are_all_read())
    verify_vertex_counts(job, totals.partitions);
  pairs.finish([&](const NodePair& pair) {
    const auto level = static_cast<Level>(pair.level);
    explain_difference(job, {level, pair.low}, {level, pair.high});
  });
  claims.finish([&](const WrongCopies& wrong) { tell_wrong_copies(job, wrong); });
  if (objects)
    objects->finish_tiles();
  if (objects && are_all_read())
    objects->finish();
  tell_checks(job, totals);
}

}  // namespace meshhier::verifying
