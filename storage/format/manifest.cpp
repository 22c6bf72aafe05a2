#include "storage/format/manifest.h"

#include "base/error.h"
#include "base/named_value.h"
#include "base/plain_text.h"
#include "hierarchy/target_vertex_counts.h"
#include "storage/format/layout.h"
#include "storage/format/object_facts.h"
#include "storage/format/sealed_json.h"
#include "storage/format/source_values.h"
#include "storage/format/view_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

constexpr SealedFormat kFormat{.name = "meshhier",
                               .version = kFormatVersion,
                               .way_out = "build it again from the mesh",
                               .older_versions = kFormatVersion - kOldestFormatVersion};

constexpr const char* kComputedNormals = "computed";

// ---- writing -------------------------------------------------------------------------------

Json texture_storage_json(const TextureFormat& textures) {
  return {{"format", row_of(textures.format).name},
          {"quality", textures.quality},
          {"unlit", textures.unlit}};
}

Json storage_json(const Manifest& manifest) {
  Json storage = {{"compression", row_of(manifest.compression).name}, {"positions", nullptr}};
  if (const auto& quantization = manifest.quantization) {
    storage["positions"] = {{"bits", quantization->lattice.bits},
                            {"step", quantization->lattice.step},
                            {"corner", point_json(quantization->lattice.corner)},
                            {"worst_rounding", quantization->worst_rounding}};
  }
  if (manifest.computed_normals)
    storage["normals"] = kComputedNormals;
  if (manifest.normal_maps) {
    storage["normal_map"] = {{"format", row_of(manifest.normal_maps->format).name},
                             {"quality", manifest.normal_maps->quality}};
  }
  if (manifest.textures)
    storage["texture"] = texture_storage_json(*manifest.textures);
  return storage;
}

Json source_textures_json(const SourceTextures& textures) {
  return {{"materials", textures.materials},
          {"images", textures.images},
          {"missing_images", textures.missing_images},
          {"texels", textures.texels}};
}

Json counts_json(const std::vector<SourceCount>& counts) {
  Json json = Json::object();
  for (const SourceCount& count : counts)
    json[count.name] = count.count;
  return json;
}

Json import_json(const SourceSummary& source) {
  Json files = Json::array();
  for (const SourceFile& file : source.files) {
    files.push_back({{"name", file.name},
                     {"format", file.format},
                     {"bytes", file.bytes},
                     {"checksum", hex_digits(file.checksum)}});
  }
  return {{"files", std::move(files)}, {"counts", counts_json(source.counts)}};
}

Json outline_json(const Manifest& manifest) {
  const OutlineReport& outline = manifest.outline;
  return {{"file", outline_path({}).string()},
          {"bytes", manifest.outline_bytes},
          {"checksum", hex_digits(manifest.outline_checksum)},
          {"sector_level", outline.sector_level},
          {"sectors", outline.sector_count},
          {"tolerance", outline.tolerance},
          {"polylines_found", outline.polylines_found},
          {"polylines_dropped", outline.polylines_dropped}};
}

Json preview_json(const Preview& preview) {
  return {{"file", preview_path({}).string()},
          {"bytes", preview.bytes},
          {"checksum", hex_digits(preview.checksum)},
          {"width", preview.width},
          {"height", preview.height}};
}

Json objects_json(const ObjectsSummary& objects) {
  Json json = object_facts_json(objects.table);
  json["shown"] = objects.shown;
  json["in_tiles"] = objects.are_in_tiles;
  if (objects.words)
    json["words"] = object_facts_json(*objects.words, object_words_path({}));
  return json;
}

Json tileset_json(const Manifest& manifest) {
  Json tileset = {{"file", tileset_path({}).string()},
                  {"files", manifest.tileset_files},
                  {"bytes", manifest.tileset_bytes},
                  {"checksum", hex_digits(manifest.tileset_checksum)}};
  if (manifest.tileset_pixels)
    tileset["pixels"] = *manifest.tileset_pixels;
  return tileset;
}

