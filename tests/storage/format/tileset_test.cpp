#include "storage/format/tileset.h"

#include "base/bounds.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

namespace fs = std::filesystem;
using storage::for_each_tileset;
using storage::Manifest;
using storage::TilesetFile;
using Json = nlohmann::ordered_json;

/// Records of a tree of boxes that shrink and shift from level to level: a child's content may lie
/// outside its parent's.
std::vector<TileRecord> records_of(const Tree& tree) {
  std::vector<TileRecord> records;
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    for (std::uint32_t i = 0; i < tree.node_count(static_cast<Level>(level)); ++i) {
      TileRecord record;
      record.node = {static_cast<Level>(level), i};
      if (tree.is_early(record.node))
        continue;
      const auto begin = static_cast<float>(tree.partitions(record.node).begin);
      const auto end = static_cast<float>(tree.partitions(record.node).end);
      const float jut = 0.25F * static_cast<float>((i + static_cast<std::uint32_t>(level)) % 3);
      record.bounds = {{begin - jut, -jut, 0}, {end + jut, 1 + jut, 2}};
      record.error = tree.is_partition(record.node) ? 0 : std::ldexp(1.0F, -level);
      records.push_back(record);
    }
  }
  return records;
}

struct Box {
  Vec3d low, high;
  bool holds(const Box& other) const {
    return low.x <= other.low.x && low.y <= other.low.y && low.z <= other.low.z &&
           high.x >= other.high.x && high.y >= other.high.y && high.z >= other.high.z;
  }
};

Box box_of(const Json& tile) {
  const auto b = tile.at("boundingVolume").at("box").get<std::vector<double>>();
  return {{b.at(0) - b.at(3), b.at(1) - b.at(7), b.at(2) - b.at(11)},
          {b.at(0) + b.at(3), b.at(1) + b.at(7), b.at(2) + b.at(11)}};
}

/// All files, and a walk over the tiles as a viewer makes it.
class Tileset {
 public:
  Tileset(const Manifest& manifest, const Tree& tree, const std::vector<TileRecord>& records) {
    for_each_tileset(manifest, tree, records, [&](const TilesetFile& file) {
      EXPECT_LE(file.text.size(), 256U * 1024) << file.path;
      EXPECT_TRUE(files_.emplace(file.path.generic_string(), file.text).second) << file.path;
    });
    walk(storage::tileset_path({}), root(storage::tileset_path({})), INFINITY, nullptr);
  }

  Json document(const fs::path& path) const {
    return Json::parse(files_.at(path.generic_string()));
  }
  Json root(const fs::path& path) const { return document(path).at("root"); }
  std::size_t file_count() const { return files_.size(); }
  const std::set<std::string>& visited_files() const { return visited_files_; }
  /// Every tile's content, with its box.
  const std::map<std::string, Box>& tiles() const { return tiles_; }

 private:
  void walk(const fs::path& file, const Json& tile, double error_above, const Box* box_above) {
    visited_files_.insert(file.generic_string());
    const auto error = tile.at("geometricError").get<double>();
    EXPECT_LT(error, error_above) << file;
    const Box box = box_of(tile);
    EXPECT_TRUE(box_above == nullptr || box_above->holds(box)) << file;
    const fs::path uri =
        (file.parent_path() / tile.at("content").at("uri").get<std::string>()).lexically_normal();
    if (uri.extension() == ".json") {
      EXPECT_FALSE(tile.contains("children"));
      walk(uri, root(uri), error, &box);
      return;
    }
    EXPECT_TRUE(tiles_.emplace(uri.generic_string(), box).second) << uri;
    EXPECT_EQ(tile.contains("children"), error > 0) << uri;
    for (const Json& child : tile.value("children", Json::array()))
      walk(file, child, error, &box);
  }

  std::map<std::string, std::string> files_;
  std::set<std::string> visited_files_;
  std::map<std::string, Box> tiles_;
};

TEST(Tileset, HoldsEveryTileOnceInBoxesOfItAndAllBelow) {
  for (const std::uint32_t partitions :
       {1U, 2U, 3U, 5U, 37U, 64U, 127U, 128U, 129U, 1000U, 5000U}) {
    const Tree tree(100'000, partitions);
    const std::vector<TileRecord> records = records_of(tree);
    for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
      Manifest manifest;
      manifest.origin = {1e6, 2e6, -7};
      manifest.up = up;
      const Tileset tileset(manifest, tree, records);
      ASSERT_EQ(tileset.tiles().size(), records.size());
      EXPECT_EQ(tileset.visited_files().size(), tileset.file_count());
      for (const TileRecord& record : records) {
        const Vec3d low = to_double(record.bounds.min) + manifest.origin;
        const Vec3d high = to_double(record.bounds.max) + manifest.origin;
        const Box content = up == UpAxis::z
                                ? Box{low, high}
                                : Box{{low.x, -high.z, low.y}, {high.x, -low.z, high.y}};
        const std::string name = storage::tile_path({}, record.node).generic_string();
        ASSERT_TRUE(tileset.tiles().contains(name)) << name;
        EXPECT_TRUE(tileset.tiles().at(name).holds(content)) << name;
      }
    }
  }
}

