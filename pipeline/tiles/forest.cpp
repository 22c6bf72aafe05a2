#include "pipeline/tiles/forest.h"

#include "cluster_simplify/seams.h"
#include "pipeline/tiles/blob_json.h"
#include "shading/tile_shading.h"
#include "storage/format/work_tile.h"

#include <algorithm>
#include <array>

namespace meshhier::pipeline {
namespace {

std::uint32_t owner_of(const GhostRef& ghost) {
  return ghost.tile;
}
std::uint32_t owner_of(const FinerGhost& ghost) {
  return ghost.ref.tile;
}
std::uint32_t owner_of(const ChunkVertex& vertex) {
  return vertex.chunk;
}

/// Calls visit(begin, end) for each run of references to one tile or chunk. Requires them sorted.
template <class Ref, class Visit>
void for_each_owner(std::span<const Ref> refs, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < refs.size(); begin = end) {
    while (end < refs.size() && owner_of(refs[end]) == owner_of(refs[begin]))
      ++end;
    visit(begin, end);
  }
}

}  // namespace

Forest::Forest(const Tree& tree, Level chunks, const AttributeLayout& layout,
               storage::ScratchFile& scratch, bool computes_normals)
    : tree_(tree),
      chunks_(chunks),
      layout_(layout),
      layout_above_(layout.material ? layout.without_texcoords() : layout),
      computes_normals_(computes_normals),
      pool_(scratch.pool()),
      places_(scratch, tree.node_count(chunks)) {
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    const std::uint32_t count = tree.node_count(static_cast<Level>(level));
    levels_.push_back({{scratch, count},
                       {scratch, count},
                       {scratch, count},
                       {scratch, count},
                       {scratch, count},
                       {scratch, count},
                       {scratch, count},
                       std::vector<Fallbacks>(count),
                       std::vector<std::uint32_t>(count)});
  }
}

void Forest::put_places(std::uint32_t chunk, std::span<const partition::LeafPlace> places) {
  places_.put(chunk, std::as_bytes(places));
}

template <class Corner>
void Forest::put_work_tile(NodeId node, const WorkTile<Corner>& tile) {
  LevelStore& level = levels_[raw(node.level)];
  level.tiles.put(node.index, storage::encode_work_tile(tile));
  level.boundaries.put(node.index, storage::encode_boundary(tile));
  level.own_counts[node.index] = static_cast<std::uint32_t>(tile.vertices.size());
}

template void Forest::put_work_tile(NodeId node, const LeafTile& tile);
template void Forest::put_work_tile(NodeId node, const SimplifiedTile& tile);

void Forest::put_normals(NodeId node, const OwnShading& normals, const TileMesh& mesh) {
  LevelStore& level = levels_[raw(node.level)];
  level.normals.put(node.index, storage::encode_own_shading(normals));
  level.boundary_normals.put(node.index,
                             storage::encode_boundary_shading(shading::boundary_of(normals, mesh)));
}

void Forest::put_parent_map(NodeId child, std::span<const std::uint16_t> parent_map) {
  levels_[raw(child.level)].parent_maps.put(child.index, std::as_bytes(parent_map));
}

void Forest::put_wedge_map(NodeId child, const WedgeMap& wedge_map) {
  levels_[raw(child.level)].wedge_maps.put(child.index, storage::encode_wedge_map(wedge_map));
}

std::uint64_t Forest::triangle_bytes(NodeId node) const {
  std::array<std::byte, storage::kWorkTileHeadBytes> head;
  levels_[raw(node.level)].tiles.read(node.index, 0, head);
  return storage::work_triangle_bytes(head) +
         storage::work_copy_bytes(head, channels(node)) / kCopyShare;
}

storage::TileSums Forest::partition_sums() const {
  const storage::BlobStore& tiles = levels_[raw(tree_.depth())].tiles;
  storage::TileSums sums;
  for (std::size_t i = 0; i < tiles.count(); ++i) {
    std::array<std::byte, storage::kWorkTileHeadBytes> head;
    tiles.read(i, 0, head);
    storage::add_work_tile(head, sums);
  }
  return sums;
}

std::uint64_t Forest::split_count() const {
  if (!computes_normals_)
    return 0;
  std::uint64_t splits = 0;
  for (const NodeId node : tree_.tile_nodes()) {
    std::array<std::byte, storage::kShadingHeadBytes> head;
    levels_[raw(node.level)].normals.read(node.index, 0, head);
    splits += storage::encoded_split_count(head);
  }
  return splits;
}

