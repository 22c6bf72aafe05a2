// Tests of vertices' attributes: kept in partitions, averaged in representatives.
#include "hierarchy/attributes.h"

#include "base/srgb.h"
#include "mesh_io/ply_writer.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using tests::TestMesh;

/// A vertex bit for bit: position and attributes.
using Row = std::vector<float>;

class AttributesTest : public testing::Test {
 protected:
  void build(const mesh_io::PlyContent& content, const auto& positions,
             const std::vector<float>& attributes, const TestMesh& mesh,
             config::Representative kind) {
    config::Config config = tests::quick_config();
    config.input = directory_.path() / "mesh.ply";
    config.output = directory_.path() / "mesh.hier";
    config.threads = 2;
    config.partition.vertices = 150;
    config.simplify.method = config::SimplifyMethod::cluster;  // its attributes are means, exactly
    config.simplify.representative = kind;
    mesh_io::PlyWriter writer(files_->create(config.input.front()), content);
    writer.write_vertices(std::span(positions), attributes);
    writer.write_triangles(mesh.triangles);
    writer.finish();
    execution::NoProgress progress;
    pipeline::build_hierarchy(config, {.force = true},
                              {*files_, progress, execution::CancelToken()});
    reader_.emplace(*files_, config.output);
    read_tiles();
  }

  void build(const TestMesh& mesh, const AttributeLayout& layout,
             const std::vector<float>& attributes, config::Representative kind) {
    mesh_io::PlyContent content;
    content.vertex_count = mesh.positions.size();
    content.triangle_count = mesh.triangles.size();
    content.attributes = layout;
    build(content, mesh.positions, attributes, mesh, kind);
  }

  void read_tiles() {
    tiles_.clear();
    weights_.clear();
    for (const TileRecord& record : reader_->records())
      tiles_.emplace(record.node, reader_->read_tile(record.node));
    // From the partitions up: how many original vertices each vertex stands for.
    for (auto tile = tiles_.rbegin(); tile != tiles_.rend(); ++tile) {
      const auto& [node, published] = *tile;
      std::vector<double>& weights = weights_[node];
      if (reader_->tree().is_partition(node))
        weights.assign(published.mesh.own_count, 1);
      if (node.level == Level{0})
        continue;
      NodeId parent = reader_->tree().parent(node);
      if (reader_->tree().is_early(parent))
        parent = reader_->tree().parent(parent);
      std::vector<double>& above = weights_[parent];
      above.resize(tiles_.at(parent).mesh.own_count);
      for (std::size_t i = 0; i < weights.size(); ++i)
        above.at(published.parent_map.at(i)) += weights[i];
    }
  }

  const Tree& tree() const { return reader_->tree(); }

  /// The number of a channel, or its light.
  static double amount(std::size_t channel, float number) {
    return channel >= 3 && channel < 6 ? 255 * light_of(number / 255.0) : double{number};
  }

  /// The mean of a channel over the original vertices, as a level shows it.
  double mean_of_level(Level level, std::size_t channel) const {
    double sum = 0;
    double weight = 0;
    for (const auto& [node, tile] : tiles_) {
      const bool is_shown = node.level == level || tree().is_early({level, parent_index(node)});
      const bool is_below = node.level == finer(level) && is_shown;
      if (node.level != level && !is_below)
        continue;
      for (std::size_t i = 0; i < tile.mesh.own_count; ++i) {
        const double w = weights_.at(node)[i];
        sum += w * amount(channel, tile.mesh.vertices.attributes_of(i)[channel]);
        weight += w;
      }
    }
    EXPECT_EQ(weight, static_cast<double>(tree().vertex_count()));
    return sum / weight;
  }

  std::uint32_t parent_index(NodeId node) const {
    return node.level == Level{0} ? 0 : tree().parent(node).index;
  }

