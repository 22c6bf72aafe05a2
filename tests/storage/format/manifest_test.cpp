#include "storage/format/manifest.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/io/hash.h"
#include "tests/support/error_message.h"
#include "tests/support/share.h"

#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using storage::Manifest;
using storage::parse_manifest;
using storage::to_json_text;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::ordered_json;

const char* const kManifestName = "some/hierarchy.json";

Manifest make_manifest() {
  Manifest manifest;
  manifest.generator = "meshhier 0.1.0";
  manifest.source.file_name = "naïve \"scan\".ply";
  manifest.source.file_bytes = 0xFFFFFFFFFFFFFFFF;
  manifest.source.checksum = 0x00000000000000AB;
  manifest.source.vertices = 1000;
  manifest.source.places = 900;
  manifest.source.triangles = 1990;
  manifest.source.faces = 995;
  manifest.source.degenerate_triangles = 3;
  manifest.source.unreferenced_vertices = 4;
  manifest.source.bounds = {{-0.1, 1.0 / 3, -5e-324}, {1e300, 2, 0}};
  manifest.source.double_precision = true;
  manifest.source.attributes = {true, ColourType::u16, true, true};
  manifest.origin = {1234567.891, 0, -0.0};
  manifest.up = UpAxis::z;
  manifest.first_view = Standpoint{-101.25, 90};
  manifest.transform = Transform{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0.1, 1e300, -5, 16};
  manifest.licence = "CC \"BY\"";
  manifest.partition_count = 7;
  manifest.config = {{"simplify", {{"method", "cluster"}, {"vertices", 100}}}};
  manifest.index_bytes = 1176;
  manifest.index_checksum = 0xFEDCBA9876543210;
  manifest.outline_bytes = 2222;
  manifest.outline_checksum = 0x1;
  manifest.outline = {3, 7, 0.004, 55, 6};
  manifest.preview = storage::Preview{512, 511, 39999, 0xABC};
  manifest.tileset_files = 5;
  manifest.tileset_bytes = 4321;
  manifest.tileset_checksum = 0xFFFFFFFFFFFFFFFE;
  manifest.levels = Json::array({{{"level", 0}, {"tiles", 1}}});
  manifest.total_bytes = 987654321;
  return manifest;
}

void expect_same(const Manifest& a, const Manifest& b) {
  EXPECT_EQ(a.compression, b.compression);
  ASSERT_EQ(a.quantization.has_value(), b.quantization.has_value());
  if (a.quantization) {
    EXPECT_EQ(a.quantization->lattice, b.quantization->lattice);
    EXPECT_EQ(a.quantization->worst_rounding, b.quantization->worst_rounding);
  }
  EXPECT_EQ(a.computed_normals, b.computed_normals);
  EXPECT_EQ(a.textures, b.textures);
  EXPECT_EQ(a.source.textures, b.source.textures);
  EXPECT_EQ(a.generator, b.generator);
  EXPECT_EQ(a.source.file_name, b.source.file_name);
  EXPECT_EQ(a.source.file_bytes, b.source.file_bytes);
  EXPECT_EQ(a.source.checksum, b.source.checksum);
  EXPECT_EQ(a.source.vertices, b.source.vertices);
  EXPECT_EQ(a.source.places, b.source.places);
  EXPECT_EQ(a.source.triangles, b.source.triangles);
  EXPECT_EQ(a.source.faces, b.source.faces);
  EXPECT_EQ(a.source.degenerate_triangles, b.source.degenerate_triangles);
  EXPECT_EQ(a.source.unreferenced_vertices, b.source.unreferenced_vertices);
  EXPECT_EQ(a.source.bounds, b.source.bounds);
  EXPECT_EQ(a.source.double_precision, b.source.double_precision);
  EXPECT_EQ(a.source.attributes, b.source.attributes);
  EXPECT_EQ(a.source.values, b.source.values);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.up, b.up);
  EXPECT_EQ(a.first_view, b.first_view);
  EXPECT_EQ(a.screen_colours, b.screen_colours);
  EXPECT_EQ(a.transform, b.transform);
  EXPECT_EQ(a.licence, b.licence);
  EXPECT_EQ(a.tileset_files, b.tileset_files);
  EXPECT_EQ(a.tileset_bytes, b.tileset_bytes);
  EXPECT_EQ(a.tileset_checksum, b.tileset_checksum);
  EXPECT_EQ(a.partition_count, b.partition_count);
  EXPECT_EQ(a.config, b.config);
  EXPECT_EQ(a.index_bytes, b.index_bytes);
  EXPECT_EQ(a.index_checksum, b.index_checksum);
  EXPECT_EQ(a.outline_bytes, b.outline_bytes);
  EXPECT_EQ(a.outline_checksum, b.outline_checksum);
  EXPECT_EQ(a.outline.sector_level, b.outline.sector_level);
  EXPECT_EQ(a.outline.sector_count, b.outline.sector_count);
  EXPECT_EQ(a.outline.tolerance, b.outline.tolerance);
  EXPECT_EQ(a.outline.polylines_found, b.outline.polylines_found);
  EXPECT_EQ(a.outline.polylines_dropped, b.outline.polylines_dropped);
  EXPECT_EQ(a.preview, b.preview);
  EXPECT_EQ(a.levels, b.levels);
  EXPECT_EQ(a.total_bytes, b.total_bytes);
}

