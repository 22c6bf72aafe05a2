// Values of vertices through whole builds: bit for bit in partitions, of the input's values where
// they are labels.
#include "base/error.h"
#include "config/config.h"
#include "export/cut_part.h"
#include "hierarchy/value_channels.h"
#include "mesh_io/mesh_source.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "verify/verify.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::TestMesh;

struct Column {
  std::string_view type, name;
  std::vector<double> values;
};

/// One of each type, of which wide ones are no floats.
std::vector<Column> columns_of(const TestMesh& mesh) {
  std::mt19937 random(3);
  std::vector<Column> columns{{"char", "a", {}},        {"uchar", "b", {}},    {"short", "c", {}},
                              {"ushort", "d", {}},      {"int", "id", {}},     {"uint", "hash", {}},
                              {"float", "quality", {}}, {"double", "time", {}}};
  for (const Vec3f p : mesh.positions) {
    const double cell = std::floor(4 * (p.x + 1)) + 8 * std::floor(4 * (p.y + 1));
    const bool is_missing = random() % 20 == 0;
    const double quality = is_missing ? std::numeric_limits<double>::quiet_NaN() : double{p.z};
    const double time = random() % 50 == 0 ? 1e-310 : 1.5e9 + double{p.x} * 1e-3;
    const double all[] = {cell - 30,   cell,       100 * cell, 900 * cell,
                          -1e9 - cell, 4e9 + cell, quality,    time};
    for (std::size_t i = 0; i < columns.size(); ++i)
      columns[i].values.push_back(all[i]);
  }
  return columns;
}

template <class T>
void put(std::string& text, T value, bool swapped) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (swapped)
    std::ranges::reverse(bytes);
  text.append(bytes.begin(), bytes.end());
}

void put_typed(std::string& text, std::string_view type, double value, bool swapped) {
  if (type == "char")
    put(text, static_cast<std::int8_t>(value), swapped);
  if (type == "uchar")
    put(text, static_cast<std::uint8_t>(value), swapped);
  if (type == "short")
    put(text, static_cast<std::int16_t>(value), swapped);
  if (type == "ushort")
    put(text, static_cast<std::uint16_t>(value), swapped);
  if (type == "int")
    put(text, static_cast<std::int32_t>(value), swapped);
  if (type == "uint")
    put(text, static_cast<std::uint32_t>(value), swapped);
  if (type == "float")
    put(text, static_cast<float>(value), swapped);
  if (type == "double")
    put(text, value, swapped);
}

enum class Form { little, big, text };

std::string ply_of(const TestMesh& mesh, const std::vector<Column>& columns, Form form) {
  const char* format = form == Form::little ? "binary_little_endian"
                       : form == Form::big  ? "binary_big_endian"
                                            : "ascii";
  std::string text =
      fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", format, mesh.positions.size());
  // Values stand before, between and behind the coordinates.
  text += fmt::format("property {} {}\nproperty float x\n", columns[0].type, columns[0].name);
  text += "property float y\nproperty float z\n";
  for (std::size_t i = 1; i < columns.size(); ++i)
    text += fmt::format("property {} {}\n", columns[i].type, columns[i].name);
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                      mesh.triangles.size());
  const bool swapped = (form == Form::big) != (std::endian::native == std::endian::big);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = mesh.positions[v];
    if (form == Form::text) {
      text += fmt::format("{} {} {} {}", columns[0].values[v], p.x, p.y, p.z);
      for (std::size_t i = 1; i < columns.size(); ++i) {
        const double value = columns[i].values[v];
        text += columns[i].type == "float" ? fmt::format(" {}", static_cast<float>(value))
                                           : fmt::format(" {}", value);
      }
      text += '\n';
      continue;
    }
    put_typed(text, columns[0].type, columns[0].values[v], swapped);
    for (const float x : {p.x, p.y, p.z})
      put(text, x, swapped);
    for (std::size_t i = 1; i < columns.size(); ++i)
      put_typed(text, columns[i].type, columns[i].values[v], swapped);
  }
  for (const auto& t : mesh.triangles) {
    if (form == Form::text) {
      text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
      continue;
    }
    text += '\3';
    for (const std::uint32_t corner : t)
      put(text, corner, swapped);
  }
  return text;
}

class ValuesTest : public testing::Test {
 protected:
  fs::path path(std::string_view name) const { return directory_.path() / name; }

  void write(const fs::path& file, const std::string& text) {
    storage::write_file(*files_, file, std::as_bytes(std::span(text)));
  }

  config::Config config(std::string_view input, std::string_view output) const {
    config::Config config = tests::quick_config();
    config.input = path(input);
    config.output = path(output);
    config.threads = 2;
    config.partition.vertices = 150;
    return config;
  }

  void build(const config::Config& config) {
    execution::NoProgress progress;
    build_hierarchy(config, {.force = true}, {*files_, progress, execution::CancelToken()});
  }