Json standpoint_json(const Standpoint& view) {
  return {{"azimuth", view.azimuth}, {"elevation", view.elevation}};
}

Json manifest_json(const Manifest& manifest) {
  Json document;
  document["generator"] = manifest.generator;
  document["source"] = source_json(manifest.source);
  document["origin"] = point_json(manifest.origin);
  document["up"] = name_of(manifest.up);
  if (manifest.units)
    document["units"] = name_of(*manifest.units);
  if (manifest.first_view)
    document["first_view"] = standpoint_json(*manifest.first_view);
  if (!manifest.view.empty())
    document["view"] = storage::view_json(manifest.view);
  document["transform"] = manifest.transform ? Json(*manifest.transform) : Json();
  document["licence"] = manifest.licence;
  document["partitions"] = manifest.partition_count;
  document["storage"] = storage_json(manifest);
  document["config"] = manifest.config;
  document["index"] = {{"file", index_path({}).string()},
                       {"bytes", manifest.index_bytes},
                       {"checksum", hex_digits(manifest.index_checksum)}};
  document["outline"] = outline_json(manifest);
  if (manifest.preview)
    document["preview"] = preview_json(*manifest.preview);
  if (manifest.objects)
    document["objects"] = objects_json(*manifest.objects);
  document["tileset"] = tileset_json(manifest);
  document["levels"] = manifest.levels;
  document["total_bytes"] = manifest.total_bytes;
  return document;
}

// ---- reading -------------------------------------------------------------------------------

/// Returns the value of a table whose name stands at `key`.
template <class Table>
auto read_named(const JsonObject& object, const char* key, const Table& table) {
  const auto value = value_named(table, object.text(key));
  if (!value)
    object.wrong(key, "one of " + names_in(table));
  return *value;
}

std::optional<Quantization> read_quantization(const JsonObject& object) {
  if (object.at("positions").is_null())
    return std::nullopt;
  const JsonObject positions = object.object("positions");
  Quantization quantization;
  quantization.lattice.bits = static_cast<int>(positions.count("bits", Lattice::kMostBits));
  quantization.lattice.step = positions.number("step");
  quantization.lattice.corner = positions.point("corner");
  quantization.worst_rounding = positions.number("worst_rounding");
  if (!quantization.lattice.is_sound())
    object.wrong("positions", "a lattice of 8 to 24 bits, its step a power of two");
  if (quantization.worst_rounding < 0)
    positions.wrong("worst_rounding", "at least 0");
  return quantization;
}

/// `source`: attributes of the input.
bool read_computed_normals(const JsonObject& object, const AttributeLayout& source) {
  if (!object.has("normals"))
    return false;
  if (object.text("normals") != kComputedNormals)
    object.wrong("normals", fmt::format("\"{}\", or no such key", kComputedNormals));
  if (source.normals)
    object.wrong("normals", "no such key, as the source has normals");
  return true;
}

/// Reads how pictures or normal maps are stored.
template <class Format>
Format read_picture_format(const JsonObject& object) {
  Format format;
  format.format = read_named(object, "format", kImageFormats);
  format.quality = static_cast<int>(object.count("quality", kBestQuality));
  if (format.quality == 0)
    object.wrong("quality", "at least 1");
  return format;
}

/// Reads the format of pictures, which must be there if and only if the source has textures.
std::optional<TextureFormat> read_textures(const JsonObject& object, const SourceSummary& source) {
  if (object.has("texture") != source.textures.has_value())
    object.wrong("texture", "to be there if and only if \"source.textures\" is");
  if (!source.textures)
    return std::nullopt;
  const JsonObject texture = object.object("texture");
  auto textures = read_picture_format<TextureFormat>(texture);
  textures.unlit = texture.boolean("unlit");
  return textures;
}

std::optional<NormalMapFormat> read_normal_maps(const JsonObject& object) {
  if (!object.has("normal_map"))
    return std::nullopt;
  return read_picture_format<NormalMapFormat>(object.object("normal_map"));
}

