#include "storage/manifest.h"

#include "hierarchy/error.h"
#include "storage/glb.h"
#include "storage/hash.h"
#include "storage/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "meshhier";

/// In the order of ColourType.
constexpr std::array<std::string_view, 4> kColourTypes{"none", "u8", "u16", "f32"};

// The text ends with these three pieces, the middle one being 16 hexadecimal digits: the XXH3-64 of
// the whole text with zeros in their place.
constexpr std::string_view kBeforeChecksum = ",\n  \"checksum\": \"";
constexpr std::string_view kAfterChecksum = "\"\n}\n";
constexpr std::size_t kDigits = 16;
constexpr std::string_view kZeros = "0000000000000000";

/// About 40 levels of 300 bytes, a config and 30 more lines make 20 kB.
constexpr std::size_t kMaxTextBytes = 1024 * 1024;

std::string hex(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

std::uint64_t text_checksum(const std::string& text) {
  return checksum(std::as_bytes(std::span(text)));
}

Json numbers(Vec3d v) {
  return Json::array({v.x, v.y, v.z});
}

// ---- writing -------------------------------------------------------------------------------

Json attributes_json(const AttributeLayout& attributes) {
  return {{"normals", attributes.normals},
          {"colours", kColourTypes[static_cast<std::size_t>(attributes.colour)]},
          {"alpha", attributes.alpha},
          {"texcoords", attributes.texcoords}};
}

Json storage_json(const Manifest& manifest) {
  Json storage = {{"compression", name_of(manifest.compression)}, {"positions", nullptr}};
  if (const auto& quantization = manifest.quantization) {
    storage["positions"] = {{"bits", quantization->lattice.bits},
                            {"step", quantization->lattice.step},
                            {"corner", numbers(quantization->lattice.corner)},
                            {"worst_rounding", quantization->worst_rounding}};
  }
  return storage;
}

Json import_json(const SourceSummary& source) {
  Json files = Json::array();
  for (const SourceFile& file : source.files) {
    files.push_back({{"name", file.name},
                     {"format", file.format},
                     {"bytes", file.bytes},
                     {"checksum", hex(file.checksum)}});
  }
  Json counts = Json::object();
  for (const SourceCount& count : source.counts)
    counts[count.name] = count.count;
  return {{"files", std::move(files)}, {"counts", std::move(counts)}};
}

Json outline_json(const Manifest& manifest) {
  const OutlineReport& outline = manifest.outline;
  return {{"file", outline_path({}).string()},
          {"bytes", manifest.outline_bytes},
          {"checksum", hex(manifest.outline_checksum)},
          {"sector_level", outline.sector_level},
          {"sectors", outline.sector_count},
          {"tolerance", outline.tolerance},
          {"polylines_found", outline.polylines_found},
          {"polylines_dropped", outline.polylines_dropped}};
}

Json manifest_json(const Manifest& manifest) {
  Json document;
  document["format"] = kFormat;
  document["format_version"] = kFormatVersion;
  document["generator"] = manifest.generator;
  document["source"] = source_json(manifest.source);
  document["origin"] = numbers(manifest.origin);
  document["up"] = name_of(manifest.up);
  document["transform"] = manifest.transform ? Json(*manifest.transform) : Json();
  document["licence"] = manifest.licence;
  document["partitions"] = manifest.partition_count;
  document["storage"] = storage_json(manifest);
  document["config"] = manifest.config;
  document["index"] = {{"file", index_path({}).string()},
                       {"bytes", manifest.index_bytes},
                       {"checksum", hex(manifest.index_checksum)}};
  document["outline"] = outline_json(manifest);
  document["tileset"] = {{"file", tileset_path({}).string()},
                         {"files", manifest.tileset_files},
                         {"bytes", manifest.tileset_bytes},
                         {"checksum", hex(manifest.tileset_checksum)}};
  document["levels"] = manifest.levels;
  document["total_bytes"] = manifest.total_bytes;
  document["checksum"] = kZeros;
  return document;
}

// ---- reading -------------------------------------------------------------------------------

/// An object of the document, and where it is.
class Object {
 public:
  Object(const Json& json, std::string path, const std::string& name)
      : json_(json), path_(std::move(path)), name_(name) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

  const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end())
      fail(fmt::format("\"{}{}\" is missing", path_, key));
    return *found;
  }

  Object object(const char* key) const {
    if (!at(key).is_object())
      wrong(key, "an object");
    return {at(key), path_ + key + ".", name_};
  }

  bool has(const char* key) const { return json_.contains(key); }

  std::vector<Object> objects(const char* key) const {
    if (!at(key).is_array())
      wrong(key, "an array");
    std::vector<Object> all;
    for (const Json& item : at(key)) {
      if (!item.is_object())
        wrong(key, "an array of objects");
      all.emplace_back(item, path_ + key + ".", name_);
    }
    return all;
  }

  std::vector<std::string> keys() const {
    std::vector<std::string> all;
    for (const auto& item : json_.items())
      all.push_back(item.key());
    return all;
  }

  std::uint64_t count(const char* key, std::uint64_t max = UINT64_MAX) const {
    const Json& value = at(key);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max) {
      wrong(key, fmt::format("an integer from 0 to {}", max));
    }
    return value.get<std::uint64_t>();
  }

  std::uint32_t short_count(const char* key) const {
    return static_cast<std::uint32_t>(count(key, UINT32_MAX));
  }

  bool boolean(const char* key) const {
    if (!at(key).is_boolean())
      wrong(key, "true or false");
    return at(key).get<bool>();
  }

  std::string text(const char* key) const {
    if (!at(key).is_string())
      wrong(key, "a text");
    return at(key).get<std::string>();
  }

  double number(const char* key) const {
    const auto value = finite(at(key));
    if (!value)
      wrong(key, "a number");
    return *value;
  }

  Vec3d point(const char* key) const {
    const Json& value = at(key);
    if (!value.is_array() || value.size() != 3)
      wrong(key, "three numbers");
    const auto x = finite(value[0]);
    const auto y = finite(value[1]);
    const auto z = finite(value[2]);
    if (!x || !y || !z)
      wrong(key, "three numbers");
    return {*x, *y, *z};
  }

  std::optional<Transform> transform_or_null(const char* key) const {
    const Json& value = at(key);
    if (value.is_null())
      return std::nullopt;
    Transform transform{};
    bool fits = value.is_array() && value.size() == transform.size();
    for (std::size_t i = 0; fits && i < transform.size(); ++i) {
      const auto number = finite(value[i]);
      fits = number.has_value();
      transform[i] = number.value_or(0);
    }
    if (!fits)
      wrong(key, "null or 16 numbers");
    return transform;
  }

  std::uint64_t hash(const char* key) const {
    const std::string digits = text(key);
    const bool fits = digits.size() == kDigits &&
                      digits.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (!fits)
      wrong(key, "16 hexadecimal digits");
    return std::stoull(digits, nullptr, 16);
  }

  [[noreturn]] void wrong(const char* key, const std::string& expected) const {
    fail(fmt::format("\"{}{}\" is wrong, expected {}", path_, key, expected));
  }

 private:
  static std::optional<double> finite(const Json& value) {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      return std::nullopt;
    return value.get<double>();
  }

  const Json& json_;
  std::string path_;
  const std::string& name_;
};

