#include "pipeline/publish_stage.h"

#include "config/placement.h"
#include "execution/parallel.h"
#include "hierarchy/bounds.h"
#include "hierarchy/drawing_rule.h"
#include "hierarchy/lattice.h"
#include "partition/compactness.h"
#include "pipeline/plan/tile_room.h"
#include "pipeline/preview.h"
#include "pipeline/texture_stage.h"
#include "pipeline/tiles/texture_store.h"
#include "pipeline/tiles/vertex_order.h"
#include "shading/tile_shading.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "storage/format/manifest.h"
#include "storage/format/outline_glb.h"
#include "storage/format/tile_plan.h"
#include "storage/format/tileset.h"
#include "storage/io/hash.h"
#include "texture/corners.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

namespace meshhier::pipeline {
namespace {

/// Rounds all vertices; returns how far one went at most.
double round_to(const Lattice& lattice, TileMesh& mesh) {
  return std::max(meshhier::round_to(lattice, mesh.vertices.positions),
                  meshhier::round_to(lattice, mesh.copies.vertices.positions));
}

/// The lattice over the input's bounds as they are stored, and how far positions go to it: all
/// tiles are looked at, since simplified ones may have vertices beyond the input's bounds.
storage::Quantization quantize(const Forest& forest, std::span<const NodeId> nodes,
                               const PublishInput& input, std::size_t in_flight,
                               const StageContext& context) {
  const BoundsD& bounds = input.source.bounds;
  const Vec3d& origin = input.origin;
  storage::Quantization result;
  result.lattice = make_lattice({to_float(bounds.min - origin), to_float(bounds.max - origin)},
                                static_cast<int>(*context.config.storage.position_bits));
  execution::ordered_for(
      nodes.size(), in_flight, context.cancel,
      [&](std::size_t i) {
        BuildTile tile = forest.load(nodes[i]);
        return round_to(result.lattice, tile.mesh);
      },
      [&](std::size_t, double worst) {
        result.worst_rounding = std::max(result.worst_rounding, worst);
      });
  return result;
}

/// A bound of exact positions as one of rounded ones. Where rounding is nearly all of it, the
/// levels below still tell it from the children's.
float with_rounding(float bound, double rounding, int levels_below) {
  float sum = float_above(bound + rounding);
  for (int i = 0; i < levels_below; ++i)
    sum = std::nextafter(sum, std::numeric_limits<float>::infinity());
  return sum;
}

/// What writes tiles.
struct TileWriter {
  const Forest& forest;
  const TextureStore& textures;
  const TileErrors& errors;
  const storage::TileFormat format;
  const std::optional<storage::Quantization> quantization;
  const std::filesystem::path& directory;
  const StageContext& context;
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
  record.error = to.errors[node].error;
  record.bound = to.errors[node].bound;
  if (to.quantization) {
    record.bound = with_rounding(record.bound, to.quantization->worst_rounding,
                                 raw(tree.depth()) - raw(node.level));
  }
  if (tree.is_partition(node))
    record.compactness = partition::published_compactness(mesh);
  return record;
}

/// A tile with all that its file has of vertices and triangles.
struct FinishedMesh {
  TileMesh mesh;
  Shading shading;
  TileImage image;
  std::vector<std::uint16_t> parent_map;
};

/// Orders a partition's vertices, and gives all vertices their normals and texture coordinates.
FinishedMesh finish(const TileWriter& to, NodeId node, TileMesh mesh) {
  const Forest& forest = to.forest;
  FinishedMesh finished{std::move(mesh), {}, {}, forest.published_parent_map(node)};
  OwnShading normals = forest.computes_normals() ? forest.normals(node) : OwnShading{};
  if (forest.tree().is_partition(node)) {
    const std::vector<std::uint32_t> copy_places = finished.mesh.copies.places;
    const std::vector<std::uint32_t> place =
        order_inner_vertices(finished.mesh, finished.parent_map);
    if (forest.computes_normals())
      normals = shading::renumbered(normals, copy_places, place, finished.mesh.own_count);
  }
  if (forest.computes_normals()) {
    finished.shading = shading::shade_tile(finished.mesh, normals, [&](std::uint32_t tile) {
      return forest.boundary_normals({node.level, tile});
    });
  }
  if (to.format.textures) {
    TileTexture texture = to.textures.texture(node);
    finished.mesh.vertices.keep_channels(to.format.attributes.channels());
    finished.mesh.copies.vertices.keep_channels(to.format.attributes.channels());
    if (!texture.image.empty())
      finished.shading = texture::with_texcoords(finished.mesh, finished.shading, texture.corners);
    finished.image = std::move(texture.image);
  }
  return finished;
}

/// Writes one tile, returns its index entry.
TileRecord write_tile(const TileWriter& to, NodeId node) {
  const Forest& forest = to.forest;
  const Tree& tree = forest.tree();
  storage::FileSystem& files = to.context.files;
  auto [mesh, shading, image, parent_map] = finish(to, node, forest.load(node).mesh);
  if (to.quantization)
    round_to(to.quantization->lattice, mesh);
  TileRecord record = describe(to, node, mesh, shading);
  if (!image.empty()) {
    record.image_width = image.width;
    record.image_height = image.height;
    record.texel = to.textures.texels(node).own;
  }
  const std::vector<std::uint16_t> chains = forest.chains(node, mesh.ghosts);
  const std::vector<std::byte> bytes = storage::encode_tile(
      {node, mesh, shading, image, record.bounds, parent_map, chains}, tree, to.format);
  const auto file = files.create(storage::tile_path(to.directory, node));
  file->write_at(0, bytes);
  if (to.context.config.storage.container == storage::Container::files)
    file->start_sync();
  record.file_bytes = bytes.size();
  record.checksum = storage::checksum(bytes);
  return record;
}

/// Everything but the tiles.
void write_account(const TileWriter& to, const PublishInput& input,
                   const std::vector<TileRecord>& records) {
  const StageContext& context = to.context;
  storage::FileSystem& files = context.files;
  const Tree& tree = context.tree();
  const std::vector<std::byte> index = storage::encode_index(records);
  storage::write_file(files, storage::index_path(to.directory), index);
  const std::vector<std::byte> outline =
      storage::encode_outline(input.outline.outline, to.format.frame);
  storage::write_file(files, storage::outline_path(to.directory), outline);

  std::optional<MadePreview> preview;
  if (context.config.preview) {
    preview = make_preview({to.directory, to.format, records}, context);
    storage::write_file(files, storage::preview_path(to.directory), preview->file);
  }

  storage::Manifest manifest;
  manifest.generator = "meshhier " MESHHIER_VERSION;
  manifest.source = input.source;
  manifest.origin = to.format.frame.origin;
  manifest.up = to.format.frame.up;
  manifest.transform = config::tileset_transform(context.config, input.source.bounds);
  manifest.licence = context.config.licence;
  manifest.partition_count = tree.partition_count();
  manifest.compression = to.format.compression;
  manifest.quantization = to.quantization;
  manifest.computed_normals = to.format.computed_normals;
  manifest.textures = to.format.textures;
  manifest.config = config::resolved_json(context.config);
  if (!input.source.textures) {
    manifest.config.erase("texture");  // what decided nothing
    manifest.config.erase("missing_images");
  }
  manifest.index_bytes = index.size();
  manifest.index_checksum = storage::checksum(index);
  manifest.outline_bytes = outline.size();
  manifest.outline_checksum = storage::checksum(outline);
  manifest.outline = input.outline.report;
  if (preview)
    manifest.preview = preview->facts;
  manifest.levels = nlohmann::ordered_json::array();
  for (const storage::LevelSummary& level : storage::summarize_levels(tree, records))
    manifest.levels.push_back(storage::to_json(level));
  manifest.total_bytes = std::accumulate(
      records.begin(), records.end(),
      index.size() + outline.size() + (preview ? preview->file.size() : 0),
      [](std::uint64_t sum, const TileRecord& record) { return sum + record.file_bytes; });
  storage::write_tilesets(files, to.directory, tree, records, manifest);
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(files, storage::manifest_path(to.directory), std::as_bytes(std::span(text)));
}

/// Of all levels, what the heaviest tile takes while it is written.
std::uint64_t heaviest_written(const Forest& forest, const config::StorageConfig& storage) {
  const bool packed = storage.compression != storage::Compression::none;
  std::uint64_t heaviest = 0;
  for (int l = 0; l <= raw(forest.tree().depth()); ++l) {
    const auto level = static_cast<Level>(l);
    heaviest =
        std::max(heaviest, packed ? heaviest_packed(forest, level) : heaviest_read(forest, level));
  }
  return heaviest;
}

/// What is drawn takes as much as what is packed.
std::uint64_t heaviest_item(const Forest& forest, const config::Config& config) {
  const std::uint64_t written = heaviest_written(forest, config.storage);
  return config.preview ? std::max(written, heaviest_packed(forest, Level{0})) : written;
}

}  // namespace

void publish(Forest& forest, const TextureStore& textures, BuildJournal& journal,
             const PublishInput& input, const std::filesystem::path& directory,
             const StageContext& context) {
  const Tree& tree = context.tree();
  const config::StorageConfig& storage = context.config.storage;
  for (int l = 0; l <= raw(tree.depth()); ++l) {
    context.files.make_directories(storage::level_directory(directory, static_cast<Level>(l)));
  }
  const std::vector<NodeId> nodes = tree.tile_nodes();
  std::vector<TileRecord> records(nodes.size());
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (const TileRecord* done = journal.published(nodes[i]))
      records[i] = *done;
    else
      left.push_back(i);
  }
  context.progress.stage("publish", left.size(), "tiles");
  // A picture as it was stored, on its own, and in the tile's file.
  const std::uint64_t heaviest =
      heaviest_item(forest, context.config) + 3 * textures.heaviest_bytes();
  const TileRoom room = room_for(forest, context.memory(), heaviest);
  storage::TileFormat format = {
      input.source.attributes, {input.origin, context.config.up}, storage.compression, {}};
  format.computed_normals = forest.computes_normals();
  if (input.source.textures)
    format.textures = context.config.texture.format;
  std::optional<storage::Quantization> quantization;
  if (storage.position_bits) {
    quantization = quantize(forest, nodes, input, room.in_flight(), context);
    format.lattice = quantization->lattice;
  }
  const TileWriter writer{forest, textures, input.errors, format, quantization, directory, context};
  execution::ordered_for(
      left.size(), room.in_flight(), context.cancel,
      [&](std::size_t i) { return write_tile(writer, nodes[left[i]]); },
      [&](std::size_t i, const TileRecord& record) {
        journal.note_published(record);
        records[left[i]] = record;
        context.progress.advance(1);
      });
  write_account(writer, input, records);
}