SourceTextures read_source_textures(const JsonObject& object) {
  SourceTextures textures;
  textures.materials = object.count("materials");
  textures.images = object.count("images");
  textures.missing_images = object.count("missing_images", textures.images);
  textures.texels = object.count("texels");
  return textures;
}

std::vector<SourceCount> read_counts(const JsonObject& object) {
  std::vector<SourceCount> counts;
  for (const std::string& name : object.keys())
    counts.push_back({name, object.count(name.c_str())});
  return counts;
}

void read_import(const JsonObject& object, SourceSummary& source) {
  for (const JsonObject& file : object.objects("files"))
    source.files.push_back(
        {file.text("name"), file.text("format"), file.count("bytes"), file.hash("checksum")});
  if (source.files.empty())
    object.wrong("files", "at least one");
  source.counts = read_counts(object.object("counts"));
}

std::optional<Unit> read_units(const JsonObject& object) {
  if (!object.has("units"))
    return std::nullopt;
  return read_named(object, "units", kUnits);
}

SourceSummary read_source(const JsonObject& object) {
  SourceSummary source;
  source.file_name = object.text("file_name");
  source.file_bytes = object.count("file_bytes");
  source.checksum = object.hash("checksum");
  source.vertices = object.count("vertices", UINT32_MAX);
  if (source.vertices == 0)
    object.wrong("vertices", "at least 1");
  source.places = object.count("places", source.vertices);
  if (source.places == 0)
    object.wrong("places", "at least 1");
  source.triangles = object.count("triangles");
  source.faces = object.count("faces");
  source.degenerate_triangles = object.count("degenerate_triangles");
  source.unreferenced_vertices = object.count("unreferenced_vertices", source.vertices);
  const JsonObject bounds = object.object("bounds");
  source.bounds = {bounds.point("min"), bounds.point("max")};
  const Vec3d size = source.bounds.max - source.bounds.min;
  if (!(size.x >= 0 && size.y >= 0 && size.z >= 0))
    object.wrong("bounds", "min <= max");
  source.double_precision = object.boolean("double_precision");
  source.units = read_units(object);
  source.attributes = object.attributes("attributes");
  if (object.has("values"))
    read_source_values(object, source);
  if (object.has("textures"))
    source.textures = read_source_textures(object.object("textures"));
  if (source.textures && source.attributes.texcoords)
    object.wrong("attributes", "no texture coordinates beside textures");
  if (object.has("import"))
    read_import(object.object("import"), source);
  else if (object.has("counts"))
    source.counts = read_counts(object.object("counts"));
  if (object.has("unused"))
    source.unused = object.texts("unused");
  return source;
}

void read_outline(const JsonObject& object, Manifest& manifest) {
  manifest.outline_bytes = object.count("bytes");
  manifest.outline_checksum = object.hash("checksum");
  manifest.outline.sector_level = object.short_count("sector_level");
  manifest.outline.sector_count = object.short_count("sectors");
  manifest.outline.tolerance = object.number("tolerance");
  manifest.outline.polylines_found = object.count("polylines_found");
  manifest.outline.polylines_dropped = object.count("polylines_dropped");
}

std::optional<Standpoint> read_view(const JsonObject& object) {
  if (object.count("format_version") == kOldestFormatVersion)
    return std::nullopt;
  const JsonObject view = object.object("first_view");
  const Standpoint found{view.number("azimuth"), view.number("elevation")};
  if (!found.is_sound())
    object.wrong("first_view", "an azimuth and an elevation in degrees");
  return found;
}

ModelView read_model_view(const JsonObject& object) {
  if (!object.has("view"))
    return {};
  const auto read = parse_view(object.at("view"));
  if (const auto* problem = std::get_if<ViewProblem>(&read)) {
    if (problem->key.empty())
      object.wrong("view", problem->expected);
    object.object("view").wrong(plain_text(problem->key, kMostNameBytes).c_str(),
                                problem->expected);
  }
  return std::get<ModelView>(read);
}