std::string failure(const std::string& text) {
  return tests::error_message(
      ErrorCode::corrupt, [&] { parse_manifest(text, kManifestName); }, kManifestName);
}

/// The text of a changed document with the checksum that fits it.
std::string sealed(Json document) {
  document.erase("checksum");
  document["checksum"] = std::string(16, '0');
  std::string text = document.dump(2) + "\n";
  const auto sum = storage::checksum(std::as_bytes(std::span(text)));
  text.replace(text.size() - 20, 16, fmt::format("{:016x}", sum));
  return text;
}

TEST(Manifest, GivesEveryValueBack) {
  const Manifest manifest = make_manifest();
  expect_same(manifest, parse_manifest(to_json_text(manifest), kManifestName));
  EXPECT_EQ(to_json_text(parse_manifest(to_json_text(manifest), kManifestName)),
            to_json_text(manifest));
  Manifest other = manifest;
  for (const ColourType type : {ColourType::none, ColourType::u8, ColourType::f32}) {
    other.source.attributes = {false, type, false, false};
    expect_same(other, parse_manifest(to_json_text(other), kManifestName));
    if (type == ColourType::none)
      continue;
    other.source.attributes.space = ColourSpace::linear;
    expect_same(other, parse_manifest(to_json_text(other), kManifestName));
  }
}

Manifest with_values() {
  Manifest manifest = make_manifest();
  manifest.source.attributes.values = {{"quality", ValueType::f32},
                                       {"class", ValueType::i32, true}};
  manifest.source.values = {
      {.missing = 3,
       .min = -0.5,
       .max = 1.25,
       .bin_exponent = -1,
       .first_bin = -1,
       .bins = {4, 0, 0, 7}},
      {.min = 2, .max = 7, .first_bin = 2, .bins = {1, 0, 0, 0, 0, 9}, .labels = {{2, 1}, {7, 9}}}};
  return manifest;
}

TEST(Manifest, TellsOfValues) {
  const Manifest manifest = with_values();
  EXPECT_EQ(manifest.format_version(), 9);
  EXPECT_EQ(make_manifest().format_version(), 8);
  const std::string text = to_json_text(manifest);
  expect_same(parse_manifest(text, kManifestName), manifest);
  EXPECT_EQ(to_json_text(parse_manifest(text, kManifestName)), text);
}

TEST(Manifest, SANITIZED_UnsoundValuesAreRefused) {
  const Json good = Json::parse(to_json_text(with_values()));
  struct {
    const char* pointer;
    Json value;
  } const damages[] = {{"/source/values/0/name", "two words"},
                       {"/source/values/0/name", "class"},
                       {"/source/values/0/type", "f16"},
                       {"/source/values/0/kind", "name"},
                       {"/source/values/0/missing", -1},
                       {"/source/values/0/min", 2},
                       {"/source/values/0/bin_exponent", 1.5},
                       {"/source/values/0/bin_exponent", 5000},
                       {"/source/values/0/first_bin", "1"},
                       {"/source/values/0/bins", Json::array({-1})},
                       {"/source/values/0/bins", std::vector<int>(65)},
                       {"/source/values/1/labels", Json::array({2})},
                       {"/source/values/1/labels", Json::array({2, "7"})},
                       {"/source/values", 7},
                       {"/format_version", 8}};
  for (const auto& [pointer, value] : damages) {
    Json changed = good;
    changed[Json::json_pointer(pointer)] = value;
    EXPECT_NE(failure(sealed(changed)), "") << pointer << ' ' << value;
  }
  Json without = good;
  without["source"].erase("values");
  EXPECT_THAT(failure(sealed(without)), HasSubstr("format_version"));
  Json many = good;
  for (int i = 0; i < 60; ++i) {
    many["source"]["values"].push_back(good["source"]["values"][0]);
    many["source"]["values"].back()["name"] = "v" + std::to_string(i);
  }
  EXPECT_THAT(failure(sealed(many)), HasSubstr("values"));
}