TEST(Tileset, SLOW_StartsWithASmallFile) {
  const Tree tree(1U << 30, 1U << 17);
  const std::vector<TileRecord> records = records_of(tree);
  const Tileset tileset({}, tree, records);
  EXPECT_GT(tileset.file_count(), 1000U);
  EXPECT_LT(tileset.document(storage::tileset_path({})).dump().size(), 64U * 1024);
}

TEST(Tileset, TellsOfTheSource) {
  const Tree tree(100, 2);
  Manifest manifest;
  manifest.generator = "meshhier 9";
  manifest.source.file_name = "scan \"1\".ply";
  manifest.source.vertices = 100;
  manifest.source.triangles = 17;
  manifest.licence = "CC BY 4.0";
  manifest.transform = Transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  const Json document =
      Tileset(manifest, tree, records_of(tree)).document(storage::tileset_path({}));
  EXPECT_EQ(document["asset"]["version"], "1.1");
  const Json& told = document["metadata"]["properties"];
  EXPECT_EQ(told["name"], "scan \"1\".ply");
  EXPECT_EQ(told["vertices"], 100);
  EXPECT_EQ(told["triangles"], 17);
  EXPECT_EQ(told["licence"], "CC BY 4.0");
  const Json& properties = document["schema"]["classes"]["source"]["properties"];
  for (const auto& [name, value] : told.items())
    EXPECT_TRUE(properties.contains(name)) << name;
  EXPECT_EQ(document["root"]["transform"][13], 6);
  EXPECT_EQ(document["root"]["refine"], "REPLACE");
}

TEST(Tileset, IsInMetres) {
  const Tree tree(100, 2);
  const auto records = records_of(tree);
  const auto document = [&](std::optional<Unit> units, std::optional<Transform> transform) {
    Manifest manifest;
    manifest.units = units;
    manifest.transform = transform;
    return Tileset(manifest, tree, records).document(storage::tileset_path({}));
  };
  const Json unknown = document({}, {});
  EXPECT_FALSE(unknown["root"].contains("transform"));
  EXPECT_EQ(document(Unit::m, {}), unknown);
  const Json in_feet = document(Unit::ft, {});
  const Transform feet{0.3048, 0, 0, 0, 0, 0.3048, 0, 0, 0, 0, 0.3048, 0, 0, 0, 0, 1};
  EXPECT_EQ(in_feet["root"]["transform"], Json(feet));
  EXPECT_EQ(in_feet["root"]["geometricError"], unknown["root"]["geometricError"])
      << "viewers scale what lies below a transform";
  EXPECT_DOUBLE_EQ(in_feet["geometricError"].get<double>(),
                   0.3048 * unknown["geometricError"].get<double>());
  EXPECT_EQ(document(Unit::ft, feet), in_feet) << "a place has its scale";
  const Transform place = storage::globe_transform(9, 48, 0, {}, UpAxis::y);
  EXPECT_EQ(document({}, place)["geometricError"], unknown["geometricError"]);
}

