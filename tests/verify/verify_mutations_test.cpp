// Every value of manifest and index, changed in every way, with the checksums made right again:
// verify finds it, or the value is one that nothing else tells.
#include "base/error.h"
#include "hierarchy/cut.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/tileset.h"
#include "storage/io/hash.h"
#include "tests/support/meshes.h"
#include "tests/support/named_boxes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/share.h"
#include "verify/verify.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::ordered_json;

// ---- the exceptions ------------------------------------------------------------------------

/// Values of the manifest that may be others of their kind, and why.
const std::map<std::string, std::string>& free_values() {
  static const std::string kInput = "only the input tells: verify --input compares what matters";
  static const std::string kAsked = "what the config asked for; nothing else tells";
  static const std::map<std::string, std::string> values = {
      {"/generator", "free text"},
      {"/source/file_name", "free text"},
      {"/source/file_bytes", kInput},
      {"/source/checksum", kInput},
      {"/source/faces", kInput},
      {"/source/degenerate_triangles", kInput},
      {"/source/double_precision", kInput},
      {"/source/import/files/0/name", "free text"},
      {"/source/import/files/0/format", "free text"},
      {"/source/import/files/0/checksum", kInput},
      {"/source/import/counts/welded_vertices", kInput},
      {"/config/partition/axis", kAsked},
      {"/config/partition/vertices", "several make the same count of partitions"},
      {"/config/simplify/method", kAsked},
      {"/config/simplify/vertices", kAsked},
      {"/config/simplify/representative", kAsked},
      {"/config/simplify/cost", kAsked},
      {"/config/outline/sectors", kAsked},
      {"/config/outline/tolerance", kAsked},
      {"/config/storage/positions/bits", kAsked},
      {"/config/weld", kAsked},
      {"/outline/sector_level", "tiles of another level may be divided into as many sectors"},
      {"/outline/tolerance", "what the search for an outline that fits ended with"},
      {"/outline/polylines_found", "found and dropped may both be others"},
      {"/storage/positions/worst_rounding", "a bound; bounds of partitions contain it"}};
  return values;
}

/// Keys that need not be there, and why; all below those that end with a slash.
const std::map<std::string, std::string>& optional_keys() {
  static const std::string kOlder = "programs before this one wrote fewer keys of the config";
  static const std::map<std::string, std::string> keys = {
      {"/config/", kOlder},
      {"/source/import", "nothing else tells that there was one"},
      {"/source/import/counts/", "an import may have counted nothing"}};
  return keys;
}

bool is_optional(const std::string& pointer) {
  for (const auto& [key, reason] : optional_keys()) {
    if (pointer == key || (key.ends_with('/') && pointer.starts_with(key)))
      return true;
  }
  return false;
}

// ---- mutations -----------------------------------------------------------------------------

struct Mutation {
  std::string name;  ///< "/source/vertices, one more"
  Json document;
  bool is_free = false;  ///< may pass
};

/// The document, in which the key or element at a place is another; null: gone.
Json with_key(const Json& document, const Json::json_pointer& place,
              const std::optional<std::string>& key) {
  Json changed = document;
  Json& parent = changed[place.parent_pointer()];
  if (parent.is_array()) {
    parent.erase(std::stoul(place.back()));
    return changed;
  }
  Json renamed = Json::object();
  for (const auto& [name, value] : parent.items()) {
    if (name != place.back())
      renamed[name] = value;
    else if (key)
      renamed[*key] = value;
  }
  parent = renamed;
  return changed;
}

/// Others of the same kind.
std::vector<std::pair<std::string, Json>> others_like(const Json& value) {
  if (value.is_string())
    return {{"another text", value.get<std::string>() + "0"}};
  if (value.is_boolean())
    return {{"the other", !value.get<bool>()}};
  if (value.is_number_float()) {
    const double number = value.get<double>();
    return {{"one more", number + 1}, {"negative", number == 0 ? -1 : -number}};
  }
  if (value.is_number()) {
    const auto number = value.get<std::int64_t>();
    return {{"one more", value.get<std::uint64_t>() + 1}, {"negative", number == 0 ? -1 : -number}};
  }
  return {};
}