TEST(Manifest, OneOfVersion6HasNoFirstView) {
  Manifest manifest = make_manifest();
  manifest.first_view.reset();
  manifest.screen_colours = true;
  const std::string text = to_json_text(manifest);
  EXPECT_THAT(text, HasSubstr("\"format_version\": 6,\n"));
  expect_same(manifest, parse_manifest(text, kManifestName));
}

TEST(Manifest, OneOfVersion7HasTilesWithColoursOfAScreen) {
  Manifest manifest = make_manifest();
  manifest.screen_colours = true;
  const std::string text = to_json_text(manifest);
  EXPECT_THAT(text, HasSubstr("\"format_version\": 7,\n"));
  expect_same(manifest, parse_manifest(text, kManifestName));
  EXPECT_THAT(to_json_text(make_manifest()), HasSubstr("\"format_version\": 8,\n"));
}

TEST(Manifest, OneOfVersion6HasItsTilesElsewhereIfThereAreMany) {
  Manifest manifest = make_manifest();
  manifest.source.vertices = manifest.source.places = 100'000;
  manifest.partition_count = storage::kTilesADirectory + 1;
  EXPECT_NO_THROW(parse_manifest(to_json_text(manifest), kManifestName));
  manifest.first_view.reset();
  manifest.screen_colours = true;
  try {
    parse_manifest(to_json_text(manifest), kManifestName);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("at most 10000 in format version 6: build it again"));
  }
}

TEST(Manifest, SANITIZED_UnsoundFirstViewsAreRefused) {
  const auto with = [&](const Json& value) {
    Json changed = Json::parse(to_json_text(make_manifest()));
    changed["first_view"] = value;
    return failure(sealed(changed));
  };
  EXPECT_EQ(with({{"azimuth", -360}, {"elevation", -90}}), "");
  EXPECT_THAT(with(nullptr), HasSubstr("\"first_view\" is wrong"));
  EXPECT_THAT(with({{"azimuth", 1}}), HasSubstr("\"first_view.elevation\" is missing"));
  EXPECT_THAT(with({{"azimuth", 361}, {"elevation", 0}}), HasSubstr("in degrees"));
}

Manifest make_quantized() {
  Manifest manifest = make_manifest();
  manifest.compression = storage::Compression::meshopt_zlib;
  manifest.quantization = storage::Quantization{make_lattice({{-1, 2, 3}, {4, 5, 6}}, 14), 1.0 / 3};
  return manifest;
}

TEST(Manifest, TellsHowTilesAreStored) {
  for (const auto compression : {storage::Compression::none, storage::Compression::zlib,
                                 storage::Compression::meshopt_zlib}) {
    Manifest manifest = make_quantized();
    manifest.compression = compression;
    expect_same(manifest, parse_manifest(to_json_text(manifest), kManifestName));
    manifest.quantization.reset();
    expect_same(manifest, parse_manifest(to_json_text(manifest), kManifestName));
  }
}

TEST(Manifest, SANITIZED_UnsoundStorageIsRefused) {
  const Json good = Json::parse(to_json_text(make_quantized()));
  const auto with = [&](const char* pointer, const Json& value) {
    Json changed = good;
    changed[Json::json_pointer(pointer)] = value;
    return failure(sealed(changed));
  };
  EXPECT_EQ(with("/storage/compression", "zlib"), "");
  EXPECT_THAT(with("/storage/compression", "brotli"), HasSubstr("\"storage.compression\""));
  EXPECT_THAT(with("/storage", nullptr), HasSubstr("\"storage\" is wrong"));
  EXPECT_THAT(with("/storage/positions", 3), HasSubstr("\"storage.positions\""));
  EXPECT_THAT(with("/storage/positions/bits", 25), HasSubstr("\"storage.positions.bits\""));
  EXPECT_THAT(with("/storage/positions/bits", 7), HasSubstr("a lattice of 8 to 24 bits"));
  EXPECT_THAT(with("/storage/positions/step", 0.3), HasSubstr("a lattice of 8 to 24 bits"));
  EXPECT_THAT(with("/storage/positions/corner", Json::array({0, 0, 1e-9})),
              HasSubstr("a lattice of 8 to 24 bits"));
  EXPECT_THAT(with("/storage/positions/worst_rounding", -1), HasSubstr("worst_rounding"));
}

