// Exports with pictures: GLB and OBJ, against the PLY of the same selection.
#include "base/error.h"
#include "export/export.h"
#include "hierarchy/shown_corners.h"
#include "images/image_codec.h"
#include "images/ktx2_coder.h"
#include "mesh_io/mesh_source.h"
#include "storage/format/glb.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_copies.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sample_shading.h"
#include "tests/support/sample_texture.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using tests::node;
using Json = nlohmann::ordered_json;

/// A triangle's corners, each a few numbers; begins with the least.
using Facet = std::array<std::vector<double>, 3>;

Facet least_first(Facet facet) {
  std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
  return facet;
}

/// Sorted, begun with their least corners.
std::vector<Facet> sorted(std::vector<Facet> facets) {
  for (Facet& facet : facets)
    facet = least_first(facet);
  std::sort(facets.begin(), facets.end());
  return facets;
}

/// An OBJ has the shortest digits that are read back as the same floats.
std::vector<Facet> as_floats(std::vector<Facet> facets) {
  for (Facet& facet : facets) {
    for (std::vector<double>& corner : facet) {
      for (double& value : corner)
        value = double{static_cast<float>(value)};
    }
  }
  return facets;
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<Facet> facets_of_ply(storage::FileSystem& files, const fs::path& path) {
  std::vector<std::vector<double>> places;
  std::vector<Facet> facets;
  const auto mesh = mesh_io::open_mesh(files, path);
  mesh->read_vertices([&](const mesh_io::VertexBlock& block) {
    for (const Vec3f& p : block.positions)
      places.push_back({double{p.x}, double{p.y}, double{p.z}});
    for (const Vec3d& p : block.exact)
      places.push_back({p.x, p.y, p.z});
  });
  mesh->read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
    for (const auto& t : triangles)
      facets.push_back({places[raw(t[0])], places[raw(t[1])], places[raw(t[2])]});
  });
  return sorted(facets);
}

struct Glb {
  Json json;
  std::vector<std::byte> bin;

  static Glb read(const fs::path& path) {
    const std::string text = text_of(path);
    const auto view = storage::split_glb(std::as_bytes(std::span(text)), "export.glb");
    return {Json::parse(view.json), {view.bin.begin(), view.bin.end()}};
  }

  const std::byte* at(std::size_t view) const {
    return bin.data() + json["bufferViews"][view]["byteOffset"].get<std::size_t>();
  }

  std::vector<double> floats(const Json& primitive, const char* attribute, std::size_t vertex,
                             std::size_t count) const {
    const auto accessor = primitive["attributes"][attribute].get<std::size_t>();
    const Json& told = json["accessors"][accessor];
    EXPECT_LT(vertex, told["count"].get<std::size_t>());
    EXPECT_EQ(told["componentType"], 5126);
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
      values.push_back(double{storage::load_little<float>(
          at(told["bufferView"].get<std::size_t>()) + 4 * (count * vertex + i))});
    return values;
  }

  std::vector<std::size_t> corners(const Json& primitive) const {
    const Json& told = json["accessors"][primitive["indices"].get<std::size_t>()];
    const std::byte* from = at(told["bufferView"].get<std::size_t>());
    std::vector<std::size_t> corners;
    for (std::size_t i = 0; i < told["count"].get<std::size_t>(); ++i)
      corners.push_back(told["componentType"] == 5123
                            ? std::size_t{storage::load_little<std::uint16_t>(from + 2 * i)}
                            : std::size_t{storage::load_little<std::uint32_t>(from + 4 * i)});
    return corners;
  }