void read_tileset(const JsonObject& object, std::uint64_t version, Manifest& manifest) {
  manifest.tileset_files = object.count("files");
  manifest.tileset_bytes = object.count("bytes");
  manifest.tileset_checksum = object.hash("checksum");
  if (version <= kTrueErrorsFormatVersion)
    return;
  manifest.tileset_pixels = object.number("pixels");
  if (!(*manifest.tileset_pixels >= kFewestTilesetPixels &&
        *manifest.tileset_pixels <= kMostTilesetPixels))
    object.wrong("pixels", fmt::format("{} to {}", kFewestTilesetPixels, kMostTilesetPixels));
}

/// Throws if the version does not follow from the content; of 12 and later ones one thing decides.
void check_version(std::uint64_t version, const Manifest& manifest, const JsonObject& object) {
  if ((version == kFormatVersion) != manifest.objects.has_value())
    object.wrong("format_version", "14 if and only if there are objects");
  if (version < kFormatVersion && (version == kNoObjectsFormatVersion) != manifest.has_relief())
    object.wrong("format_version",
                 "13 if and only if there are pictures and normal maps, and no objects");
  if (version > kTrueErrorsFormatVersion)
    return;
  if (version < kNoKtx2FormatVersion &&
      (version > kNoValuesFormatVersion) != !manifest.source.attributes.values.empty())
    object.wrong("format_version", "9 if and only if there are values, no normal maps and no KTX2");
  if ((version == kTrueErrorsFormatVersion) != manifest.has_ktx2())
    object.wrong("format_version", "11 if and only if pictures or normal maps are KTX2");
  if (version < kTrueErrorsFormatVersion &&
      (version == kNoKtx2FormatVersion) != manifest.normal_maps.has_value())
    object.wrong("format_version", "10 if and only if there are normal maps, none of them KTX2");
}

bool has_object(const SourceSummary& source) {
  return std::ranges::any_of(source.attributes.values, &ScalarAttribute::is_object);
}

std::optional<ObjectsSummary> read_objects_summary(const JsonObject& object,
                                                   const SourceSummary& source) {
  if (object.has("objects") != has_object(source))
    object.wrong("objects", "to be there if and only if a value of the source is of kind object");
  if (!object.has("objects"))
    return std::nullopt;
  const JsonObject objects = object.object("objects");
  ObjectsSummary summary{read_object_facts(objects), {}, objects.boolean("in_tiles")};
  const Json& shown = objects.at("shown");
  const bool is_sound =
      shown.is_array() && shown.size() <= TargetVertexCounts::kMostLevels + 1 &&
      std::all_of(shown.begin(), shown.end(), [&](const Json& count) {
        return count.is_number_unsigned() && count.get<std::uint64_t>() <= summary.table.objects;
      });
  if (!is_sound)
    objects.wrong("shown", "a count of objects for each level");
  summary.shown = shown.get<std::vector<std::uint64_t>>();
  if (objects.has("words"))
    summary.words = read_object_facts(objects.object("words"), object_words_path({}));
  return summary;
}

std::uint32_t read_side(const JsonObject& object, const char* key) {
  const std::uint64_t side = object.count(key, kMostPreviewSide);
  if (side == 0)
    object.wrong(key, "at least 1");
  return static_cast<std::uint32_t>(side);
}

std::optional<Preview> read_preview(const JsonObject& object) {
  if (!object.has("preview"))
    return std::nullopt;
  const JsonObject preview = object.object("preview");
  return Preview{read_side(preview, "width"), read_side(preview, "height"),
                 preview.count("bytes", kMostPreviewBytes), preview.hash("checksum")};
}

}  // namespace

std::optional<Transform> Manifest::root_transform() const {
  std::optional<Transform> root = transform;
  if (!root && units && *units != Unit::m)
    root = scaled(kIdentity, metres_of(*units));
  const Vec3d shift = to_z_up(origin - tile_frame().origin, up);
  if (shift == Vec3d{})
    return root;
  Transform moved = root.value_or(kIdentity);
  for (std::size_t i = 0; i < 3; ++i)
    moved[12 + i] += moved[i] * shift.x + moved[4 + i] * shift.y + moved[8 + i] * shift.z;
  return moved;
}