Compression read_compression(const Object& object) {
  const std::string name = object.text("compression");
  const auto found = std::find(kCompressionNames.begin(), kCompressionNames.end(), name);
  if (found == kCompressionNames.end())
    object.wrong("compression", fmt::format("one of {}", fmt::join(kCompressionNames, ", ")));
  return static_cast<Compression>(found - kCompressionNames.begin());
}

std::optional<Quantization> read_quantization(const Object& object) {
  if (object.at("positions").is_null())
    return std::nullopt;
  const Object positions = object.object("positions");
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

AttributeLayout read_attributes(const Object& object) {
  AttributeLayout attributes;
  attributes.normals = object.boolean("normals");
  attributes.alpha = object.boolean("alpha");
  attributes.texcoords = object.boolean("texcoords");
  const std::string colours = object.text("colours");
  for (std::size_t i = 0; i < kColourTypes.size(); ++i) {
    if (colours != kColourTypes[i])
      continue;
    attributes.colour = static_cast<ColourType>(i);
    return attributes;
  }
  object.wrong("colours", "none, u8, u16 or f32");
}

void read_import(const Object& object, SourceSummary& source) {
  for (const Object& file : object.objects("files"))
    source.files.push_back(
        {file.text("name"), file.text("format"), file.count("bytes"), file.hash("checksum")});
  if (source.files.empty())
    object.wrong("files", "at least one");
  const Object counts = object.object("counts");
  for (const std::string& name : counts.keys())
    source.counts.push_back({name, counts.count(name.c_str())});
}

SourceSummary read_source(const Object& object) {
  SourceSummary source;
  source.file_name = object.text("file_name");
  source.file_bytes = object.count("file_bytes");
  source.checksum = object.hash("checksum");
  source.vertices = object.count("vertices", UINT32_MAX);
  if (source.vertices == 0)
    object.wrong("vertices", "at least 1");
  source.triangles = object.count("triangles");
  source.faces = object.count("faces");
  source.degenerate_triangles = object.count("degenerate_triangles");
  source.unreferenced_vertices = object.count("unreferenced_vertices", source.vertices);
  const Object bounds = object.object("bounds");
  source.bounds = {bounds.point("min"), bounds.point("max")};
  const Vec3d size = source.bounds.max - source.bounds.min;
  if (!(size.x >= 0 && size.y >= 0 && size.z >= 0))
    object.wrong("bounds", "min <= max");
  source.double_precision = object.boolean("double_precision");
  source.attributes = read_attributes(object.object("attributes"));
  if (object.has("import"))
    read_import(object.object("import"), source);
  return source;
}

void read_outline(const Object& object, Manifest& manifest) {
  manifest.outline_bytes = object.count("bytes");
  manifest.outline_checksum = object.hash("checksum");
  manifest.outline.sector_level = object.short_count("sector_level");
  manifest.outline.sector_count = object.short_count("sectors");
  manifest.outline.tolerance = object.number("tolerance");
  manifest.outline.polylines_found = object.count("polylines_found");
  manifest.outline.polylines_dropped = object.count("polylines_dropped");
}

UpAxis read_up(const Object& object) {
  const std::string up = object.text("up");
  if (up != "y" && up != "z")
    object.wrong("up", "\"y\" or \"z\"");
  return up == "z" ? UpAxis::z : UpAxis::y;
}

/// Told before anything else is asked of the document: a newer format may differ in all the rest.
void check_version(const Object& object) {
  if (object.text("format") != kFormat)
    object.wrong("format", fmt::format("\"{}\"", kFormat));
  const std::uint64_t version = object.count("format_version");
  if (version > kFormatVersion) {
    object.fail(
        fmt::format("format version {} is newer than {}, the newest known: use a newer "
                    "meshhier",
                    version, kFormatVersion));
  }
  if (version != kFormatVersion) {
    object.fail(fmt::format("format version is {}, expected {}", version, kFormatVersion));
  }
}

void check_text(const std::string& text, const Object& object) {
  const std::size_t tail = kBeforeChecksum.size() + kDigits + kAfterChecksum.size();
  const std::uint64_t expected = object.hash("checksum");
  const bool ends = text.size() >= tail && text.ends_with(kAfterChecksum) &&
                    text.compare(text.size() - tail, kBeforeChecksum.size(), kBeforeChecksum) == 0;
  if (!ends)
    object.fail("does not end with its checksum: the file was changed");
  std::string zeroed = text;
  zeroed.replace(text.size() - kAfterChecksum.size() - kDigits, kDigits, kZeros);
  if (text_checksum(zeroed) != expected) {
    object.fail(fmt::format("checksum is {}, expected {}: the file was changed",
                            hex(text_checksum(zeroed)), hex(expected)));
  }
}

}  // namespace

