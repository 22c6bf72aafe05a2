#include "pipeline/account_stage.h"

#include "config/placement.h"
#include "hierarchy/rounded_tile.h"
#include "pipeline/images_stage.h"
#include "pipeline/plan/tile_room.h"
#include "pipeline/preview.h"
#include "pipeline/simplify_stage.h"
#include "pipeline/texture_stage.h"
#include "pipeline/tile_format.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "storage/format/object_facts.h"
#include "storage/format/outline_glb.h"
#include "storage/format/tileset.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::pipeline {
namespace {

/// Returns the records with errors and bounds, which count the rounding of positions.
std::vector<TileRecord> complete_records(std::span<const Published> tiles, const TileErrors& errors,
                                         const std::optional<storage::Quantization>& rounded,
                                         const Tree& tree) {
  std::vector<TileRecord> records;
  records.reserve(tiles.size());
  for (const Published& tile : tiles) {
    TileRecord& record = records.emplace_back(tile.record);
    const TileError& error = errors[record.node];
    record.error = error.error;
    record.bound = error.bound;
    if (rounded) {
      record.bound = bound_with_rounding(error.bound, rounded->worst_rounding,
                                         raw(tree.depth()) - raw(record.node.level));
    }
  }
  return records;
}

/// Returns the summary of the input, completed by what all stages have found.
SourceSummary complete_source(const BuildJournal& journal, const StageContext& context) {
  SourceSummary source = journal.source()->summary;
  source.unreferenced_vertices = journal.unreferenced_vertices();
  if (source.textures) {
    source.textures->texels = context.plan.textures.texels();
    source.textures->missing_images += broken_pictures(context.plan.textures, journal).size();
  }
  return source;
}

TileErrors complete_errors(const TextureStore& textures, BuildJournal& journal,
                           const StageContext& context) {
  const SourceSummary& source = journal.source()->summary;
  TileErrors errors = add_up(journal, context.tree(), source.diagonal());
  return source.textures ? with_texels(std::move(errors), context.tree(), textures) : errors;
}

/// Returns how positions were rounded; nothing if they stay exact.
std::optional<storage::Quantization> quantization_of(const storage::TileFormat& format,
                                                     std::span<const Published> tiles) {
  if (!format.lattice)
    return std::nullopt;
  storage::Quantization rounded;
  rounded.lattice = *format.lattice;
  for (const Published& tile : tiles)
    rounded.worst_rounding = std::max(rounded.worst_rounding, tile.rounding);
  return rounded;
}

/// Returns the keys of the config that decided something.
nlohmann::ordered_json deciding_config(const SourceSummary& source, const StageContext& context) {
  nlohmann::ordered_json keys = config::resolved_json(context.config);
  if (!source.textures) {
    keys.erase("texture");
    keys.erase("missing_images");
  }
  if (context.plan.job.normal_map_side == 0)
    keys.erase("normal_map");
  return keys;
}

/// Returns what is known before the files are: of what, and how the tiles were made.
storage::Manifest begin_manifest(const SourceSummary& source, Vec3d origin,
                                 const storage::TileFormat& format, const StageContext& context) {
  storage::Manifest manifest;
  manifest.generator = "meshhier " MESHHIER_VERSION;
  manifest.source = source;
  manifest.origin = origin;
  manifest.up = format.frame.up;
  manifest.units = context.config.units ? context.config.units : source.units;
  manifest.transform = config::tileset_transform(context.config, source.bounds);
  manifest.licence = context.config.licence;
  manifest.tileset_pixels = context.config.tileset.pixels;
  manifest.partition_count = context.tree().partition_count();
  manifest.compression = format.compression;
  manifest.computed_normals = format.computed_normals;
  manifest.textures = format.textures;
  manifest.normal_maps = format.normal_maps;
  manifest.config = deciding_config(source, context);
  return manifest;
}

/// Adds what the records tell. `others`: bytes of files that are no tiles.
void add_tiles(storage::Manifest& manifest, const Tree& tree, std::span<const TileRecord> records,
               std::uint64_t others) {
  manifest.levels = nlohmann::ordered_json::array();
  for (const storage::LevelSummary& level : storage::summarize_levels(tree, records))
    manifest.levels.push_back(storage::to_json(level));
  manifest.total_bytes = std::accumulate(
      records.begin(), records.end(), others,
      [](std::uint64_t sum, const TileRecord& record) { return sum + record.file_bytes; });
}

}  // namespace

void write_account(Forest& forest, const TextureStore& textures, BuildJournal& journal,
                   const OutlineStageResult& outline,
                   const std::optional<storage::ObjectsSummary>& known_objects,
                   const std::filesystem::path& directory, const StageContext& context) {
  storage::FileSystem& files = context.files;
  const Tree& tree = context.tree();
  const SourceSummary source = complete_source(journal, context);
  const std::vector<Published> tiles = journal.published();
  const bool has_tables = known_objects && context.plan.job.has_object_tables;
  storage::TileFormat format =
      format_of(*journal.source(), forest.computes_normals(), textures,
                has_tables ? &known_objects->table.properties : nullptr, context);
  const auto quantization = quantization_of(format, tiles);
  const std::vector<TileRecord> records =
      complete_records(tiles, complete_errors(textures, journal, context), quantization, tree);
  const std::vector<std::byte> index = storage::encode_index(records);
  storage::write_file(files, storage::index_path(directory), index);
  // Drawing a tile takes as much memory as packing it.
  const std::array root{tree.root()};
  const TileRoom room = room_for(forest, context.memory(), {heaviest_packed(forest, root)});
  const PreviewInput published{directory, format, records, source, journal.source()->origin};
  PublishedTile root_tile = read_root(published, context);
  Outline lines = outline.outline;
  lines.first_view = root_tile.first_view;
  const std::vector<std::byte> outline_file = storage::encode_outline(lines, format.frame);
  storage::write_file(files, storage::outline_path(directory), outline_file);

  std::optional<MadePreview> preview;
  if (context.config.preview) {
    preview = make_preview(published, std::move(root_tile), context);
    storage::write_file(files, storage::preview_path(directory), preview->file);
  }

  storage::Manifest manifest = begin_manifest(source, journal.source()->origin, format, context);
  manifest.first_view = lines.first_view;
  manifest.view = context.config.view;
  manifest.quantization = quantization;
  manifest.index_bytes = index.size();
  manifest.index_checksum = storage::checksum(index);
  manifest.outline_bytes = outline_file.size();
  manifest.outline_checksum = storage::checksum(outline_file);
  manifest.outline = outline.report;
  manifest.objects = known_objects;
  if (manifest.objects)
    manifest.objects->are_in_tiles = format.objects.has_value();
  if (preview)
    manifest.preview = preview->facts;
  add_tiles(manifest, tree, records,
            index.size() + outline_file.size() + (preview ? preview->file.size() : 0) +
                storage::object_file_bytes(known_objects));
  storage::write_tilesets(files, directory, tree, records, manifest);
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(files, storage::manifest_path(directory), std::as_bytes(std::span(text)));
}

}  // namespace meshhier::pipeline