Vec3d apply(const Transform& m, Vec3d p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
          m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

/// The tile, and all below it in its file.
void visit_tiles(const Json& tile, const std::function<void(const Json&)>& visit) {
  visit(tile);
  for (const Json& child : tile.value("children", Json::array()))
    visit_tiles(child, visit);
}

TEST(Tileset, TellsErrorsTimesWhatViewersAllowFor) {
  const Tree tree(100'000, 1000);
  const std::vector<TileRecord> records = records_of(tree);
  for (const double pixels : {1.0, 7.3, 16.0, 1000.0}) {
    Manifest manifest;
    const Tileset plain(manifest, tree, records);
    manifest.tileset_pixels = pixels;
    const Tileset tileset(manifest, tree, records);  // strictly decreasing: its walk looks
    std::size_t tiles = 0;
    for (const std::string& file : tileset.visited_files()) {
      visit_tiles(tileset.root(file), [&](const Json& tile) {
        const auto uri = tile["content"]["uri"].get<std::string>();
        const auto begin = std::min(uri.find("tiles/"), uri.size());  // tiles, not tilesets
        const auto node = storage::tile_of(std::string_view(uri).substr(begin));
        EXPECT_EQ(tile.contains("extras"), node.has_value()) << uri;
        if (!node)
          return;
        const float error = storage::record_of(records, *node).error;
        EXPECT_EQ(tile["extras"]["error"], error) << uri;
        EXPECT_EQ(tile["geometricError"], pixels * error) << uri;
        ++tiles;
      });
    }
    EXPECT_EQ(tiles, records.size());
    const fs::path first = storage::tileset_path({});
    EXPECT_EQ(tileset.document(first)["geometricError"],
              pixels * plain.document(first)["geometricError"].get<double>());
    EXPECT_FALSE(plain.root(first).contains("extras")) << "as until version 11";
  }
}

TEST(Tileset, HasTheOriginInItsRootAlone) {
  const Tree tree(100'000, 200);
  const std::vector<TileRecord> records = records_of(tree);
  const Transform place = storage::globe_transform(9, 48, 300, {1e6, 2e6, -7}, UpAxis::z);
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    for (const std::optional<Transform>& transform : {std::optional<Transform>{}, {place}}) {
      Manifest manifest;
      manifest.up = up;
      manifest.transform = transform;
      manifest.tileset_pixels = 16;
      const Json at_zero = Tileset(manifest, tree, records).root(storage::tileset_path({}));
      manifest.origin = {1e6, 2e6, -7};
      const Tileset tileset(manifest, tree, records);
      for (const std::string& file : tileset.visited_files()) {
        visit_tiles(tileset.root(file), [&](const Json& tile) {
          EXPECT_EQ(tile.contains("transform"), tile["content"]["uri"] == "tiles/00/000000.glb");
          for (const Json& number : tile["boundingVolume"]["box"])
            EXPECT_LT(std::abs(number.get<double>()), 300) << file;
        });
      }
      const Json root = tileset.root(storage::tileset_path({}));
      EXPECT_EQ(root["boundingVolume"], at_zero["boundingVolume"]);
      const Vec3d origin = to_z_up(manifest.origin, up);
      EXPECT_EQ(root["extras"]["origin"], Json({origin.x, origin.y, origin.z}));
      const auto found = root["transform"].get<Transform>();
      const Vec3d near{3, -5, 100};
      const Transform place_of_input = transform.value_or(kIdentity);
      const Vec3d wanted = apply(place_of_input, origin + near);
      EXPECT_LT(length(apply(found, near) - wanted), 1e-8);
    }
  }
}

TEST(Globe, PlacesTheAnchorAndStandsUp) {
  // The Zugspitze: 47.421 N, 10.985 E; geocentric coordinates by PROJ.
  const Vec3d anchor{3, 4, 5};
  const Transform z_up = storage::globe_transform(10.985, 47.421, 2962, anchor, UpAxis::z);
  const Vec3d place = apply(z_up, anchor);
  const double distance = length(place);
  EXPECT_NEAR(std::atan2(place.y, place.x) * 180 / 3.14159265358979, 10.985, 1e-9);
  // Geodetic latitude by Bowring's formula.
  const double a = 6378137, b = 6356752.314245179;
  const double p = std::hypot(place.x, place.y);
  const double beta = std::atan2(place.z * a, p * b);
  const double e2 = 1 - b * b / (a * a), f2 = a * a / (b * b) - 1;
  const double latitude = std::atan2(place.z + f2 * b * std::pow(std::sin(beta), 3),
                                     p - e2 * a * std::pow(std::cos(beta), 3));
  EXPECT_NEAR(latitude * 180 / 3.14159265358979, 47.421, 1e-8);
  EXPECT_NEAR(p / std::cos(latitude) - a / std::sqrt(1 - e2 * std::pow(std::sin(latitude), 2)),
              2962, 1e-3);
  // A metre up is a metre farther from the ellipsoid; north is towards the pole, east along.
  const Vec3d up = apply(z_up, {3, 4, 6}) - place;
  EXPECT_NEAR(length(up), 1, 1e-9);
  EXPECT_GT(dot(up, place) / distance, 0.99999);
  EXPECT_GT((apply(z_up, {3, 5, 5}) - place).z, 0.6);
  EXPECT_NEAR((apply(z_up, {4, 4, 5}) - place).z, 0, 1e-9);
  // A y-up mesh is turned first, as viewers turn it: (x, y, z) is at (x, -z, y).
  const Transform y_up = storage::globe_transform(10.985, 47.421, 2962, anchor, UpAxis::y);
  EXPECT_NEAR(length(apply(y_up, {3, -5, 4}) - place), 0, 1e-8);
}

}  // namespace
}  // namespace meshhier::tests