Json source_json(const SourceSummary& source) {
  Json json{
      {"file_name", source.file_name},
      {"file_bytes", source.file_bytes},
      {"checksum", hex_digits(source.checksum)},
      {"vertices", source.vertices},
      {"places", source.places},
      {"triangles", source.triangles},
      {"faces", source.faces},
      {"degenerate_triangles", source.degenerate_triangles},
      {"unreferenced_vertices", source.unreferenced_vertices},
      {"bounds", {{"min", point_json(source.bounds.min)}, {"max", point_json(source.bounds.max)}}},
      {"double_precision", source.double_precision},
      {"attributes", attributes_json(source.attributes)}};
  if (!source.attributes.values.empty())
    json["values"] = source_values_json(source);
  if (source.textures)
    json["textures"] = source_textures_json(*source.textures);
  if (!source.files.empty())
    json["import"] = import_json(source);
  else if (!source.counts.empty())
    json["counts"] = counts_json(source.counts);
  if (source.units)
    json["units"] = name_of(*source.units);
  if (!source.unused.empty())
    json["unused"] = source.unused;
  return json;
}

SourceSummary parse_source(const Json& source, const std::string& name) {
  if (!source.is_object())
    throw Error(ErrorCode::corrupt, name + ": \"source\" is wrong, expected an object");
  return read_source(JsonObject(source, "source.", name));
}

std::string to_json_text(const Manifest& manifest) {
  SealedFormat format = kFormat;
  format.version = manifest.format_version();
  return sealed_text(format, manifest_json(manifest));
}

Manifest parse_manifest(const std::string& text, const std::string& name) {
  const Json document = parse_sealed(text, kFormat, name);
  const JsonObject object(document, "", name);

  Manifest manifest;
  manifest.generator = object.text("generator");
  manifest.source = read_source(object.object("source"));
  manifest.origin = object.point("origin");
  manifest.up = object.up("up");
  manifest.units = read_units(object);
  manifest.first_view = read_view(object);
  manifest.view = read_model_view(object);
  const std::uint64_t version = object.count("format_version");
  manifest.screen_colours = version <= kScreenColoursFormatVersion;
  manifest.transform = object.transform_or_null("transform");
  manifest.licence = object.text("licence");
  manifest.partition_count =
      static_cast<std::uint32_t>(object.count("partitions", manifest.source.places));
  if (manifest.partition_count == 0)
    object.wrong("partitions", "at least 1");
  if (!manifest.first_view && manifest.partition_count > kTilesADirectory) {
    object.wrong("partitions", fmt::format("at most {} in format version {}: build it again",
                                           kTilesADirectory, kOldestFormatVersion));
  }
  const JsonObject storage = object.object("storage");
  manifest.compression = read_named(storage, "compression", kCompressions);
  manifest.quantization = read_quantization(storage);
  manifest.computed_normals = read_computed_normals(storage, manifest.source.attributes);
  manifest.textures = read_textures(storage, manifest.source);
  manifest.normal_maps = read_normal_maps(storage);
  manifest.objects = read_objects_summary(object, manifest.source);
  check_version(version, manifest, object);
  manifest.config = object.at("config");
  if (!manifest.config.is_object())
    object.wrong("config", "an object");
  manifest.index_bytes = object.object("index").count("bytes");
  manifest.index_checksum = object.object("index").hash("checksum");
  read_outline(object.object("outline"), manifest);
  manifest.preview = read_preview(object);
  read_tileset(object.object("tileset"), version, manifest);
  manifest.levels = object.at("levels");
  if (!manifest.levels.is_array())
    object.wrong("levels", "an array");
  manifest.total_bytes = object.count("total_bytes");
  return manifest;
}

}  // namespace meshhier::storage
