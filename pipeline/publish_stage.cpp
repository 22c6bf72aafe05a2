#include "pipeline/publish_stage.h"

#include "execution/parallel.h"
#include "hierarchy/bounds.h"
#include "hierarchy/drawing_rule.h"
#include "hierarchy/lattice.h"
#include "partition/compactness.h"
#include "pipeline/plan/tile_room.h"
#include "pipeline/tiles/vertex_order.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "storage/format/manifest.h"
#include "storage/format/outline_glb.h"
#include "storage/format/tileset.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace meshhier::pipeline {
namespace {

/// The lattice over the input's bounds as they are stored, and how far positions go to it: all
/// tiles are looked at, since simplified ones may have vertices beyond the input's bounds.
storage::Quantization quantize(const Forest& forest, std::span<const NodeId> nodes,
                               const PublishInput& input, std::size_t in_flight,
                               const execution::CancelToken& cancel) {
  const BoundsD& bounds = input.source.bounds;
  const Vec3d& origin = input.format.frame.origin;
  storage::Quantization result;
  result.lattice = make_lattice({to_float(bounds.min - origin), to_float(bounds.max - origin)},
                                static_cast<int>(*input.position_bits));
  execution::ordered_for(
      nodes.size(), in_flight, cancel,
      [&](std::size_t i) {
        BuildTile tile = forest.load(nodes[i]);
        return round_to(result.lattice, tile.mesh.vertices.positions);
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
  const PublishInput& input;
  const storage::TileFormat format;
  const std::optional<storage::Quantization> quantization;
  const std::filesystem::path& directory;
  storage::FileSystem& files;
};

TileRecord describe(const Tree& tree, NodeId node, const BuildTile& tile, const TileFacts& facts,
                    const TargetVertexCounts& asked) {
  const TileMesh& mesh = tile.mesh;
  TileRecord record;
  record.node = node;
  record.own_count = mesh.own_count;
  record.boundary_count = mesh.boundary_count;
  record.ghost_count = static_cast<std::uint32_t>(mesh.ghosts.size());
  record.interior_count = static_cast<std::uint32_t>(mesh.interior.size());
  record.border_count = static_cast<std::uint32_t>(mesh.border.size());
  record.drawn_border_count = drawn_border_count(tree, node, mesh);
  record.target_count = tree.is_partition(node) ? mesh.own_count : asked.of(node.level);
  record.bounds = bounds_of(mesh.vertices.positions);
  record.torn_count = facts.torn_count;
  record.forced_count = facts.forced_count;
  record.error = facts.error;
  record.bound = facts.bound;
  if (tree.is_partition(node)) {
    constexpr double kMost = std::numeric_limits<float>::max();
    record.compactness = static_cast<float>(std::min(partition::compactness(mesh), kMost));
  }
  return record;
}

/// Writes one tile, returns its index entry.
TileRecord write_tile(const TileWriter& to, NodeId node) {
  const Forest& forest = to.forest;
  const Tree& tree = forest.tree();
  BuildTile tile = forest.load(node);
  if (to.quantization)
    round_to(to.quantization->lattice, tile.mesh.vertices.positions);
  std::vector<std::uint16_t> parent_map = forest.published_parent_map(node);
  if (tree.is_partition(node))
    order_inner_vertices(tile.mesh, parent_map);
  TileRecord record = describe(tree, node, tile, forest.facts(node), to.input.target_vertex_counts);
  if (to.quantization) {
    record.bound = with_rounding(record.bound, to.quantization->worst_rounding,
                                 raw(tree.depth()) - raw(node.level));
  }
  const std::vector<std::uint16_t> chains = forest.chains(node, tile.mesh.ghosts);
  const std::vector<std::byte> bytes =
      storage::encode_tile({node, tile.mesh, record.bounds, parent_map, chains}, tree, to.format);
  const auto file = to.files.create(storage::tile_path(to.directory, node));
  file->write_at(0, bytes);
  if (!to.input.is_temporary)
    file->start_sync();
  record.file_bytes = bytes.size();
  record.checksum = storage::checksum(bytes);
  return record;
}

}  // namespace

void publish(Forest& forest, BuildJournal& journal, const PublishInput& input,
             const std::filesystem::path& directory, const MemoryPlan& plan,
             storage::FileSystem& files, execution::Progress& progress,
             const execution::CancelToken& cancel) {
  const Tree& tree = forest.tree();
  const std::vector<NodeId> nodes = tree.tile_nodes();
  for (int l = 0; l <= raw(tree.depth()); ++l) {
    files.make_directories(storage::level_directory(directory, static_cast<Level>(l)));
  }
  std::vector<TileRecord> records(nodes.size());
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (const TileRecord* done = journal.published(nodes[i]))
      records[i] = *done;
    else
      left.push_back(i);
  }
  progress.stage("publish", left.size(), "tiles");
  const bool packed = input.format.compression != storage::Compression::none;
  std::uint64_t heaviest = 0;
  for (int l = 0; l <= raw(tree.depth()); ++l)
    heaviest = std::max(heaviest, packed ? heaviest_packed(forest, static_cast<Level>(l))
                                         : heaviest_read(forest, static_cast<Level>(l)));
  const TileRoom room = room_for(forest, plan, heaviest);
  std::optional<storage::Quantization> quantization;
  storage::TileFormat format = input.format;
  if (input.position_bits) {
    quantization = quantize(forest, nodes, input, room.in_flight(), cancel);
    format.lattice = quantization->lattice;
  }
  const TileWriter writer{forest, input, format, quantization, directory, files};
  execution::ordered_for(
      left.size(), room.in_flight(), cancel,
      [&](std::size_t i) { return write_tile(writer, nodes[left[i]]); },
      [&](std::size_t i, const TileRecord& record) {
        journal.note_published(record);
        records[left[i]] = record;
        progress.advance(1);
      });

  const std::vector<std::byte> index = storage::encode_index(records);
  storage::write_file(files, storage::index_path(directory), index);
  const std::vector<std::byte> outline =
      storage::encode_outline(input.outline.outline, input.format.frame);
  storage::write_file(files, storage::outline_path(directory), outline);

  storage::Manifest manifest;
  manifest.generator = "meshhier " MESHHIER_VERSION;
  manifest.source = input.source;
  manifest.origin = input.format.frame.origin;
  manifest.up = input.format.frame.up;
  manifest.transform = input.transform;
  manifest.licence = input.licence;
  manifest.partition_count = tree.partition_count();
  manifest.compression = input.format.compression;
  manifest.quantization = quantization;
  manifest.config = input.config;
  manifest.index_bytes = index.size();
  manifest.index_checksum = storage::checksum(index);
  manifest.outline_bytes = outline.size();
  manifest.outline_checksum = storage::checksum(outline);
  manifest.outline = input.outline.report;
  manifest.levels = nlohmann::ordered_json::array();
  for (const storage::LevelSummary& level : storage::summarize_levels(tree, records))
    manifest.levels.push_back(storage::to_json(level));
  manifest.total_bytes = std::accumulate(
      records.begin(), records.end(), std::uint64_t{index.size() + outline.size()},
      [](std::uint64_t sum, const TileRecord& record) { return sum + record.file_bytes; });
  storage::write_tilesets(files, directory, tree, records, manifest);
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(files, storage::manifest_path(directory), std::as_bytes(std::span(text)));
}

}  // namespace meshhier::pipeline