  /// Positions alone, or with texture coordinates behind them.
  std::vector<Facet> facets(const Json& primitive, bool texcoords = false) const {
    std::vector<Facet> facets;
    const auto numbers = corners(primitive);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (i % 3 == 0)
        facets.emplace_back();
      std::vector<double>& corner = facets.back()[i % 3];
      corner = floats(primitive, "POSITION", numbers[i], 3);
      if (!texcoords)
        continue;
      const auto texcoord = floats(primitive, "TEXCOORD_0", numbers[i], 2);
      corner.insert(corner.end(), texcoord.begin(), texcoord.end());
    }
    return facets;
  }

  std::vector<Facet> all_facets() const {
    std::vector<Facet> all;
    for (const Json& primitive : json["meshes"][0]["primitives"]) {
      const auto facets = this->facets(primitive);
      all.insert(all.end(), facets.begin(), facets.end());
    }
    return sorted(all);
  }
};

struct Obj {
  std::vector<std::vector<double>> places, texcoords;
  std::vector<Facet> facets;                              ///< positions
  std::map<std::string, std::vector<Facet>> by_material;  ///< texture coordinates behind them
  std::string mtllib;

  static Obj read(const fs::path& path) {
    Obj obj;
    std::ifstream in(path);
    std::string line, word, material;
    while (std::getline(in, line)) {
      std::istringstream words(line);
      words >> word;
      if (word == "v")
        obj.places.push_back(numbers(words));
      if (word == "vt")
        obj.texcoords.push_back(numbers(words));
      if (word == "mtllib")
        words >> obj.mtllib;
      if (word == "usemtl")
        words >> material;
      if (word == "f")
        obj.add(words, material);
    }
    return obj;
  }

 private:
  static std::vector<double> numbers(std::istringstream& words) {
    return {std::istream_iterator<double>(words), {}};
  }

  void add(std::istringstream& words, const std::string& material) {
    Facet facet, with_texcoords;
    for (std::size_t c = 0; c < 3; ++c) {
      std::string corner;
      words >> corner;
      const std::size_t place = std::stoul(corner);
      facet[c] = places.at(place - 1);
      facet[c].resize(3);
      with_texcoords[c] = facet[c];
      const std::size_t slash = corner.find('/');
      if (slash == std::string::npos || corner[slash + 1] == '/')
        continue;
      const auto& texcoord = texcoords.at(std::stoul(corner.substr(slash + 1)) - 1);
      with_texcoords[c].insert(with_texcoords[c].end(), {texcoord[0], 1 - texcoord[1]});
    }
    facets.push_back(facet);
    by_material[material].push_back(with_texcoords);
  }
};

class ExportPartsTest : public testing::Test {
 protected:
  fs::path hierarchy() const { return directory_.path() / "a.hier"; }
  fs::path at(const std::string& name) const { return directory_.path() / name; }

  tests::Sample publish(tests::Sample sample) {
    fs::remove_all(hierarchy());
    tests::write_sample(*files_, hierarchy(), sample);
    return sample;
  }
  /// With copies, splits by normals and texture coordinates, and pictures.
  tests::Sample publish_textured(const TextureFormat& format = {},
                                 AlphaMode alpha = AlphaMode::opaque) {
    tests::Sample sample = tests::make_sample(tests::torus(1500), {8, 40, false, true, {}});
    tests::add_copies(sample);
    tests::add_shading(sample);
    tests::add_textures(sample, format, alpha);
    return publish(std::move(sample));
  }
  tests::Sample publish_plain(const Vec3d& origin = {}) {
    tests::Sample sample = tests::make_sample(tests::torus(1500), {8, 40, false, true, origin});
    tests::add_copies(sample);
    return publish(std::move(sample));
  }