Json of_another_type(const Json& value) {
  return value.is_string() ? Json(5) : Json("x");
}

void add_mutations(const Json& document, const Json& value, const std::string& pointer,
                   std::vector<Mutation>& all) {
  const Json::json_pointer place(pointer);
  const auto changed = [&](const Json& to) {
    Json result = document;
    result[place] = to;
    return result;
  };
  if (value.is_object())
    all.push_back({pointer + ", a key more", changed([&] {
                     Json more = value;
                     more["added"] = 1;
                     return more;
                   }()),
                   pointer == "/source/import/counts"});
  if (!pointer.empty()) {
    all.push_back({pointer + ", another type", changed(of_another_type(value))});
    all.push_back({pointer + ", gone", with_key(document, place, {}), is_optional(pointer)});
    if (document[place.parent_pointer()].is_object())
      all.push_back({pointer + ", renamed", with_key(document, place, place.back() + "_"),
                     pointer.starts_with("/source/import/counts/")});
  }
  for (const auto& [how, other] : others_like(value))
    all.push_back({pointer + ", " + how, changed(other), free_values().contains(pointer)});
  if (!value.is_structured())
    return;
  for (const auto& [key, inner] : value.items())
    add_mutations(document, inner, pointer + '/' + key, all);
}

std::string sealed(const Json& document) {
  constexpr std::string_view kAfter = "\"\n}\n";
  std::string text = document.dump(2) + '\n';
  if (!document.contains("checksum") || !text.ends_with(kAfter))
    return text;
  const std::size_t place = text.size() - kAfter.size() - 16;
  text.replace(place, 16, "0000000000000000");
  return text.replace(place, 16,
                      fmt::format("{:016x}", storage::checksum(std::as_bytes(std::span(text)))));
}

class VerifyMutationsTest : public testing::Test {
 protected:
  fs::path path() const { return directory_.path() / "mesh.hier"; }

  void build(config::Config config) {
    config.output = path();
    execution::NoProgress progress;
    pipeline::build_hierarchy(config, {}, {*files_, progress, execution::CancelToken()});
    original_ = text_of(storage::manifest_path(path()));
  }

  fs::path mesh(const std::string& name) const {
    tests::write_ply(tests::sphere(3000, 0.01F), directory_.path() / name);
    return directory_.path() / name;
  }

  static config::Config small() {
    config::Config config = tests::smooth_config();
    config.partition.vertices = 300;
    return config;
  }

  static std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void write_manifest(const std::string& text) const {
    std::ofstream(storage::manifest_path(path()), std::ios::binary) << text;
  }

  std::vector<std::string> problems() {
    execution::NoProgress progress;
    return verify_hierarchy(*files_, path(), {}, progress, execution::CancelToken()).problems;
  }

  /// Those that pass and may not; those that need not be free are told by way of free_values().
  std::vector<std::string> undetected_in_manifest() {
    std::vector<Mutation> all;
    const Json document = Json::parse(original_);
    add_mutations(document, document, "", all);
    EXPECT_GT(all.size(), 300U);
    std::vector<std::string> passed;
    for (std::size_t i = tests::share().index; i < all.size(); i += tests::share().count) {
      const Mutation& mutation = all[i];
      write_manifest(sealed(mutation.document));
      if (!mutation.is_free && !mutation.name.starts_with("/checksum") && problems().empty())
        passed.push_back(mutation.name);
    }
    write_manifest(original_);
    return passed;
  }

  tests::TemporaryDirectory directory_{tests::TemporaryDirectory::Place::memory};
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::string original_;
};

TEST_F(VerifyMutationsTest, NoValueOfTheManifestMayBeAnother) {
  config::Config config = small();
  config.input = mesh("mesh.ply");
  config.licence = "CC0";
  build(config);
  ASSERT_THAT(problems(), IsEmpty());
  EXPECT_THAT(undetected_in_manifest(), IsEmpty());
}