  /// Returns all values of one attribute on a level.
  std::vector<double> values_of(const storage::HierarchyReader& reader, std::size_t attribute,
                                int level) const {
    const AttributeLayout& layout = reader.tile_format().attributes;
    auto offset = layout.part(AttributeKind::values).first;
    for (std::size_t i = 0; i < attribute; ++i)
      offset += static_cast<std::size_t>(channels_of(layout.values[i].type));
    std::vector<double> values;
    for (const TileRecord& record : reader.records()) {
      if (raw(record.node.level) != level)
        continue;
      const PublishedTile tile = reader.read_tile(record.node);
      for (std::uint32_t v = 0; v < tile.mesh.own_count; ++v)
        values.push_back(value_in(layout.values[attribute].type,
                                  tile.mesh.vertices.attributes_of(v).data() + offset));
    }
    return values;
  }

  void expect_verified(std::string_view hierarchy, std::string_view input) {
    verifying::VerifyOptions options;
    options.input = path(input);
    execution::NoProgress progress;
    const verifying::VerifyReport report = verifying::verify_hierarchy(
        *files_, path(hierarchy), options, progress, execution::CancelToken());
    EXPECT_THAT(report.problems, testing::IsEmpty());
  }

  tests::TemporaryDirectory directory_{tests::TemporaryDirectory::Place::memory};
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  TestMesh mesh_ = tests::sphere(4000);
  std::vector<Column> columns_ = columns_of(mesh_);
};

std::vector<std::uint64_t> sorted_bits(std::span<const double> values) {
  std::vector<std::uint64_t> bits;
  for (const double value : values)
    bits.push_back(std::bit_cast<std::uint64_t>(value));
  std::ranges::sort(bits);
  return bits;
}

TEST_F(ValuesTest, SANITIZED_OfEveryTypeAreInThePartitionsBitForBit) {
  write(path("mesh.ply"), ply_of(mesh_, columns_, Form::little));
  for (const auto compression : {storage::Compression::none, storage::Compression::meshopt_zlib}) {
    config::Config c = config("mesh.ply", "mesh.hier");
    c.storage.compression = compression;
    build(c);
    const storage::HierarchyReader reader(*files_, path("mesh.hier"));
    ASSERT_EQ(reader.tile_format().attributes.values.size(), columns_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      EXPECT_EQ(reader.tile_format().attributes.values[i].name, columns_[i].name);
      std::vector<double> expected = columns_[i].values;
      if (columns_[i].type == "float")
        std::ranges::transform(expected, expected.begin(),
                               [](double x) { return static_cast<float>(x); });
      EXPECT_EQ(sorted_bits(values_of(reader, i, raw(reader.tree().depth()))),
                sorted_bits(expected))
          << columns_[i].name;
    }
    expect_verified("mesh.hier", "mesh.ply");
  }
}

TEST_F(ValuesTest, SANITIZED_OfEveryFormOfTheFileAreTheSame) {
  for (const auto& [form, name] :
       {std::pair(Form::little, "l"), {Form::big, "b"}, {Form::text, "t"}}) {
    write(path(fmt::format("{}.ply", name)), ply_of(mesh_, columns_, form));
    build(config(fmt::format("{}.ply", name), fmt::format("{}.hier", name)));
    expect_verified(fmt::format("{}.hier", name), fmt::format("{}.ply", name));
  }
  const auto tile = [&](std::string_view name) {
    return storage::read_file(*files_, path(name) / "tiles/00/000000.glb", UINT32_MAX);
  };
  EXPECT_EQ(tile("l.hier"), tile("b.hier"));
  EXPECT_EQ(tile("l.hier"), tile("t.hier"));
}

TEST_F(ValuesTest, SANITIZED_OfSimplifiedTilesLabelsAreTheInputs) {
  write(path("mesh.ply"), ply_of(mesh_, columns_, Form::little));
  for (const auto method : {config::SimplifyMethod::edge_collapse, config::SimplifyMethod::cluster,
                            config::SimplifyMethod::half_edge}) {
    config::Config c = config("mesh.ply", "mesh.hier");
    c.simplify.method = method;
    build(c);
    const storage::HierarchyReader reader(*files_, path("mesh.hier"));
    for (std::size_t i = 0; i < 6; ++i) {  // the integers
      const std::set<double> known(columns_[i].values.begin(), columns_[i].values.end());
      for (int level = 0; level < raw(reader.tree().depth()); ++level) {
        for (const double label : values_of(reader, i, level))
          ASSERT_TRUE(known.contains(label)) << columns_[i].name << ' ' << label;
      }
    }
    for (const double quality : values_of(reader, 6, 0))
      ASSERT_TRUE(std::isnan(quality) || std::abs(quality) <= 1);
  }
}