void Forest::drop_copies(std::uint64_t free_bytes) {
  for (std::size_t level = levels_.size(); level-- > 0;) {
    for (storage::BlobStore* store :
         {&levels_[level].tiles, &levels_[level].boundaries, &levels_[level].seam_strips,
          &levels_[level].parent_maps, &levels_[level].wedge_maps, &levels_[level].normals,
          &levels_[level].boundary_normals}) {
      if (pool_.free_bytes() >= free_bytes)
        return;
      store->drop_copies();
    }
  }
}

/// Returns the tile with its ghosts at its own level, but without their vertices.
template <class Corner>
LoadedTile Forest::resolved(NodeId node) const {
  const storage::BlobStore& tiles = levels_[raw(node.level)].tiles;
  auto work = storage::decode_work_tile<Corner>(tiles.view(node.index).bytes(), channels(node));
  LoadedTile loaded;
  loaded.mapped = mapped(node, work.foreign);
  map_wedges(node, work);
  loaded.tile = cluster_simplify::resolve(std::move(work), loaded.mapped, !tree_.is_partition(node),
                                          node.index);
  return loaded;
}

LoadedTile Forest::load_with_mapped(NodeId node) const {
  const LevelStore& level = levels_[raw(node.level)];
  LoadedTile loaded =
      tree_.is_partition(node) ? resolved<ChunkVertex>(node) : resolved<FinerGhost>(node);
  BuildTile& tile = loaded.tile;
  tile.mesh.vertices.reserve(tile.mesh.own_count + tile.mesh.ghosts.size());
  for_each_owner(std::span<const GhostRef>(tile.mesh.ghosts), [&](std::size_t begin, std::size_t) {
    const std::uint32_t neighbour = tile.mesh.ghosts[begin].tile;
    cluster_simplify::fill_ghosts(
        tile, neighbour,
        storage::decode_boundary(level.boundaries.view(neighbour).bytes(), channels(node)));
  });
  return loaded;
}

OwnShading Forest::normals(NodeId node) const {
  return storage::decode_own_shading(levels_[raw(node.level)].normals.view(node.index).bytes());
}

BoundaryShading Forest::boundary_normals(NodeId node) const {
  node = tree_.tile_node(node);
  return storage::decode_boundary_shading(
      levels_[raw(node.level)].boundary_normals.view(node.index).bytes());
}

void Forest::put_seam_strip(NodeId node, const SeamStrip& seam_strip) {
  levels_[raw(node.level)].seam_strips.put(node.index, storage::encode_seam_strip(seam_strip));
}

SeamStrip Forest::seam_strip(NodeId node) const {
  return storage::decode_seam_strip(levels_[raw(node.level)].seam_strips.view(node.index).bytes());
}

std::vector<GhostRef> Forest::mapped(NodeId node, std::span<const FinerGhost> foreign) const {
  std::vector<GhostRef> result;
  result.reserve(foreign.size());
  // A foreign corner is a vertex of a tile one level finer: the map of that tile tells which vertex
  // of its parent it has become. References are sorted, so the last one tells how much of it is
  // needed.
  for_each_owner(foreign, [&](std::size_t begin, std::size_t end) {
    const NodeId child{finer(node.level), foreign[begin].ref.tile};
    const std::uint32_t parent = tree_.parent(child).index;
    const std::vector<std::uint16_t> map = parent_map(child, foreign[end - 1].ref.index + 1);
    for (std::size_t i = begin; i < end; ++i)
      result.push_back({parent, map[foreign[i].ref.index]});
  });
  return result;
}