TEST_F(VerifyMutationsTest, NoValueOfAnImportedRoundedAndPlacedOneMayBeAnother) {
  config::Config config = small();
  config.preview = false;
  const fs::path input = directory_.path() / "mesh.obj";
  std::ofstream stream(input);
  const tests::TestMesh sphere = tests::duplicates(2000);
  for (const Vec3f& p : sphere.positions)
    stream << "v " << p.x + 1 << ' ' << p.y << ' ' << p.z << '\n';
  for (const tests::MeshTriangle& t : sphere.triangles)
    stream << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  stream.close();
  config.input = input;
  config.weld = true;
  config.storage.compression = storage::Compression::meshopt_zlib;
  config.storage.position_bits = 16;
  config.placement.longitude = 10;
  config.placement.latitude = 50;
  build(config);
  ASSERT_THAT(problems(), IsEmpty());
  EXPECT_THAT(undetected_in_manifest(), IsEmpty());
}

TEST_F(VerifyMutationsTest, AModelOnAMapStandsWhereTheMapSays) {
  config::Config config = small();
  config.input = mesh("mesh.ply");
  config.placement.crs = "EPSG:32633";
  config.placement.offset = {500000, 5300000, 0};
  build(config);
  ASSERT_THAT(problems(), IsEmpty());
  const auto moved_by = [&](double metres) {
    Json manifest = Json::parse(original_);
    manifest["transform"][12] = manifest["transform"][12].get<double>() + metres;
    write_manifest(sealed(manifest));
    return problems();
  };
  EXPECT_THAT(moved_by(1), testing::Not(testing::Contains(HasSubstr("not near"))));
  EXPECT_THAT(moved_by(20), testing::Contains(HasSubstr("\"transform\" is not near")));
}

/// A member of a record; errors and bounds are estimates and bounds, which verify --error measures.
struct Field {
  std::string name;
  std::function<void(TileRecord&, int step)> change;
};

std::vector<Field> fields() {
  const auto count = [](const std::string& name, std::uint32_t TileRecord::*member) {
    return Field{name, [member](TileRecord& r, int step) { r.*member += step; }};
  };
  const auto corner = [](const std::string& name, Vec3f Bounds::*end, float Vec3f::*axis) {
    return Field{name, [end, axis](TileRecord& r, int step) {
                   float& value = r.bounds.*end.*axis;
                   value = std::nextafter(value, static_cast<float>(step) * 1e30F);
                 }};
  };
  return {count("own", &TileRecord::own_count),
          count("boundary", &TileRecord::boundary_count),
          count("ghosts", &TileRecord::ghost_count),
          count("copies", &TileRecord::copy_count),
          count("splits", &TileRecord::split_count),
          count("interior", &TileRecord::interior_count),
          count("border", &TileRecord::border_count),
          count("drawn", &TileRecord::drawn_border_count),
          count("target", &TileRecord::target_count),
          count("torn", &TileRecord::torn_count),
          count("forced", &TileRecord::forced_count),
          corner("min x", &Bounds::min, &Vec3f::x),
          corner("min y", &Bounds::min, &Vec3f::y),
          corner("min z", &Bounds::min, &Vec3f::z),
          corner("max x", &Bounds::max, &Vec3f::x),
          corner("max y", &Bounds::max, &Vec3f::y),
          corner("max z", &Bounds::max, &Vec3f::z),
          {"compactness", [](TileRecord& r, int step) { r.compactness += float(step); }},
          {"error below its children's or negative", [](TileRecord& r, int) { r.error = -1; }},
          {"error above its parent's", [](TileRecord& r, int) { r.error = 1e30F; }},
          {"bound below its children's or negative", [](TileRecord& r, int) { r.bound = -1; }},
          {"bound above its parent's", [](TileRecord& r, int) { r.bound = 1e30F; }},
          {"bytes", [](TileRecord& r, int step) { r.file_bytes += std::uint64_t(step); }},
          {"checksum", [](TileRecord& r, int step) { r.checksum += std::uint64_t(step); }}};
}

