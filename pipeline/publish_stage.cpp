#include "pipeline/publish_stage.h"

#include "base/bounds.h"
#include "execution/parallel.h"
#include "hierarchy/drawing_rule.h"
#include "hierarchy/rounded_tile.h"
#include "partition/compactness.h"
#include "pipeline/normal_map_stage.h"
#include "pipeline/plan/tile_room.h"
#include "pipeline/preview.h"
#include "pipeline/simplify_stage.h"
#include "pipeline/texture_stage.h"
#include "pipeline/tile_format.h"
#include "pipeline/tile_tables.h"
#include "pipeline/tiles/texture_store.h"
#include "pipeline/tiles/tile_normals.h"
#include "storage/format/layout.h"
#include "storage/format/object_table.h"
#include "storage/format/tile_plan.h"
#include "storage/io/hash.h"
#include "storage/io/process.h"
#include "texture/corners.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>

namespace meshhier::pipeline {
namespace {

/// Opens the table of objects that the import has left, if tiles are to have tables of theirs.
std::unique_ptr<const storage::ObjectTable> open_objects(const std::filesystem::path& hierarchy,
                                                         const StageContext& context) {
  if (!context.plan.job.has_object_tables)
    return nullptr;
  return std::make_unique<storage::ObjectTable>(
      context.files.open(storage::imported_objects_path(hierarchy.parent_path())));
}

/// All that writing tiles needs.
struct TileWriter {
  const Forest& forest;
  const TextureStore& textures;
  const storage::TileFormat format;
  const TileFiles& to;
  const StageContext& context;
  std::optional<Standpoint> first_view{};  ///< for the root
};

TileRecord describe(const TileWriter& to, NodeId node, const TileMesh& mesh,
                    const Shading& shading) {
  const Tree& tree = to.context.tree();
  TileRecord record;
  record.node = node;
  record.own_count = mesh.own_count;
  record.boundary_count = mesh.boundary_count;
  record.ghost_count = static_cast<std::uint32_t>(mesh.ghosts.size());
  record.copy_count = static_cast<std::uint32_t>(mesh.copies.size());
  record.split_count = static_cast<std::uint32_t>(shading.split_of.size());
  record.interior_count = static_cast<std::uint32_t>(mesh.interior.size());
  record.border_count = static_cast<std::uint32_t>(mesh.border.size());
  record.drawn_border_count = drawn_border_count(tree, node, mesh);
  record.target_count = tree.is_partition(node)
                            ? mesh.own_count
                            : to.context.plan.target_vertex_counts.of(node.level);
  record.bounds = bounds_of(mesh.vertices.positions);
  record.torn_count = to.forest.fallbacks(node).torn_count;
  record.forced_count = to.forest.fallbacks(node).forced_count;
  if (tree.is_partition(node))
    record.compactness = partition::published_compactness(mesh);
  return record;
}

/// A tile with all vertices and triangles that its file has.
struct FinishedMesh {
  TileMesh mesh;
  Shading shading;
  TileImage image, normal_map;
  std::vector<std::uint16_t> parent_map;
};

/// Adds the picture and the normal map, as far as there are any, and their coordinates.
void add_texture(TileTexture texture, FinishedMesh& finished) {
  if (texture.image.empty() && texture.normal_map.empty())
    return;
  finished.shading = texture::with_texcoords(finished.mesh, finished.shading, texture.corners);
  if (!texture.normal_map.empty()) {
    finished.shading.tangents =
        texture::tangents_of(finished.mesh, finished.shading, texture.tangents);
  }
  finished.image = std::move(texture.image);
  finished.normal_map = std::move(texture.normal_map);
}

/// Orders a partition's vertices, and gives all vertices their normals and texture coordinates.
FinishedMesh finish(const TileWriter& to, NodeId node, TileMesh mesh) {
  OrderedTile tile = ordered_tile(to.forest, node, std::move(mesh));
  FinishedMesh finished{
      std::move(tile.mesh), std::move(tile.shading), {}, {}, std::move(tile.parent_map)};
  if (to.format.textures) {
    finished.mesh.vertices.keep_channels(to.format.attributes.channels());
    finished.mesh.copies.vertices.keep_channels(to.format.attributes.channels());
  }
  if (to.format.textures || (to.format.normal_maps && !to.forest.tree().is_partition(node)))
    add_texture(to.textures.texture(node), finished);
  return finished;
}

/// Returns the first view that the config asks for, or the one in which the root is recognised.
Standpoint first_view_of(const TileWriter& to, Forest& forest) {
  if (const auto wished = to.context.config.first_view.standpoint())
    return *wished;
  const NodeId node = forest.tree().root();
  // Drawing a tile takes as much memory as packing it.
  const TileRoom room =
      room_for(forest, to.context.memory(), {heaviest_packed(forest, std::array{node})});
  FinishedMesh root = finish(to, node, forest.load(node).mesh);
  if (to.format.lattice)
    round_to(*to.format.lattice, root.mesh);
  PublishedTile tile;
  tile.node = node;
  tile.mesh = std::move(root.mesh);
  tile.shading = std::move(root.shading);
  tile.normal_map = std::move(root.normal_map);
  return choose_first_view(tile, to.format);
}

void write_tile_file(const TileWriter& writer, NodeId node, std::span<const std::byte> bytes) {
  storage::FileSystem& files = writer.context.files;
  const auto& [directory, attempts] = writer.to;
  const std::filesystem::path path = storage::tile_path(directory, node);
  if (attempts.empty()) {
    const auto file = files.create(path);
    file->write_at(0, bytes);
    if (writer.context.config.storage.container == storage::Container::files)
      file->start_sync();
    return;
  }
  const std::filesystem::path attempt = attempts / storage::unique_name();
  const auto file = files.create(attempt);
  file->write_at(0, bytes);
  file->sync();
  files.rename(attempt, path);
}

Published write_tile(const TileWriter& to, NodeId node, const TileObjects& objects) {
  const Forest& forest = to.forest;
  auto [mesh, shading, image, normal_map, parent_map] = finish(to, node, forest.load(node).mesh);
  Published published;
  if (to.format.lattice)
    published.rounding = round_to(*to.format.lattice, mesh);
  TileRecord& record = published.record;
  record = describe(to, node, mesh, shading);
  record.has_normal_map = !normal_map.empty();
  if (const TileImage& shown = record.has_normal_map ? normal_map : image; !shown.empty()) {
    record.image_width = shown.width;
    record.image_height = shown.height;
    record.texel = to.textures.texels(node).own;
  }
  const std::vector<std::uint16_t> chains = forest.chains(node, mesh.ghosts);
  const std::vector<std::byte> bytes = storage::encode_tile(
      {node, mesh, shading, image, record.bounds, parent_map, chains,
       node == forest.tree().root() ? to.first_view : std::nullopt, &normal_map, &objects},
      forest.tree(), to.format);
  write_tile_file(to, node, bytes);
  record.file_bytes = bytes.size();
  record.checksum = storage::checksum(bytes);
  return published;
}

/// A tile on its way to its file.
struct TileAtWork {
  NodeId node;
  TileObjects objects;  ///< empty if tiles have no tables of them
  Published published;
};

/// Returns the memory that the heaviest of the nodes takes while it is written.
std::uint64_t heaviest_written(const Forest& forest, std::span<const NodeId> nodes,
                               const config::StorageConfig& storage) {
  return storage.compression != storage::Compression::none ? heaviest_packed(forest, nodes)
                                                           : heaviest_read(forest, nodes);
}

}  // namespace

void publish(Forest& forest, const TextureStore& textures, BuildJournal& journal,
             const TileFiles& to, const Share& share, const storage::ScratchFile& scratch,
             const StageContext& context) {
  const Tree& tree = context.tree();
  for (int l = 0; l <= raw(tree.depth()); ++l) {
    const auto level = static_cast<Level>(l);
    for (const auto& directory :
         storage::tile_directories(to.directory, level, tree.node_count(level)))
      context.files.make_directories(directory);
  }
  std::vector<NodeId> left;
  const std::vector<NodeId> nodes = tree.tile_nodes();
  for (std::uint64_t i = share.begin(nodes.size()); i < share.end(nodes.size()); ++i) {
    if (!journal.is_published(nodes[i]))
      left.push_back(nodes[i]);
  }
  const auto objects = open_objects(to.directory, context);
  TileWriter writer{forest, textures,
                    format_of(*journal.source(), forest.computes_normals(), textures,
                              objects ? &objects->properties() : nullptr, context),
                    to, context};
  if (std::ranges::find(left, tree.root()) != left.end())
    writer.first_view = first_view_of(writer, forest);
  // A picture is held as it was stored, on its own, and in the tile's file.
  const std::uint64_t heaviest =
      heaviest_written(forest, left, context.config.storage) + 3 * textures.heaviest_bytes();
  const TileRoom room = room_for(forest, context.memory(), {heaviest});
  std::optional<TileTables> tables;
  if (objects)
    tables.emplace(forest, left, *objects, scratch, room.in_flight(), context);
  context.progress.stage("publish", left.size(), "tiles");
  std::size_t next = 0;
  execution::ordered_read_blocks<TileAtWork>(
      room.in_flight(), context.cancel,
      [&](TileAtWork& tile) {
        if (next == left.size())
          return false;
        tile.node = left[next++];
        if (tables)
          tile.objects = tables->next();
        return true;
      },
      [&](TileAtWork& tile) { tile.published = write_tile(writer, tile.node, tile.objects); },
      [&](TileAtWork& tile) {
        journal.note_published(tile.published);
        context.progress.advance(1);
      });
  if (!to.attempts.empty())
    context.files.sync_tree(to.directory);
}

StageMemory publish_memory(const JobSize& job) {
  const std::uint64_t bytes = job.draws_preview ? preview_memory(job) : first_view_memory(job);
  return {bytes, 1, bytes, bytes};
}

StageTimes publish_time(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kVertexSeconds = 55e-9;
  constexpr double kPackedByteSeconds = 20e-9;
  constexpr double kAskedVertexSeconds = 30e-9;
  const double vertices = tiles.partitions.vertices + tiles.simplified.vertices;
  const double packed = job.published_ratio < 1 ? publish_output(job, tiles).plain_bytes : 0;
  const StageTime written{"publish", "tiles",
                          static_cast<std::uint64_t>(tiles.partitions.count +
                                                     tiles.simplified.count - tiles.early.count),
                          vertices * kVertexSeconds + packed * kPackedByteSeconds +
                              kFirstViewSeconds + (job.draws_preview ? kPreviewSeconds : 0)};
  if (!job.has_object_tables)
    return {written};
  StageTime asked = written;
  asked.seconds = vertices * kAskedVertexSeconds;
  return {asked, written};
}

namespace {

/// Rows are unpacked in tiles, and stand in those of several levels: cities took 8 to 10 times the
/// bytes of the packed table.
double published_object_bytes(const JobSize& job, double vertices) {
  constexpr double kTablesInTiles = 10, kRowNumber = 4;
  const auto table = static_cast<double>(job.object_table_bytes);
  return table + (job.has_object_tables ? kTablesInTiles * table + kRowNumber * vertices : 0);
}

}  // namespace

DiskVolumes publish_disk(const JobSize& job, const TilePopulation& /*tiles*/,
                         const MemoryPlan& /*memory*/) {
  // Bytes for one of the table as the import packed it, as cities took them: in the sorts that
  // bring rows to tiles, or else in that of the stage `objects`.
  constexpr double kRows = 36, kParts = 18;
  const auto table = static_cast<double>(job.object_table_bytes);
  return {{(job.has_object_tables ? kRows : kParts) * table, DiskMoment::simplify,
           DiskMoment::simplify, true}};
}

OutputCost publish_output(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kFileSlack = 2048;  // half a disk block
  const auto bytes_of = [&](const storage::TileSums& sums) {
    return storage::expected_tile_bytes(sums, job.published_attribute_bytes);
  };
  const double plain =
      bytes_of(tiles.partitions) + bytes_of(tiles.simplified) - bytes_of(tiles.early);
  // There is room for a split of every other vertex, as very rough surfaces have them.
  constexpr double kMostSplits = 0.5;
  const double vertices = tiles.partitions.vertices + tiles.simplified.vertices;
  const double splits =
      job.computes_normals || job.textured || job.normal_map_side > 0
          ? kMostSplits * vertices * storage::expected_split_bytes(job.published_attribute_bytes)
          : 0;
  const double pictures = published_picture_bytes(job, tiles) + published_map_bytes(job, tiles);
  const double objects = published_object_bytes(job, vertices);
  return {plain + pictures + objects, plain * job.published_ratio + pictures + objects,
          tiles.files() * kFileSlack + splits +
              (job.draws_preview ? double{storage::kMostPreviewBytes} + kFileSlack : 0)};
}

}  // namespace meshhier::pipeline