TEST(Manifest, TellsOfComputedNormals) {
  Manifest manifest = make_quantized();
  manifest.source.attributes.normals = false;
  EXPECT_THAT(to_json_text(manifest), Not(HasSubstr("computed")));
  manifest.computed_normals = true;
  EXPECT_THAT(to_json_text(manifest), HasSubstr("\"normals\": \"computed\"\n"));
  expect_same(manifest, parse_manifest(to_json_text(manifest), kManifestName));
}

TEST(Manifest, SANITIZED_UnknownNormalsAreRefused) {
  Manifest manifest = make_quantized();
  manifest.source.attributes.normals = false;
  const auto with = [&](const Json& value) {
    Json changed = Json::parse(to_json_text(manifest));
    changed["storage"]["normals"] = value;
    return failure(sealed(changed));
  };
  EXPECT_EQ(with("computed"), "");
  for (const Json& unknown : {Json("smooth"), Json("none"), Json(true), Json()})
    EXPECT_THAT(with(unknown), HasSubstr("\"storage.normals\" is wrong"));
  manifest.source.attributes.normals = true;
  EXPECT_THAT(with("computed"), HasSubstr("as the source has normals"));
}

Manifest make_textured() {
  Manifest manifest = make_manifest();
  manifest.source.attributes.texcoords = false;
  manifest.source.textures = SourceTextures{5, 4, 1, 1ULL << 40};
  manifest.textures = TextureFormat{ImageFormat::webp, 75, false};
  return manifest;
}

TEST(Manifest, TellsOfTextures) {
  Manifest manifest = make_textured();
  for (const ImageFormat format :
       {ImageFormat::jpeg, ImageFormat::png, ImageFormat::ktx2, ImageFormat::webp}) {
    manifest.textures->format = format;
    manifest.textures->unlit = !manifest.textures->unlit;
    expect_same(manifest, parse_manifest(to_json_text(manifest), kManifestName));
  }
  const Json json = Json::parse(to_json_text(manifest));
  EXPECT_EQ(json["storage"]["texture"].dump(), R"({"format":"webp","quality":75,"unlit":false})");
  EXPECT_EQ(json["source"]["textures"].dump(),
            R"({"materials":5,"images":4,"missing_images":1,"texels":1099511627776})");
  EXPECT_FALSE(Json::parse(to_json_text(make_manifest()))["storage"].contains("texture"));
  EXPECT_FALSE(Json::parse(to_json_text(make_manifest()))["source"].contains("textures"));
}

TEST(Manifest, SANITIZED_UnsoundTexturesAreRefused) {
  const Json good = Json::parse(to_json_text(make_textured()));
  const auto with = [&](const char* pointer, const Json& value) {
    Json changed = good;
    changed[Json::json_pointer(pointer)] = value;
    return failure(sealed(changed));
  };
  EXPECT_EQ(with("/storage/texture/quality", 1), "");
  EXPECT_THAT(with("/storage/texture/quality", 0), HasSubstr("\"storage.texture.quality\""));
  EXPECT_THAT(with("/storage/texture/quality", 101), HasSubstr("\"storage.texture.quality\""));
  EXPECT_THAT(with("/storage/texture/format", "gif"), HasSubstr("one of jpeg, png, webp, ktx2"));
  EXPECT_THAT(with("/storage/texture/unlit", 1), HasSubstr("\"storage.texture.unlit\""));
  EXPECT_THAT(with("/storage/texture", nullptr), HasSubstr("\"storage.texture\" is wrong"));
  EXPECT_THAT(with("/source/textures", nullptr), HasSubstr("\"source.textures\" is wrong"));
  EXPECT_THAT(with("/source/textures/missing_images", 5), HasSubstr("an integer from 0 to 4"));
  EXPECT_THAT(with("/source/attributes/texcoords", true), HasSubstr("\"source.attributes\""));
  for (const char* pointer : {"/storage/texture", "/source/textures"}) {
    Json changed = good;
    const Json::json_pointer place(pointer);
    changed[place.parent_pointer()].erase(place.back());
    EXPECT_THAT(failure(sealed(changed)), HasSubstr("\"storage.texture\" is wrong")) << pointer;
  }
}