StageTime publish_time(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kVertexSeconds = 55e-9;
  constexpr double kPackedByteSeconds = 20e-9;
  const double vertices = tiles.partitions.vertices + tiles.simplified.vertices;
  const double packed = job.published_ratio < 1 ? publish_output(job, tiles).plain_bytes : 0;
  return {"publish", "tiles",
          static_cast<std::uint64_t>(tiles.partitions.count + tiles.simplified.count -
                                     tiles.early.count),
          vertices * kVertexSeconds + packed * kPackedByteSeconds +
              (job.draws_preview ? kPreviewSeconds : 0)};
}

OutputCost publish_output(const JobSize& job, const TilePopulation& tiles) {
  constexpr double kFileSlack = 2048;  // half a disk block
  const auto bytes_of = [&](const storage::TileSums& sums) {
    return storage::expected_tile_bytes(sums, job.published_attribute_bytes);
  };
  const double plain =
      bytes_of(tiles.partitions) + bytes_of(tiles.simplified) - bytes_of(tiles.early);
  // Room for a split of every other vertex, as very rough surfaces have them.
  constexpr double kMostSplits = 0.5;
  const double vertices = tiles.partitions.vertices + tiles.simplified.vertices;
  const double splits =
      job.computes_normals || job.textured
          ? kMostSplits * vertices * storage::expected_split_bytes(job.published_attribute_bytes)
          : 0;
  const double pictures = published_picture_bytes(job, tiles);
  return {plain + pictures, plain * job.published_ratio + pictures,
          tiles.files() * kFileSlack + splits +
              (job.draws_preview ? double{storage::kMostPreviewBytes} + kFileSlack : 0)};
}

}  // namespace meshhier::pipeline
