#include "hierarchy/attributes.h"
#include "inspection/inspect.h"
#include "inspection/inspected.h"
#include "storage/format/level_summary.h"
#include "storage/format/source_values.h"
#include "storage/format/view_keys.h"

#include <cstdint>
#include <optional>
#include <span>

namespace meshhier::inspection {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t tile_bytes(std::span<const storage::LevelSummary> levels) {
  std::uint64_t sum = 0;
  for (const storage::LevelSummary& level : levels)
    sum += level.bytes_total;
  return sum;
}

Json textures_json(const std::optional<SourceTextures>& t) {
  if (!t)
    return nullptr;
  return {{"materials", t->materials},
          {"images", t->images},
          {"missing_images", t->missing_images},
          {"texels", t->texels}};
}

Json source_json(const storage::Manifest& manifest) {
  const SourceSummary& s = manifest.source;
  const auto corner = [](Vec3d p) { return Json::array({p.x, p.y, p.z}); };
  Json files = Json::array();
  for (const SourceFile& file : s.files)
    files.push_back({{"name", file.name}, {"format", file.format}, {"bytes", file.bytes}});
  Json counts = Json::object();
  for (const SourceCount& count : s.counts)
    counts[count.name] = count.count;
  return {{"file_name", s.file_name},
          {"file_bytes", s.file_bytes},
          {"vertices", s.vertices},
          {"places", s.places},
          {"triangles", s.triangles},
          {"faces", s.faces},
          {"degenerate_triangles", s.degenerate_triangles},
          {"unreferenced_vertices", s.unreferenced_vertices},
          {"bounds", {{"min", corner(s.bounds.min)}, {"max", corner(s.bounds.max)}}},
          {"double_precision", s.double_precision},
          {"origin", corner(manifest.origin)},
          {"attributes", attribute_names(s.attributes)},
          {"values", storage::source_values_json(s)},
          {"textures", textures_json(s.textures)},
          {"imported_files", files},
          {"counts", counts},
          {"unused", s.unused}};
}

Json objects_json(const storage::ObjectsSummary& objects) {
  Json properties = Json::array();
  for (const auto& [name, type] : objects.table.properties)
    properties.push_back({{"name", name}, {"type", name_of(type)}});
  return {{"count", objects.table.objects},
          {"bytes", objects.table.bytes},
          {"properties", std::move(properties)},
          {"shown", objects.shown},
          {"in_tiles", objects.are_in_tiles}};
}

Json partitions_json(const storage::LevelSummary& last,
                     const storage::CompactnessSummary& compactness) {
  return {{"count", last.tiles},
          {"vertices_min", last.vertices.min},
          {"vertices_mean", last.vertices.mean},
          {"vertices_max", last.vertices.max},
          {"compactness_count", compactness.count},
          {"compactness_mean", compactness.mean},
          {"compactness_median", compactness.median},
          {"compactness_p95", compactness.p95}};
}

Json storage_json(const storage::Manifest& manifest) {
  Json json = {{"compression", storage::row_of(manifest.compression).name},
               {"positions", nullptr},
               {"normals", normals_of(manifest)},
               {"texture", nullptr}};
  if (const auto& maps = manifest.normal_maps) {
    json["normal_map"] = {{"format", row_of(maps->format).name},
                          {"quality", maps->quality},
                          {"gpu_bytes_a_texel", gpu_bytes(*maps)}};
  }
  if (const auto& textures = manifest.textures) {
    json["texture"] = {{"format", row_of(textures->format).name},
                       {"quality", textures->quality},
                       {"unlit", textures->unlit},
                       {"gpu_bytes_a_texel", gpu_bytes(*textures)}};
  }
  if (const auto& q = manifest.quantization) {
    json["positions"] = {{"bits", q->lattice.bits},
                         {"step", q->lattice.step},
                         {"worst_rounding", q->worst_rounding}};
  }
  return json;
}

Json outline_json(const storage::Manifest& manifest) {
  const OutlineReport& o = manifest.outline;
  return {{"bytes", manifest.outline_bytes},      {"sector_level", o.sector_level},
          {"sector_count", o.sector_count},       {"tolerance", o.tolerance},
          {"polylines_found", o.polylines_found}, {"polylines_dropped", o.polylines_dropped}};
}

Json preview_json(const storage::Manifest& manifest) {
  if (!manifest.preview)
    return nullptr;
  const storage::Preview& p = *manifest.preview;
  return {{"bytes", p.bytes}, {"width", p.width}, {"height", p.height}};
}

Json first_view_json(const storage::Manifest& manifest) {
  if (!manifest.first_view)
    return nullptr;
  const auto& [azimuth, elevation] = *manifest.first_view;
  return {{"azimuth", azimuth}, {"elevation", elevation}};
}

Json tileset_json(const storage::Manifest& manifest) {
  return {{"files", manifest.tileset_files},
          {"bytes", manifest.tileset_bytes},
          {"up", name_of(manifest.up)},
          {"units", manifest.units ? Json(name_of(*manifest.units)) : Json()},
          {"transform", manifest.transform ? Json(*manifest.transform) : Json()},
          {"licence", manifest.licence}};
}

}  // namespace

Json inspect_json(storage::FileSystem& files, const std::filesystem::path& directory,
                  const InspectOptions& options) {
  const Inspected inspected(files, directory, options);
  const storage::HierarchyReader& reader = inspected.reader();
  const storage::Manifest& manifest = reader.manifest();
  const auto levels = inspected.levels();
  Json json = {{"generator", manifest.generator},
               {"source", source_json(manifest)},
               {"parameters", manifest.config},
               {"partitions", partitions_json(levels.back(), inspected.compactness())},
               {"levels", Json::array()},
               {"storage", storage_json(manifest)},
               {"sizes",
                {{"partitions", to_json(inspected.partition_sizes())},
                 {"all", to_json(inspected.all_sizes())}}},
               {"outline", outline_json(manifest)},
               {"preview", preview_json(manifest)},
               {"first_view", first_view_json(manifest)},
               {"tileset", tileset_json(manifest)},
               {"pictures", storage::to_json(inspected.pictures())},
               {"forced_collapses", storage::to_json(inspected.forced_collapses())},
               {"tile_bytes", tile_bytes(levels)},
               {"total_bytes", inspected.bytes_on_disk()}};
  if (!manifest.view.empty())
    json["view"] = storage::view_json(manifest.view);
  if (manifest.objects)
    json["objects"] = objects_json(*manifest.objects);
  for (const storage::LevelSummary& s : levels) {
    if (!options.level || s.level == *options.level)
      json["levels"].push_back(storage::to_json(s));
  }
  if (options.level) {
    json["tiles"] = Json::array();
    for (const auto& record : inspected.records_of(*options.level)) {
      json["tiles"].push_back(storage::to_json(record));
    }
  }
  if (options.node)
    json["tile"] = storage::to_json(reader.record(*options.node));
  return json;
}

}  // namespace meshhier::inspection