void Forest::map_wedges(NodeId node, SimplifiedTile& tile) const {
  if (tile.border_wedges.empty())
    return;
  // Each foreign corner has the map of its tile.
  std::vector<WedgeMap> maps;
  std::vector<std::uint32_t> map_of(tile.foreign.size());
  for_each_owner(std::span<const FinerGhost>(tile.foreign),
                 [&](std::size_t begin, std::size_t end) {
                   std::fill(map_of.begin() + static_cast<std::ptrdiff_t>(begin),
                             map_of.begin() + static_cast<std::ptrdiff_t>(end),
                             static_cast<std::uint32_t>(maps.size()));
                   maps.push_back(wedge_map({finer(node.level), tile.foreign[begin].ref.tile}));
                 });
  const std::size_t own_count = tile.vertices.size();
  for (std::size_t i = 0; i < tile.border.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (raw(tile.border[i][k]) < own_count)
        continue;
      const std::size_t foreign = raw(tile.border[i][k]) - own_count;
      std::uint32_t& wedge = tile.border_wedges[i][k];
      wedge = maps[map_of[foreign]](tile.foreign[foreign].ref.index, wedge);
    }
  }
}

WedgeMap Forest::wedge_map(NodeId child) const {
  const storage::BlobStore& maps = levels_[raw(child.level)].wedge_maps;
  return maps.size(child.index) == 0 ? WedgeMap{}
                                     : storage::decode_wedge_map(maps.view(child.index).bytes());
}

std::vector<GhostRef> Forest::mapped(NodeId, std::span<const ChunkVertex> foreign) const {
  std::vector<GhostRef> result;
  result.reserve(foreign.size());
  for_each_owner(foreign, [&](std::size_t begin, std::size_t end) {
    const std::uint32_t chunk = foreign[begin].chunk;
    const std::uint32_t first = tree_.partitions({chunks_, chunk}).begin;
    std::vector<partition::LeafPlace> places(places_.size(chunk) / sizeof(partition::LeafPlace));
    places_.copy(chunk, std::as_writable_bytes(std::span(places)));
    for (std::size_t i = begin; i < end; ++i) {
      const partition::LeafPlace& place = partition::find_place(places, foreign[i].local);
      result.push_back({first + place.partition, place.index});
    }
  });
  return result;
}

std::vector<std::uint16_t> Forest::parent_map(NodeId child, std::size_t count) const {
  std::vector<std::uint16_t> map(count);
  levels_[raw(child.level)].parent_maps.copy(child.index, std::as_writable_bytes(std::span(map)));
  return map;
}

std::vector<std::uint16_t> Forest::parent_map(NodeId child) const {
  return parent_map(
      child, levels_[raw(child.level)].parent_maps.size(child.index) / sizeof(std::uint16_t));
}

std::vector<std::uint16_t> Forest::published_parent_map(NodeId node) const {
  if (node.level == Level{0})
    return {};
  // An early node keeps its partition as it is, so the map from it is the map from the partition.
  return parent_map(tree_.stands_for_parent(node) ? tree_.parent(node) : node);
}

std::vector<std::uint16_t> Forest::map_up(NodeId node, Level level) const {
  std::vector<std::uint16_t> map = published_parent_map(node);
  for (NodeId at = tree_.parent_tile(node); at.level > level; at = tree_.parent(at)) {
    const std::vector<std::uint16_t> next = parent_map(at);
    for (std::uint16_t& vertex : map)
      vertex = next[vertex];
  }
  return map;
}

std::vector<std::uint16_t> Forest::chains(NodeId node, std::span<const GhostRef> ghosts) const {
  std::vector<std::uint16_t> result;
  for_each_owner(ghosts, [&](std::size_t begin, std::size_t end) {
    NodeId tile{node.level, ghosts[begin].tile};
    const auto length = static_cast<std::size_t>(tree_.chain_length(node, tile));
    const std::size_t first = result.size();
    result.resize(first + (end - begin) * length);
    std::uint32_t last = 0;
    for (std::size_t i = begin, at = first; i < end; ++i, at += length) {
      result[at] = static_cast<std::uint16_t>(ghosts[i].index);
      last = std::max(last, ghosts[i].index);
    }
    for (std::size_t step = 1; step < length; ++step, tile = tree_.parent(tile)) {
      const std::vector<std::uint16_t> map = parent_map(tile, std::size_t{last} + 1);
      last = 0;
      for (std::size_t at = first + step; at < result.size(); at += length) {
        result[at] = map[result[at - 1]];
        last = std::max<std::uint32_t>(last, result[at]);
      }
    }
  });
  return result;
}