TEST(Manifest, GivesBackWhatWasImported) {
  SourceSummary source = make_manifest().source;
  EXPECT_FALSE(storage::source_json(source).contains("import"));
  source.files = {{"a.obj", "OBJ (gzip)", 5, 0xFEDCBA9876543210}, {"b.stl", "binary STL", 84, 0}};
  source.counts = {{"split_vertices", 3}, {"welded_corners", UINT64_MAX}};
  const SourceSummary again = storage::parse_source(storage::source_json(source), kManifestName);
  ASSERT_EQ(again.files.size(), 2U);
  EXPECT_EQ(again.files[0].name, "a.obj");
  EXPECT_EQ(again.files[0].format, "OBJ (gzip)");
  EXPECT_EQ(again.files[0].bytes, 5U);
  EXPECT_EQ(again.files[0].checksum, 0xFEDCBA9876543210);
  ASSERT_EQ(again.counts.size(), 2U);
  EXPECT_EQ(again.counts[1].name, "welded_corners");
  EXPECT_EQ(again.counts[1].count, UINT64_MAX);
}

TEST(Manifest, GivesBackWhatWasCountedInPlace) {
  SourceSummary source = make_manifest().source;
  EXPECT_FALSE(storage::source_json(source).contains("counts"));
  source.counts = {{"normals_made_zero", 3}};
  const Json json = storage::source_json(source);
  EXPECT_FALSE(json.contains("import"));
  const SourceSummary again = storage::parse_source(json, kManifestName);
  EXPECT_THAT(again.files, testing::IsEmpty());
  ASSERT_EQ(again.counts.size(), 1U);
  EXPECT_EQ(again.counts[0].name, "normals_made_zero");
  EXPECT_EQ(again.counts[0].count, 3U);
}

TEST(Manifest, GivesBackUnitsAndWhatIsNotUsed) {
  SourceSummary source = make_manifest().source;
  EXPECT_FALSE(storage::source_json(source).contains("unused"));
  EXPECT_FALSE(storage::source_json(source).contains("units"));
  for (const Unit unit : {Unit::mm, Unit::cm, Unit::m, Unit::km, Unit::in, Unit::ft, Unit::us_ft}) {
    source.units = unit;
    source.unused = {"vertex.intensity", "edge"};
    const SourceSummary again = storage::parse_source(storage::source_json(source), "job.json");
    EXPECT_EQ(again.units, unit);
    EXPECT_EQ(again.unused, source.unused);
    Manifest whole = make_manifest();
    whole.units = unit;
    EXPECT_EQ(parse_manifest(to_json_text(whole), kManifestName).units, unit);
  }
  for (const auto& [key, wrong] :
       {std::pair{"units", Json("furlong")}, std::pair{"units", Json(1)},
        std::pair{"unused", Json("edge")}, std::pair{"unused", Json({1, 2})}}) {
    Json json = storage::source_json(source);
    json[key] = wrong;
    EXPECT_THROW(storage::parse_source(json, "job.json"), Error) << json;
  }
}

TEST(Manifest, SANITIZED_WrongWordsOfAnImportAreNamed) {
  SourceSummary source = make_manifest().source;
  source.files = {{"a.obj", "OBJ", 5, 1}};
  source.counts = {{"groups", 3}};
  const Json good = storage::source_json(source);
  const auto refused = [&](const char* pointer, const Json& value) -> std::string {
    Json json = good;
    json[Json::json_pointer(pointer)] = value;
    return tests::error_message(ErrorCode::corrupt,
                                [&] { storage::parse_source(json, kManifestName); });
  };
  EXPECT_THAT(refused("/import", 1), testing::HasSubstr("\"source.import\" is wrong"));
  EXPECT_THAT(refused("/import/files", 1), testing::HasSubstr("\"source.import.files\" is wrong"));
  EXPECT_THAT(refused("/import/files", Json::array()), testing::HasSubstr("at least one"));
  EXPECT_THAT(refused("/import/files/0", 1),
              testing::HasSubstr("\"source.import.files\" is wrong"));
  EXPECT_THAT(refused("/import/files/0/bytes", -1), testing::HasSubstr("import.files.bytes"));
  EXPECT_THAT(refused("/import/files/0/checksum", "x"),
              testing::HasSubstr("import.files.checksum"));
  EXPECT_THAT(refused("/import/counts", 1),
              testing::HasSubstr("\"source.import.counts\" is wrong"));
  EXPECT_THAT(refused("/import/counts/groups", "x"), testing::HasSubstr("import.counts.groups"));
}