  std::vector<Row> partition_rows() const {
    std::vector<Row> rows;
    for (const auto& [node, tile] : tiles_) {
      if (!tree().is_partition(node))
        continue;
      for (std::size_t i = 0; i < tile.mesh.own_count; ++i) {
        const Vec3f p = tile.mesh.vertices.positions[i];
        Row row{p.x, p.y, p.z};
        const auto values = tile.mesh.vertices.attributes_of(i);
        row.insert(row.end(), values.begin(), values.end());
        rows.push_back(std::move(row));
      }
    }
    std::ranges::sort(rows);
    return rows;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::optional<storage::HierarchyReader> reader_;
  std::map<NodeId, PublishedTile> tiles_;
  std::map<NodeId, std::vector<double>> weights_;
};

constexpr std::array kAll{config::Representative::mean, config::Representative::quadric,
                          config::Representative::vertex};

AttributeLayout rich_layout() {
  AttributeLayout layout;
  layout.normals = true;
  layout.colour = ColourType::u8;
  layout.alpha = true;
  layout.texcoords = true;
  return layout;
}

/// A screen's number of a light.
double number_of(double light) {
  return 255 * value_of(light);
}

/// Linear in the position, colours in light: means of it are the ramp at the mean position.
std::array<double, 6> ramp(Vec3f p) {
  return {number_of(0.5 + 0.3 * double{p.x}),
          number_of(0.5 - 0.25 * double{p.y}),
          number_of(0.5 + 0.2 * double{p.z}),
          100 + 60 * double{p.x} - 30 * double{p.z},
          double{p.x} * 0.5,
          3 - double{p.y}};
}

/// Outward normals, a colour ramp with alpha, and texture coordinates.
std::vector<float> rich_attributes(const TestMesh& mesh, bool whole_numbers) {
  std::vector<float> attributes;
  for (const Vec3f p : mesh.positions) {
    const Vec3d wide = to_double(p);
    const Vec3f normal = to_float(wide * (1 / length(wide)));
    const std::array<double, 6> r = ramp(p);
    attributes.insert(attributes.end(), {normal.x, normal.y, normal.z});
    for (std::size_t k = 0; k < 6; ++k) {
      const double value = whole_numbers && k < 4 ? std::round(r[k]) : r[k];
      attributes.push_back(static_cast<float>(value));
    }
  }
  return attributes;
}

TEST_F(AttributesTest, PartitionsKeepEveryBit) {
  const TestMesh mesh = tests::shuffled(tests::sphere(4000, 0.01F), 4);
  std::vector<float> attributes = rich_attributes(mesh, true);
  for (std::size_t v = 0; v < mesh.positions.size(); v += 17)
    attributes[9 * v] *= 3;  // a normal that is not of unit length
  build(mesh, rich_layout(), attributes, config::Representative::quadric);
  std::vector<Row> expected;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = mesh.positions[v];
    Row row{p.x, p.y, p.z};
    row.insert(row.end(), attributes.begin() + static_cast<std::ptrdiff_t>(9 * v),
               attributes.begin() + static_cast<std::ptrdiff_t>(9 * v + 9));
    expected.push_back(std::move(row));
  }
  std::ranges::sort(expected);
  EXPECT_EQ(partition_rows(), expected);
}

TEST_F(AttributesTest, ARampStaysARampAtEveryLevel) {
  const TestMesh mesh = tests::sphere(6000, 0.01F);
  build(mesh, rich_layout(), rich_attributes(mesh, true), config::Representative::mean);
  std::size_t simplified = 0;
  for (const auto& [node, tile] : tiles_) {
    if (tree().is_partition(node))
      continue;
    ++simplified;
    for (std::size_t i = 0; i < tile.mesh.vertices.size(); ++i) {
      const auto values = tile.mesh.vertices.attributes_of(i);
      const std::array<double, 6> expected = ramp(tile.mesh.vertices.positions[i]);
      for (std::size_t k = 0; k < 4; ++k)  // rounded in the input, and once more in the file
        ASSERT_NEAR(double{values[3 + k]}, expected[k], 1.01) << "channel " << k;
      for (std::size_t k = 4; k < 6; ++k)
        ASSERT_NEAR(double{values[3 + k]}, expected[k], 1e-4) << "channel " << k;
    }
  }
  EXPECT_GT(simplified, 10U);
}

TEST_F(AttributesTest, EveryLevelHasTheMeanOfTheInput) {
  const TestMesh mesh = tests::torus(6000, 0.01F);
  const std::vector<float> attributes = rich_attributes(mesh, true);
  for (const config::Representative kind : kAll) {
    build(mesh, rich_layout(), attributes, kind);
    for (std::size_t channel = 3; channel < 9; ++channel) {
      double mean = 0;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        mean += amount(channel, attributes[9 * v + channel]) /
                static_cast<double>(mesh.positions.size());
      for (int level = 0; level <= raw(tree().depth()); ++level) {
        // Colours are rounded in the files, halves up: where each stands for two, that is a
        // quarter on average. More would mean that the rounding of one level enters the next.
        EXPECT_NEAR(mean_of_level(static_cast<Level>(level), channel), mean,
                    channel < 6   ? 0.6
                    : channel < 7 ? 0.3
                                  : 1e-4)
            << "channel " << channel << ", level " << level;
      }
    }
  }
}

TEST_F(AttributesTest, EqualValuesStayEqual) {
  AttributeLayout layout;
  layout.colour = ColourType::u8;
  layout.alpha = true;
  const TestMesh mesh = tests::sphere(5000, 0.01F);
  std::vector<float> attributes;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    attributes.insert(attributes.end(), {255, 0, 17, 128});
  for (const config::Representative kind : kAll) {
    build(mesh, layout, attributes, kind);
    for (const auto& [node, tile] : tiles_) {
      for (std::size_t i = 0; i < tile.mesh.vertices.size(); ++i) {
        const auto values = tile.mesh.vertices.attributes_of(i);
        ASSERT_EQ(std::vector<float>(values.begin(), values.end()),
                  (std::vector<float>{255, 0, 17, 128}));
      }
    }
  }
}