TEST_F(VerifyMutationsTest, NoValueOfTheIndexMayBeAnother) {
  config::Config config = small();
  config.preview = false;
  config.input = mesh("mesh.ply");
  build(config);
  const std::vector<TileRecord> records = storage::HierarchyReader(*files_, path()).records();
  const Json document = Json::parse(original_);
  const auto problems_of = [&](const std::vector<TileRecord>& changed) {
    const auto bytes = storage::encode_index(changed);
    storage::write_file(*files_, storage::index_path(path()), bytes);
    Json manifest = document;
    manifest["index"]["checksum"] = fmt::format("{:016x}", storage::checksum(bytes));
    write_manifest(sealed(manifest));
    return problems();
  };
  ASSERT_THAT(problems_of(records), IsEmpty());
  std::vector<std::string> passed;
  std::size_t number = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (const Field& field : fields()) {
      for (const int step : {1, -1}) {
        if (!tests::share().has(number++))
          continue;
        std::vector<TileRecord> changed = records;
        field.change(changed[i], step);
        if (problems_of(changed).empty())
          passed.push_back(
              fmt::format("{} of {} by {}", field.name, to_text(records[i].node), step));
      }
    }
  }
  EXPECT_THAT(passed, IsEmpty());
}

/// The table of all objects, its facts and its checksums are made right: only the tiles differ.
TEST_F(VerifyMutationsTest, ATileThatTellsOtherwiseOfAnObjectIsFound) {
  config::Config config = small();
  config.input = directory_.path() / "boxes.obj";
  config.objects.table = directory_.path() / "boxes.csv";
  tests::write_named_boxes(directory_.path() / "boxes.obj", 200, "shops");
  build(config);
  const Json other = Json::parse(original_)["objects"];
  fs::rename(storage::objects_path(path()), directory_.path() / "other.bin");
  fs::remove_all(path());
  tests::write_named_boxes(directory_.path() / "boxes.obj", 200, "flats");
  build(config);
  EXPECT_THAT(problems(), IsEmpty());
  fs::rename(directory_.path() / "other.bin", storage::objects_path(path()));
  Json changed = Json::parse(original_);
  const auto bytes = [](const Json& objects) { return objects["bytes"].get<std::int64_t>(); };
  changed["total_bytes"] =
      changed["total_bytes"].get<std::int64_t>() + bytes(other) - bytes(changed["objects"]);
  changed["objects"] = other;
  write_manifest(sealed(changed));
  EXPECT_THAT(problems(), Contains(HasSubstr("its table of objects is not what objects.bin says")));
}

TEST_F(VerifyMutationsTest, LinksAreNoFiles) {
  config::Config config = small();
  config.input = mesh("mesh.ply");
  build(config);
  const fs::path outside = directory_.path() / "elsewhere";
  for (const fs::path& file : {storage::tile_path(path(), tests::node(0, 0)),
                               storage::manifest_path(path()), storage::tileset_path(path())}) {
    fs::rename(file, outside);
    fs::create_symlink(outside, file);
    EXPECT_THAT(problems(), ElementsAre(HasSubstr(file.string() + ": a link")));
    fs::remove(file);
    fs::rename(outside, file);
  }
  const fs::path level = storage::level_directory(path(), Level{1});
  fs::rename(level, outside);
  fs::create_directory_symlink(outside, level);
  EXPECT_THAT(problems(), testing::Contains(HasSubstr(level.string() + ": a link")));
}

/// The JSON of a GLB.
Json json_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, sizeof length);
  return Json::parse(bytes.substr(20, length));
}