TEST(Manifest, IsReadable) {
  const std::string text = to_json_text(make_manifest());
  EXPECT_THAT(text, StartsWith("{\n  \"format\": \"meshhier\",\n  \"format_version\": 8,\n"));
  EXPECT_THAT(text, HasSubstr("\"checksum\": \"fedcba9876543210\""));
  EXPECT_THAT(text, HasSubstr("\"checksum\": \"00000000000000ab\""));
  EXPECT_THAT(text, HasSubstr("\"colours\": \"u16\""));
  EXPECT_EQ(sealed(Json::parse(text)), text);
}

TEST(Manifest, AFileNameThatIsNotUtf8IsWrittenAsValidJson) {
  Manifest manifest = make_manifest();
  manifest.source.file_name = "scan\xFF.ply";
  const Manifest back = parse_manifest(to_json_text(manifest), kManifestName);
  EXPECT_EQ(back.source.file_name, "scan\xEF\xBF\xBD.ply");
}

TEST(Manifest, SANITIZED_EveryFlippedBitIsFound) {
  std::string text = to_json_text(make_manifest());
  for (std::size_t bit = tests::share().index; bit < 8 * text.size(); bit += tests::share().count) {
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ (1 << bit % 8));
    EXPECT_NE(failure(text), "") << bit;
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ (1 << bit % 8));
  }
}

TEST(Manifest, SANITIZED_TruncationAtEveryByteIsRefused) {
  const std::string text = to_json_text(make_manifest());
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_NE(failure(text.substr(0, size)), "") << size;
  }
  EXPECT_NE(failure(text + " "), "");
}

TEST(Manifest, EveryMissingKeyIsNamed) {
  const Json good = Json::parse(to_json_text(make_manifest()));
  const std::vector<std::string> pointers{"/generator",
                                          "/source",
                                          "/source/vertices",
                                          "/source/places",
                                          "/source/bounds/max",
                                          "/source/attributes/alpha",
                                          "/origin",
                                          "/partitions",
                                          "/config",
                                          "/index",
                                          "/index/checksum",
                                          "/outline",
                                          "/outline/tolerance",
                                          "/preview/height",
                                          "/preview/checksum",
                                          "/levels",
                                          "/total_bytes"};
  for (const std::string& pointer : pointers) {
    Json changed = good;
    const Json::json_pointer place(pointer);
    changed[place.parent_pointer()].erase(place.back());
    std::string key = pointer.substr(1);
    for (char& c : key)
      c = c == '/' ? '.' : c;
    EXPECT_THAT(failure(sealed(changed)), HasSubstr("\"" + key + "\" is missing"));
  }
}

TEST(Manifest, WithoutAPreviewIsThatOfAnOlderHierarchy) {
  Manifest manifest = make_manifest();
  manifest.preview.reset();
  const std::string text = to_json_text(manifest);
  EXPECT_THAT(text, testing::Not(HasSubstr("preview")));
  EXPECT_EQ(parse_manifest(text, kManifestName).preview, std::nullopt);
}