TEST_F(AttributesTest, NormalsOfRepresentativesHaveUnitLengthAndPointOutwards) {
  const TestMesh mesh = tests::sphere(6000, 0.005F);
  build(mesh, rich_layout(), rich_attributes(mesh, true), config::Representative::quadric);
  for (const auto& [node, tile] : tiles_) {
    for (std::size_t i = 0; i < tile.mesh.vertices.size(); ++i) {
      const auto values = tile.mesh.vertices.attributes_of(i);
      const Vec3d normal{double{values[0]}, double{values[1]}, double{values[2]}};
      ASSERT_NEAR(length(normal), 1, 1e-5);
      const Vec3d p = to_double(tile.mesh.vertices.positions[i]);
      ASSERT_GT(dot(normal, p * (1 / length(p))), 0.9);
    }
  }
}

TEST_F(AttributesTest, NormalsThatCancelOutAreStillUnitNormalsInTheFiles) {
  AttributeLayout layout;
  layout.normals = true;
  const TestMesh mesh = tests::points(1000);
  std::vector<float> attributes;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    attributes.insert(attributes.end(), {0, 0, 0});
  build(mesh, layout, attributes, config::Representative::mean);
  for (const auto& [node, tile] : tiles_) {
    for (std::size_t i = 0; i < tile.mesh.own_count; ++i) {
      const auto n = tile.mesh.vertices.attributes_of(i);
      const double size = std::hypot(double{n[0]}, double{n[1]}, double{n[2]});
      ASSERT_NEAR(size, tree().is_partition(node) ? 0 : 1, 1e-5);
    }
  }
}

TEST_F(AttributesTest, AGhostCarriesWhatItsVertexCarries) {
  const TestMesh mesh = tests::sphere(4000, 0.01F);
  build(mesh, rich_layout(), rich_attributes(mesh, true), config::Representative::quadric);
  std::size_t ghosts = 0;
  for (const auto& [node, tile] : tiles_) {
    for (std::size_t g = 0; g < tile.mesh.ghosts.size(); ++g) {
      const GhostRef ref = tile.mesh.ghosts[g];
      NodeId neighbour{node.level, ref.tile};
      if (tree().is_early(neighbour))
        neighbour = tree().children(neighbour).nodes[0];
      const VertexArray& there = tiles_.at(neighbour).mesh.vertices;
      const auto here = tile.mesh.vertices.attributes_of(tile.mesh.own_count + g);
      ASSERT_TRUE(std::ranges::equal(here, there.attributes_of(ref.index)));
      ++ghosts;
    }
  }
  EXPECT_GT(ghosts, 1000U);
}

// ---- double coordinates --------------------------------------------------------------------

std::vector<Vec3d> geographic(const TestMesh& mesh) {
  std::vector<Vec3d> points;
  for (const Vec3f p : mesh.positions) {
    points.push_back({500123.4567 + 40 * double{p.x}, 5812345.6789 + 40 * double{p.y},
                      112.3 + 40 * double{p.z}});
  }
  return points;
}

TEST_F(AttributesTest, GeographicCoordinatesAreKeptRelativeToTheOrigin) {
  const TestMesh mesh = tests::sphere(5000, 0.01F);
  const std::vector<Vec3d> points = geographic(mesh);
  mesh_io::PlyContent content;
  content.vertex_count = points.size();
  content.triangle_count = mesh.triangles.size();
  content.double_coordinates = true;
  build(content, points, {}, mesh, config::Representative::quadric);

  const Vec3d origin = reader_->manifest().origin;
  EXPECT_TRUE(reader_->manifest().source.double_precision);
  std::vector<Row> expected;
  for (const Vec3d p : points) {
    const Vec3f stored = to_float(p - origin);
    expected.push_back({stored.x, stored.y, stored.z});
    EXPECT_LT(length(to_double(stored) + origin - p), 1e-5);  // a metre's hundred thousandth
  }
  std::ranges::sort(expected);
  EXPECT_EQ(partition_rows(), expected);
  for (const auto& [node, tile] : tiles_) {
    for (const Vec3f p : tile.mesh.vertices.positions)
      ASSERT_LT(length(to_double(p) + origin - Vec3d{500123.4567, 5812345.6789, 112.3}), 45);
  }
}

TEST_F(AttributesTest, CoordinatesAboutZeroHaveNoOrigin) {
  const TestMesh mesh = tests::sphere(3000, 0.01F);
  build(mesh, {}, {}, config::Representative::quadric);
  EXPECT_EQ(reader_->manifest().origin, Vec3d{});
  std::vector<Row> expected;
  for (const Vec3f p : mesh.positions)
    expected.push_back({p.x, p.y, p.z});
  std::ranges::sort(expected);
  EXPECT_EQ(partition_rows(), expected);
}

}  // namespace
}  // namespace meshhier::pipeline