  std::string run(const ExportSelection& selection, const std::string& name, bool replace = true) {
    execution::NoProgress progress;
    return export_mesh(*files_, hierarchy(), {selection, at(name), 1 << 28, replace}, progress, {});
  }
  Error error_of(const ExportSelection& selection, const std::string& name, bool replace = true) {
    try {
      run(selection, name, replace);
    } catch (const Error& error) {
      return error;
    }
    return {ErrorCode::internal, "no error"};
  }
  fs::path mixed_cut() const {
    std::ofstream(at("cut.txt")) << "1/0\n2/2\n3/6\n3/7\n";
    return at("cut.txt");
  }
  std::vector<ExportSelection> selections() const {
    return {Level{0}, Level{1}, Level{2}, Level{3}, node(2, 1), node(3, 5), mixed_cut()};
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(ExportPartsTest, AGlbShowsTheSurfaceOfThePly) {
  for (const bool textured : {false, true}) {
    textured ? publish_textured() : publish_plain();
    for (const ExportSelection& selection : selections()) {
      run(selection, "a.ply");
      run(selection, "a.glb");
      EXPECT_EQ(Glb::read(at("a.glb")).all_facets(), facets_of_ply(*files_, at("a.ply")));
    }
  }
}

TEST_F(ExportPartsTest, AnObjShowsTheSurfaceOfThePly) {
  for (const Vec3d& origin : {Vec3d{}, Vec3d{500000.125, -3e6, 0.1}}) {
    publish_plain(origin);
    for (const ExportSelection& selection : selections()) {
      run(selection, "a.ply");
      run(selection, "a.obj");
      const Obj obj = Obj::read(at("a.obj"));
      const auto facets = origin == Vec3d{} ? as_floats(obj.facets) : obj.facets;
      EXPECT_EQ(sorted(facets), facets_of_ply(*files_, at("a.ply")));
      EXPECT_EQ(obj.places[0].size(), 6U);  // with its colour
    }
  }
  publish_textured();
  for (const ExportSelection& selection : selections()) {
    run(selection, "a.ply");
    run(selection, "a.obj");
    EXPECT_EQ(sorted(as_floats(Obj::read(at("a.obj")).facets)),
              facets_of_ply(*files_, at("a.ply")));
  }
}

/// Returns the interior triangles of a tile of a cut of its own level, with texture coordinates.
std::vector<Facet> textured_interior(const PublishedTile& tile) {
  std::vector<Facet> facets;
  const std::size_t vertices = tile.mesh.vertices.size() + tile.mesh.copies.size();
  const VertexNumbers numbers(static_cast<std::uint32_t>(tile.mesh.vertices.size()),
                              tile.mesh.copies.places);
  for (const TileTriangle& t : shown_interior(tile)) {
    Facet& facet = facets.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t number = raw(t[c]);
      const std::uint32_t vertex =
          number < vertices ? number : tile.shading.split_of[number - vertices];
      const Vec3f& p = tile.mesh.vertices.positions[numbers[vertex].place];
      const Vec2f& uv = tile.shading.texcoords[number];
      facet[c] = {double{p.x}, double{p.y}, double{p.z}, double{uv.u}, double{uv.v}};
    }
  }
  return facets;
}

TEST_F(ExportPartsTest, EachTileHasItsPictureAndItsTexcoordsInAGlb) {
  for (const ImageFormat format :
       {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp, ImageFormat::ktx2}) {
    tests::Sample sample = publish_textured({format, 90, false});
    EXPECT_THAT(run(mixed_cut(), "a.glb"), HasSubstr("cut: 4 tiles, "));
    const Glb glb = Glb::read(at("a.glb"));
    const std::vector<NodeId> nodes{node(1, 0), node(2, 2), node(3, 6), node(3, 7)};
    ASSERT_EQ(glb.json["meshes"][0]["primitives"].size(), nodes.size());
    ASSERT_EQ(glb.json["images"].size(), nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const PublishedTile& tile = sample.tile(nodes[i]);
      const Json& primitive = glb.json["meshes"][0]["primitives"][i];
      EXPECT_EQ(primitive["material"], i);
      auto facets = glb.facets(primitive, true);
      EXPECT_GE(facets.size(), tile.mesh.interior.size());
      facets.resize(tile.mesh.interior.size());
      EXPECT_EQ(facets, textured_interior(tile));
      const auto view = glb.json["images"][i]["bufferView"].get<std::size_t>();
      EXPECT_EQ(glb.json["bufferViews"][view]["byteLength"], tile.image.bytes.size());
      EXPECT_TRUE(std::equal(tile.image.bytes.begin(), tile.image.bytes.end(), glb.at(view)));
    }
    const bool is_plain = format == ImageFormat::jpeg || format == ImageFormat::png;
    EXPECT_EQ(glb.json.value("extensionsRequired", Json::array()).dump(),
              is_plain                      ? "[]"
              : format == ImageFormat::webp ? R"(["EXT_texture_webp"])"
                                            : R"(["KHR_texture_basisu"])");
  }
}

TEST_F(ExportPartsTest, EachTileHasItsPictureAndItsTexcoordsInAnObj) {
  tests::Sample sample = publish_textured({}, AlphaMode::mask);
  run(mixed_cut(), "a.obj");
  const Obj obj = Obj::read(at("a.obj"));
  EXPECT_EQ(obj.mtllib, "a.mtl");
  const std::string materials = text_of(at("a.mtl"));
  EXPECT_EQ(obj.by_material.size(), 4U);
  for (const NodeId id : {node(1, 0), node(2, 2), node(3, 6), node(3, 7)}) {
    const std::string name = fmt::format("{:02}_{:06}", raw(id.level), id.index);
    const PublishedTile& tile = sample.tile(id);
    ASSERT_TRUE(obj.by_material.contains(name));
    auto facets = as_floats(obj.by_material.at(name));
    facets.resize(tile.mesh.interior.size());
    const auto expected = textured_interior(tile);
    for (std::size_t t = 0; t < facets.size(); ++t) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < 5; ++k)  // v is turned twice
          ASSERT_NEAR(facets[t][c][k], expected[t][c][k], k < 3 ? 0 : 1e-7);
      }
    }
    EXPECT_THAT(materials, HasSubstr("newmtl " + name + "\n"));
    EXPECT_THAT(materials, HasSubstr("map_Kd a_textures/" + name + ".png\n"));
    EXPECT_THAT(materials, HasSubstr("map_d a_textures/" + name + ".png\n"));
    const std::string bytes = text_of(at("a_textures") / (name + ".png"));
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(bytes)), tile.image.bytes));
  }
}