TEST(Manifest, SANITIZED_EveryWrongValueIsNamed) {
  struct Damage {
    const char* pointer;
    Json value;
    const char* message;
  };
  const std::vector<Damage> damages{
      {"/source/vertices", 0, "\"source.vertices\" is wrong, expected at least 1"},
      {"/source/vertices", 4294967296ULL, "\"source.vertices\""},
      {"/source/vertices", -1, "\"source.vertices\""},
      {"/source/vertices", 899, "\"source.places\" is wrong, expected an integer from 0 to 899"},
      {"/source/places", 0, "\"source.places\" is wrong, expected at least 1"},
      {"/source/places", 1001, "\"source.places\" is wrong, expected an integer from 0 to 1000"},
      {"/source/places", "900", "\"source.places\""},
      {"/source/triangles", 1.5, "\"source.triangles\""},
      {"/source/unreferenced_vertices", 1001, "\"source.unreferenced_vertices\""},
      {"/source/checksum", "AB", "16 hexadecimal digits"},
      {"/source/checksum", "00000000000000AB", "16 hexadecimal digits"},
      {"/source/bounds/min", Json::array({1, 2}), "three numbers"},
      {"/source/bounds/min", Json::array({1, 2, 3}), "min <= max"},
      {"/source/attributes/colours", "u32", "one of none, u8, u16, f32"},
      {"/source/double_precision", 1, "true or false"},
      {"/origin", Json::array({1, nullptr, 2}), "\"origin\" is wrong"},
      {"/up", "x", "\"up\" is wrong"},
      {"/transform", Json::array({1, 2}), "\"transform\" is wrong"},
      {"/transform/3", "1", "\"transform\" is wrong"},
      {"/licence", 3, "\"licence\" is wrong"},
      {"/tileset/checksum", "x", "\"tileset.checksum\""},
      {"/partitions", 0, "\"partitions\""},
      {"/partitions", 901, "\"partitions\""},
      {"/config", Json::array(), "\"config\" is wrong, expected an object"},
      {"/outline/tolerance", "x", "\"outline.tolerance\""},
      {"/outline/sectors", 4294967296ULL, "\"outline.sectors\""},
      {"/preview", 3, "\"preview\" is wrong, expected an object"},
      {"/preview/width", 0, "\"preview.width\" is wrong, expected at least 1"},
      {"/preview/width", 513, "\"preview.width\" is wrong, expected an integer from 0 to 512"},
      {"/preview/height", -1, "\"preview.height\""},
      {"/preview/bytes", 40001, "\"preview.bytes\" is wrong, expected an integer from 0 to 40000"},
      {"/preview/checksum", "x", "\"preview.checksum\""},
      {"/levels", 3, "\"levels\" is wrong, expected an array"},
      {"/index", 3, "\"index\" is wrong, expected an object"},
      {"/generator", 3, "\"generator\" is wrong, expected a text"}};
  const Json good = Json::parse(to_json_text(make_manifest()));
  for (const Damage& damage : damages) {
    Json changed = good;
    changed[Json::json_pointer(damage.pointer)] = damage.value;
    EXPECT_THAT(failure(sealed(changed)), HasSubstr(damage.message)) << damage.pointer;
  }
}

TEST(Manifest, NormalMapsAreOfVersionTenAlone) {
  Manifest manifest = make_manifest();
  manifest.source.textures.reset();
  manifest.textures.reset();
  manifest.normal_maps = NormalMapFormat{ImageFormat::webp, 40};
  EXPECT_EQ(manifest.format_version(), 10);
  const std::string text = to_json_text(manifest);
  EXPECT_EQ(parse_manifest(text, "some/hierarchy.json").normal_maps, manifest.normal_maps);
  Json changed = Json::parse(text);
  changed["storage"].erase("normal_map");
  EXPECT_THAT(failure(sealed(changed)), HasSubstr("10 if and only if there are normal maps"));
  changed = Json::parse(text);
  changed["format_version"] = manifest.source.attributes.values.empty() ? 8 : 9;
  EXPECT_THAT(failure(sealed(changed)), HasSubstr("10 if and only if there are normal maps"));
  changed = Json::parse(text);
  changed["storage"]["normal_map"]["quality"] = 0;
  EXPECT_THAT(failure(sealed(changed)), HasSubstr("at least 1"));
}

TEST(Manifest, Ktx2IsOfVersionElevenAlone) {
  Manifest textured = make_textured();
  textured.textures->format = ImageFormat::ktx2;
  Manifest mapped = make_manifest();
  mapped.source.textures.reset();
  mapped.textures.reset();
  mapped.normal_maps = NormalMapFormat{ImageFormat::ktx2, 40};
  for (const Manifest& manifest : {textured, mapped}) {
    EXPECT_EQ(manifest.format_version(), 11);
    expect_same(manifest, parse_manifest(to_json_text(manifest), kManifestName));
    for (const int version : {8, 9, 10}) {
      Json changed = Json::parse(to_json_text(manifest));
      changed["format_version"] = version;
      EXPECT_THAT(failure(sealed(changed)), HasSubstr("\"format_version\" is wrong")) << version;
    }
  }
  Json changed = Json::parse(to_json_text(textured));
  changed["storage"]["texture"]["format"] = "png";
  EXPECT_THAT(failure(sealed(changed)), HasSubstr("11 if and only if pictures or normal maps"));
}