nlohmann::json Forest::stored_chunk(std::uint32_t chunk) const {
  const LevelStore& leaves = levels_[raw(tree_.depth())];
  nlohmann::json partitions = nlohmann::json::array();
  const PartitionRange range = tree_.partitions({chunks_, chunk});
  for (std::uint32_t p = range.begin; p < range.end; ++p)
    partitions.push_back({leaves.own_counts[p], to_json(leaves.tiles.stored(p)),
                          to_json(leaves.boundaries.stored(p))});
  return {{"places", to_json(places_.stored(chunk))}, {"partitions", std::move(partitions)}};
}

bool Forest::restore_chunk(std::uint32_t chunk, const nlohmann::json& stored) {
  LevelStore& leaves = levels_[raw(tree_.depth())];
  const PartitionRange range = tree_.partitions({chunks_, chunk});
  const nlohmann::json& partitions = stored.at("partitions");
  if (partitions.size() != range.end - range.begin || !restore(places_, chunk, stored.at("places")))
    return false;
  for (std::uint32_t p = range.begin; p < range.end; ++p) {
    const nlohmann::json& partition = partitions.at(p - range.begin);
    leaves.own_counts[p] = partition.at(0);
    if (!restore(leaves.tiles, p, partition.at(1)) ||
        !restore(leaves.boundaries, p, partition.at(2)))
      return false;
  }
  return true;
}

nlohmann::json Forest::stored_tile(NodeId node) const {
  const LevelStore& level = levels_[raw(node.level)];
  nlohmann::json maps = nlohmann::json::array();
  const Tree::Children children = tree_.children(node);
  for (const NodeId child : children.span())
    maps.push_back(to_json(levels_[raw(child.level)].parent_maps.stored(child.index)));
  nlohmann::json wedge_maps = nlohmann::json::array();
  for (const NodeId child : children.span())
    wedge_maps.push_back(to_json(levels_[raw(child.level)].wedge_maps.stored(child.index)));
  nlohmann::json normals = nlohmann::json::array();
  for (const NodeId child : children.span()) {
    if (has_normals(child))
      normals.push_back(stored_normals(child));
  }
  const Fallbacks& fallbacks = level.fallbacks[node.index];
  return {{"own", level.own_counts[node.index]},
          {"torn", fallbacks.torn_count},
          {"forced", fallbacks.forced_count},
          {"tile", to_json(level.tiles.stored(node.index))},
          {"boundary", to_json(level.boundaries.stored(node.index))},
          {"seam_strip", to_json(level.seam_strips.stored(node.index))},
          {"maps", std::move(maps)},
          {"wedge_maps", std::move(wedge_maps)},
          {"normals", std::move(normals)}};
}

nlohmann::json Forest::stored_normals(NodeId node) const {
  const LevelStore& level = levels_[raw(node.level)];
  return {to_json(level.normals.stored(node.index)),
          to_json(level.boundary_normals.stored(node.index))};
}

bool Forest::restore_normals(NodeId node, const nlohmann::json& stored) {
  LevelStore& level = levels_[raw(node.level)];
  return restore(level.normals, node.index, stored.at(0)) &&
         restore(level.boundary_normals, node.index, stored.at(1));
}

nlohmann::json Forest::stored_root() const {
  return has_normals(tree_.root()) ? stored_normals(tree_.root()) : nlohmann::json();
}

bool Forest::restore_root(const nlohmann::json& stored) {
  return !has_normals(tree_.root()) || restore_normals(tree_.root(), stored);
}

bool Forest::restore_tile(NodeId node, const nlohmann::json& stored) {
  LevelStore& level = levels_[raw(node.level)];
  level.own_counts[node.index] = stored.at("own");
  level.fallbacks[node.index].torn_count = stored.at("torn");
  level.fallbacks[node.index].forced_count = stored.at("forced");
  std::size_t map = 0;
  std::size_t normals = 0;
  const Tree::Children children = tree_.children(node);
  for (const NodeId child : children.span()) {
    LevelStore& below = levels_[raw(child.level)];
    if (!restore(below.parent_maps, child.index, stored.at("maps").at(map)) ||
        !restore(below.wedge_maps, child.index, stored.at("wedge_maps").at(map)))
      return false;
    if (has_normals(child) && !restore_normals(child, stored.at("normals").at(normals++)))
      return false;
    ++map;
  }
  return restore(level.tiles, node.index, stored.at("tile")) &&
         restore(level.boundaries, node.index, stored.at("boundary")) &&
         restore(level.seam_strips, node.index, stored.at("seam_strip"));
}

}  // namespace meshhier::pipeline