// Viewers that multiply matrices in floats would move what lies at 5,800,000 by decimetres.
TEST_F(VerifyMutationsTest, LargeCoordinatesAreInTheTilesetsRootAlone) {
  tests::TestMesh moved = tests::sphere(2000, 0.01F);
  for (Vec3f& p : moved.positions)
    p = {p.x + 500'000, p.y + 5'800'000, p.z};
  const fs::path ply = directory_.path() / "map.ply";
  tests::write_ply(moved, ply);
  for (const char* more : {"", "units", "lattice", "placed"}) {
    config::Config config = small();
    config.input = ply;
    config.up = UpAxis::z;
    const std::string what = more;
    if (what == "units")
      config.units = Unit::ft;
    if (what == "lattice")
      config.storage.position_bits = 14;
    if (what == "placed") {
      config.placement.longitude = 9;
      config.placement.latitude = 48;
      config.placement.anchor = {500'000, 5'800'000, 0};
    }
    config.output = path();
    execution::NoProgress progress;
    pipeline::build_hierarchy(config, {.force = true},
                              {*files_, progress, execution::CancelToken()});
    EXPECT_THAT(problems(), IsEmpty()) << more;
    const storage::HierarchyReader reader(*files_, path());
    ASSERT_EQ(reader.manifest().origin, (Vec3d{500'000, 5'800'000, 0})) << more;
    for (const fs::path& file :
         {storage::tile_path(path(), tests::node(0, 0)), storage::outline_path(path())}) {
      for (const Json& number : json_of(file)["nodes"][0]["matrix"])
        EXPECT_LE(std::abs(number.get<double>()), 2) << more << ' ' << file;
    }
    const Json root = Json::parse(text_of(storage::tileset_path(path())))["root"];
    const double unit = what == "units" ? 0.3048 : 1;
    if (what == "placed") {
      const Transform place = storage::globe_transform(9, 48, 0, {}, UpAxis::z);
      for (std::size_t i = 0; i < place.size(); ++i)
        EXPECT_NEAR(root["transform"][i].get<double>(), place[i], 1e-8) << i;
    } else {
      EXPECT_EQ(root["transform"][13], 5'800'000 * unit) << more;
    }
  }
}

// An archive that an unpacker has unpacked, on a disk that several systems have looked at.
TEST_F(VerifyMutationsTest, WhatSystemsLeaveInFoldersIsNoProblem) {
  config::Config config = small();
  config.input = mesh("mesh.ply");
  build(config);
  const std::vector<const char*> names{
      "@3dtilesIndex1@", ".DS_Store",        "tiles/00/.DS_Store",
      "Thumbs.db",       "tiles/.nfs00a1b2", "tiles/._00",
      "__MACOSX/x/._y",  "tiles/@eaDir/z",   ".hierarchy.json.meshhier-lock"};
  for (const char* name : names) {
    fs::create_directories((path() / name).parent_path());
    std::ofstream(path() / name) << "anything";
  }
  EXPECT_THAT(problems(), IsEmpty());
  std::ofstream(path() / "tiles/@3dtilesIndex1@") << "elsewhere";
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("tiles/@3dtilesIndex1@: not a file of this")));
  fs::remove(path() / "tiles/@3dtilesIndex1@");
  config.output = path();
  execution::NoProgress progress;
  pipeline::build_hierarchy(config, {.force = true}, {*files_, progress, execution::CancelToken()});
  EXPECT_FALSE(fs::exists(path() / "Thumbs.db")) << "they go with what is replaced";
}

TEST_F(VerifyMutationsTest, DirectoriesOfNothingAreNamed) {
  config::Config config = small();
  config.input = mesh("mesh.ply");
  build(config);
  for (const char* name : {"empty", "tiles/77", "tiles/00/below", "tiles/00/.hidden"}) {
    const fs::path extra = path() / name;
    fs::create_directory(extra);
    EXPECT_THAT(problems(), ElementsAre(HasSubstr(extra.string() + ": not a directory of this")));
    fs::remove(extra);
  }
  EXPECT_THAT(problems(), IsEmpty());
}

}  // namespace
}  // namespace meshhier::verifying