Json source_json(const SourceSummary& source) {
  Json json{{"file_name", source.file_name},
            {"file_bytes", source.file_bytes},
            {"checksum", hex(source.checksum)},
            {"vertices", source.vertices},
            {"triangles", source.triangles},
            {"faces", source.faces},
            {"degenerate_triangles", source.degenerate_triangles},
            {"unreferenced_vertices", source.unreferenced_vertices},
            {"bounds", {{"min", numbers(source.bounds.min)}, {"max", numbers(source.bounds.max)}}},
            {"double_precision", source.double_precision},
            {"attributes", attributes_json(source.attributes)}};
  if (!source.files.empty())
    json["import"] = import_json(source);
  return json;
}

SourceSummary parse_source(const Json& source, const std::string& name) {
  return read_source(Object(source, "", name));
}

std::string to_json_text(const Manifest& manifest) {
  // A file name need not be UTF-8, JSON must be.
  std::string text = manifest_json(manifest).dump(2, ' ', false, Json::error_handler_t::replace);
  text += '\n';
  const std::uint64_t sum = text_checksum(text);
  text.replace(text.size() - kAfterChecksum.size() - kDigits, kDigits, hex(sum));
  return text;
}

Manifest parse_manifest(const std::string& text, const std::string& name) {
  if (text.size() > kMaxTextBytes) {
    throw Error(ErrorCode::corrupt, fmt::format("{}: has {} bytes, expected at most {}", name,
                                                text.size(), kMaxTextBytes));
  }
  const Json document = parse_json(text, name);
  const Object object(document, "", name);
  if (!document.is_object())
    object.fail("is not a JSON object");
  check_version(object);
  check_text(text, object);

  Manifest manifest;
  manifest.generator = object.text("generator");
  manifest.source = read_source(object.object("source"));
  manifest.origin = object.point("origin");
  manifest.up = read_up(object);
  manifest.transform = object.transform_or_null("transform");
  manifest.licence = object.text("licence");
  manifest.partition_count =
      static_cast<std::uint32_t>(object.count("partitions", manifest.source.vertices));
  if (manifest.partition_count == 0)
    object.wrong("partitions", "at least 1");
  manifest.compression = read_compression(object.object("storage"));
  manifest.quantization = read_quantization(object.object("storage"));
  manifest.config = object.at("config");
  if (!manifest.config.is_object())
    object.wrong("config", "an object");
  manifest.index_bytes = object.object("index").count("bytes");
  manifest.index_checksum = object.object("index").hash("checksum");
  read_outline(object.object("outline"), manifest);
  const Object tileset = object.object("tileset");
  manifest.tileset_files = tileset.count("files");
  manifest.tileset_bytes = tileset.count("bytes");
  manifest.tileset_checksum = tileset.hash("checksum");
  manifest.levels = object.at("levels");
  if (!manifest.levels.is_array())
    object.wrong("levels", "an array");
  manifest.total_bytes = object.count("total_bytes");
  return manifest;
}

}  // namespace meshhier::storage