TEST_F(ValuesTest, SANITIZED_ThoseChosenAreKept) {
  write(path("mesh.ply"), ply_of(mesh_, columns_, Form::little));
  config::Config c = config("mesh.ply", "mesh.hier");
  c.attributes.which = mesh_io::AttributeChoice::Which::named;
  c.attributes.names = {"time", "b"};
  c.attributes.labels = {{"time"}};
  build(c);
  expect_verified("mesh.hier", "mesh.ply");
  const storage::HierarchyReader reader(*files_, path("mesh.hier"));
  EXPECT_THAT(reader.tile_format().attributes.values,
              ElementsAre(ScalarAttribute{"b", ValueType::u8, false},
                          ScalarAttribute{"time", ValueType::f64, true}));
  EXPECT_EQ(reader.manifest().source.unused.size(), 6U);

  c.attributes.which = mesh_io::AttributeChoice::Which::none;
  build(c);
  const storage::HierarchyReader without(*files_, path("mesh.hier"));
  EXPECT_EQ(without.manifest().format_version(), 12);
  EXPECT_EQ(without.manifest().source.unused.size(), 8U);
}

TEST_F(ValuesTest, SANITIZED_ANameThatTheInputDoesNotHaveIsRefused) {
  write(path("mesh.ply"), ply_of(mesh_, columns_, Form::little));
  config::Config c = config("mesh.ply", "mesh.hier");
  c.attributes.which = mesh_io::AttributeChoice::Which::named;
  c.attributes.names = {"qualty"};
  try {
    build(c);
    FAIL() << "built";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("qualty"));
    EXPECT_THAT(error.what(), HasSubstr("quality"));
  }
}

TEST_F(ValuesTest, SANITIZED_OfAnImportAreThoseOfTheFiles) {
  const TestMesh other = tests::torus(1000);
  const std::vector<Column> more = columns_of(other);
  write(path("a.ply"), ply_of(mesh_, columns_, Form::little));
  write(path("b.ply"), ply_of(other, more, Form::text));
  config::Config c = config("a.ply", "mesh.hier");
  c.input.push_back(path("b.ply"));
  build(c);
  const storage::HierarchyReader reader(*files_, path("mesh.hier"));
  std::vector<double> expected = columns_[4].values;
  expected.insert(expected.end(), more[4].values.begin(), more[4].values.end());
  EXPECT_EQ(sorted_bits(values_of(reader, 4, raw(reader.tree().depth()))), sorted_bits(expected));
  EXPECT_EQ(reader.manifest().source.values[4].labels.size(),
            std::set<double>(expected.begin(), expected.end()).size());
}

/// A label of each face: corners of a triangle have the same one, in every tile and in cuts that
/// mix levels, where ghosts become vertices of coarser tiles.
TEST_F(ValuesTest, SANITIZED_OfFacesStayOnTheirTriangles) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\n"
      "property int part\nend_header\n",
      mesh_.positions.size(), mesh_.triangles.size());
  for (const Vec3f p : mesh_.positions)
    text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  for (const auto& [a, b, c] : mesh_.triangles) {
    const Vec3f p = mesh_.positions[a];
    const int part = int(std::floor(2 * (p.x + 1))) + 4 * int(std::floor(2 * (p.y + 1)));
    text += fmt::format("3 {} {} {} {}\n", a, b, c, part - 7);
  }
  write(path("mesh.ply"), text);
  build(config("mesh.ply", "mesh.hier"));
  expect_verified("mesh.hier", "mesh.ply");
  const storage::HierarchyReader reader(*files_, path("mesh.hier"));
  ASSERT_GT(raw(reader.tree().depth()), 2);
  const std::vector<PlacedValue> values = placed_values(reader.tile_format().attributes);
  ASSERT_EQ(values.size(), 1U);
  const auto node = [](int level, std::uint32_t index) { return NodeId{Level(level), index}; };
  const std::vector<std::vector<NodeId>> cuts{{node(0, 0)},
                                              {node(1, 0), node(2, 2), node(2, 3)},
                                              {node(1, 1), node(2, 0), node(2, 1)},
                                              {node(2, 0), node(2, 1), node(2, 2), node(2, 3)}};
  for (const std::vector<NodeId>& nodes : cuts) {
    exporting::CutParts parts(reader, Cut(reader.tree(), nodes), 1 << 20);
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const exporting::CutPart part = parts.load(i);
      const auto label = [&](std::uint32_t vertex) {
        return value_in(values[0].type,
                        part.vertices.attributes_of(vertex).data() + values[0].channel);
      };
      for (const auto& [a, b, c] : part.triangles) {
        EXPECT_EQ(label(a), label(b)) << nodes.size();
        EXPECT_EQ(label(a), label(c)) << nodes.size();
        ++triangles;
      }
    }
    EXPECT_GT(triangles, 200U);
  }
}

}  // namespace
}  // namespace meshhier::pipeline