TEST(Manifest, PixelsOfTheTilesetAreOfVersionTwelveAlone) {
  for (Manifest manifest : {make_manifest(), make_textured(), with_values()}) {
    EXPECT_EQ(manifest.tile_frame(), (Frame{manifest.origin, manifest.up}));
    manifest.tileset_pixels = 7.5;
    EXPECT_EQ(manifest.tile_frame(), (Frame{{}, manifest.up})) << "the tileset has the origin";
    EXPECT_EQ(manifest.format_version(), 12);
    const Manifest back = parse_manifest(to_json_text(manifest), kManifestName);
    expect_same(back, manifest);
    EXPECT_EQ(back.tileset_pixels, 7.5);
    for (const Json& wrong : {Json(0), Json(0.5), Json(1001), Json("16"), Json()}) {
      Json changed = Json::parse(to_json_text(manifest));
      changed["tileset"]["pixels"] = wrong;
      EXPECT_THAT(failure(sealed(changed)), HasSubstr("\"tileset.pixels\" is wrong")) << wrong;
    }
    Json changed = Json::parse(to_json_text(manifest));
    changed["tileset"].erase("pixels");
    EXPECT_THAT(failure(sealed(changed)), HasSubstr("\"tileset.pixels\"")) << "is missing";
  }
}

TEST(Manifest, NormalMapsBesidePicturesAreOfVersionThirteenAlone) {
  Manifest manifest = make_textured();
  manifest.tileset_pixels = 16;
  manifest.normal_maps = NormalMapFormat{ImageFormat::webp, 40};
  EXPECT_EQ(manifest.format_version(), 13);
  const std::string text = to_json_text(manifest);
  expect_same(manifest, parse_manifest(text, kManifestName));
  Json changed = Json::parse(text);
  changed["format_version"] = 12;
  EXPECT_THAT(failure(sealed(changed)), HasSubstr("13 if and only if there are pictures and"));
  changed["format_version"] = 13;
  changed["storage"].erase("normal_map");
  EXPECT_THAT(failure(sealed(changed)), HasSubstr("13 if and only if there are pictures and"));
}

TEST(Manifest, TheRootOfTheTilesetHasTheOriginSinceVersionTwelve) {
  Manifest manifest = make_manifest();
  manifest.transform.reset();
  manifest.origin = {100, 200, 300};
  EXPECT_FALSE(manifest.root_transform()) << "the nodes have it";
  manifest.tileset_pixels = 16;
  EXPECT_EQ(manifest.root_transform(),
            (Transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 200, 300, 1}));
  manifest.up = UpAxis::y;
  manifest.units = Unit::km;
  EXPECT_EQ(manifest.root_transform(),
            (Transform{1e3, 0, 0, 0, 0, 1e3, 0, 0, 0, 0, 1e3, 0, 1e5, -3e5, 2e5, 1}));
}

TEST(Manifest, SANITIZED_OtherFormatsAndVersionsAreRefusedByTheirNumber) {
  Json document = Json::parse(to_json_text(make_manifest()));
  document["format_version"] = 15;
  EXPECT_THAT(failure(document.dump()), HasSubstr("format version 15 is newer than 14"));
  for (const int earlier : {0, 5}) {
    document["format_version"] = earlier;
    EXPECT_EQ(
        failure(document.dump()),
        fmt::format("{}: was made with format version {}, this program reads 6 to 14: build it "
                    "again from the mesh",
                    kManifestName, earlier));
  }
  document["format"] = "nexus";
  EXPECT_THAT(failure(document.dump()), HasSubstr("\"format\" is wrong"));
}

TEST(Manifest, SANITIZED_ChangedTextIsRefused) {
  std::string text = to_json_text(make_manifest());
  text.replace(text.find("cluster"), 7, "mustard");
  EXPECT_THAT(failure(text), HasSubstr("the file was changed"));
  Json document = Json::parse(text);
  EXPECT_THAT(failure(document.dump()), HasSubstr("does not end with its checksum"));
}

TEST(Manifest, SANITIZED_TextsThatAreNoManifestAreRefused) {
  EXPECT_THAT(failure(""), HasSubstr("not valid JSON"));
  EXPECT_THAT(failure("[]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(failure("{\"format\": 1e999}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(failure(std::string(100000, '[')), HasSubstr("nested deeper"));
  EXPECT_THAT(failure(std::string(1024 * 1024 + 1, ' ')), HasSubstr("expected at most"));
}

}  // namespace
}  // namespace meshhier::tests