TEST_F(ExportPartsTest, AnObjHasPngsInsteadOfOthers) {
  for (const ImageFormat format : {ImageFormat::webp, ImageFormat::ktx2}) {
    if (const std::string missing = images::missing_for_ktx2();
        format == ImageFormat::ktx2 && !missing.empty()) {
      std::cout << "KTX2 is skipped: " << missing << '\n';
      continue;
    }
    publish_textured({format, 90, true});
    run(Level{0}, "a.obj");
    const std::string bytes = text_of(at("a_textures/00_000000.png"));
    const images::Image image =
        images::decode_image(std::as_bytes(std::span(bytes)), "a picture", 1000);
    EXPECT_EQ(image.width, 16U);
    EXPECT_EQ(image.height, 8U);
    EXPECT_NEAR(image.at(3, 3)[0], 200, format == ImageFormat::ktx2 ? 4 : 0);
    std::filesystem::remove(at("a.obj"));
    std::filesystem::remove(at("a.mtl"));
    std::filesystem::remove_all(at("a_textures"));
  }
}

TEST_F(ExportPartsTest, TheEndingCountsHoweverItIsWritten) {
  publish_textured();
  run(Level{1}, "a.GLB");
  EXPECT_EQ(text_of(at("a.GLB")).substr(0, 4), "glTF");
  run(Level{1}, "a.Obj");
  EXPECT_EQ(text_of(at("a.Obj")).substr(0, 1), "#");
}

TEST_F(ExportPartsTest, APlySaysThatItHasNoTextures) {
  publish_textured();
  EXPECT_THAT(run(Level{1}, "a.ply"), HasSubstr("without textures"));
  EXPECT_THAT(run(OutlineSelection{}, "a.ply"), Not(HasSubstr("without textures")));
  EXPECT_THAT(run(Level{1}, "a.glb"), Not(HasSubstr("without textures")));
  publish_plain();
  EXPECT_THAT(run(Level{1}, "a.ply"), Not(HasSubstr("without textures")));
}

TEST_F(ExportPartsTest, WhatIsThereIsNotReplacedUnasked) {
  publish_textured();
  run(Level{1}, "a.obj");
  const std::string before = text_of(at("a.mtl"));
  EXPECT_EQ(error_of(Level{2}, "a.obj", false).code(), ErrorCode::exists);
  fs::remove(at("a.obj"));
  EXPECT_EQ(error_of(Level{2}, "a.obj", false).code(), ErrorCode::exists);
  fs::remove_all(at("a_textures"));
  EXPECT_EQ(error_of(Level{2}, "a.obj", false).code(), ErrorCode::exists);
  EXPECT_EQ(text_of(at("a.mtl")), before);
  EXPECT_FALSE(fs::exists(at("a.obj")) || fs::exists(at("a_textures")));
  run(Level{2}, "a.obj");
  EXPECT_TRUE(fs::exists(at("a_textures/02_000003.jpg")));
  run(Level{1}, "a.obj");
  EXPECT_FALSE(fs::exists(at("a_textures/02_000003.jpg")));
  EXPECT_TRUE(fs::exists(at("a_textures/01_000001.jpg")));
}

TEST_F(ExportPartsTest, AFolderOfOthersIsNotReplaced) {
  publish_textured();
  fs::create_directory(at("a_textures"));
  for (const std::string name : {"scan.jpg", "2_000001.jpg", "02_000001.jpg.bak"}) {
    const fs::path mine = at("a_textures") / name;
    std::ofstream(mine) << "mine";
    const Error error = error_of(Level{1}, "a.obj", true);
    EXPECT_EQ(error.code(), ErrorCode::exists);
    EXPECT_THAT(error.what(), HasSubstr("holds " + name + ", which no export made"));
    EXPECT_EQ(text_of(mine), "mine");
    EXPECT_FALSE(fs::exists(at("a.obj")) || fs::exists(at("a.mtl")));
    fs::remove(mine);
  }
  fs::remove(at("a_textures"));
  fs::create_directory(at("elsewhere"));
  fs::create_directory_symlink(at("elsewhere"), at("a_textures"));
  EXPECT_EQ(error_of(Level{1}, "a.obj", true).code(), ErrorCode::exists);
  EXPECT_TRUE(fs::is_symlink(at("a_textures")));
}

TEST_F(ExportPartsTest, AFailureLeavesNothing) {
  publish_textured();
  std::string tile = text_of(hierarchy() / "tiles/03/000007.glb");
  tile[tile.size() / 2] = static_cast<char>(tile[tile.size() / 2] ^ 1);
  std::ofstream(hierarchy() / "tiles/03/000007.glb", std::ios::binary) << tile;
  for (const std::string name : {"a.glb", "a.obj"})
    EXPECT_EQ(error_of(Level{3}, name).code(), ErrorCode::corrupt);
  std::size_t left = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(directory_.path()))
    ++left;
  EXPECT_EQ(left, 1U);  // the hierarchy
}

TEST_F(ExportPartsTest, WhatCannotBeShownIsRefused) {
  publish_textured();
  EXPECT_EQ(error_of(OutlineSelection{}, "a.glb").code(), ErrorCode::usage);
  EXPECT_EQ(error_of(node(4, 0), "a.glb").code(), ErrorCode::usage);
  publish(tests::make_sample(tests::points(100), {4, 20, false, false, {}}));
  EXPECT_EQ(error_of(Level{1}, "a.glb").code(), ErrorCode::usage);
  EXPECT_FALSE(fs::exists(at("a.glb")));
}

}  // namespace
}  // namespace meshhier::exporting
