// Computed normals are beside the mesh: they change nothing of it, and both sides of a seam have
// the same.
#include "bench/generator.h"
#include "bench/split.h"
#include "bench/stress.h"
#include "config/config.h"
#include "hierarchy/vertex_numbers.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/same_tile.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/simplify_methods.h"
#include "verify/verify.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using bench::LoadedMesh;
using config::Normals;
using testing::IsEmpty;
using tests::loaded;

struct ShadedHierarchy {
  std::vector<PublishedTile> tiles;
  std::vector<std::string> problems;
};

ShadedHierarchy build_shaded(const LoadedMesh& mesh, const config::SimplifyConfig& simplify,
                             Normals normals) {
  const tests::TemporaryDirectory directory;
  const auto files = storage::make_posix_file_system();
  config::Config config = tests::quick_config();
  config.input = directory.path() / "mesh.ply";
  config.output = directory.path() / "mesh.hier";
  bench::write_ply(*files, {directory.path() / "mesh.ply"}, *bench::as_generated(mesh));
  config.partition.count = 21;
  config.simplify = simplify;
  config.simplify.vertices = 70;
  config.storage.normals = normals;
  execution::NoProgress progress;
  build_hierarchy(config, {}, {*files, progress, execution::CancelToken()});
  const storage::HierarchyReader reader(*files, config.output);
  EXPECT_EQ(reader.manifest().computed_normals, normals == Normals::smooth);
  ShadedHierarchy built;
  for (const TileRecord& record : reader.records())
    built.tiles.push_back(reader.read_tile(record.node));
  built.problems =
      verifying::verify_hierarchy(*files, config.output, {.input = config.input, .cuts = 3},
                                  progress, execution::CancelToken())
          .problems;
  return built;
}

/// A corner with the normal that it shows.
using ShownCorner = std::pair<std::array<float, 3>, NormalCode>;
using ShownTriangle = std::array<ShownCorner, 3>;

class ShownTile {
 public:
  explicit ShownTile(const PublishedTile& tile)
      : tile_(tile),
        numbers_(static_cast<std::uint32_t>(tile.mesh.vertices.size()), tile.mesh.copies.places) {}

  std::vector<ShownTriangle> interior() const {
    return shown(tile_.mesh.interior, tile_.mesh.interior_wedges, tile_.shading.interior);
  }
  std::vector<ShownTriangle> border() const {
    return shown(tile_.mesh.border, tile_.mesh.border_wedges, tile_.shading.border);
  }

 private:
  std::vector<ShownTriangle> shown(const std::vector<TileTriangle>& triangles,
                                   const std::vector<CornerWedges>& wedges,
                                   const std::vector<TileTriangle>& split) const {
    const auto corners = split.empty() ? numbers_.numbered(triangles, wedges) : split;
    std::vector<ShownTriangle> result(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f p = tile_.mesh.vertices.positions[raw(triangles[t][k])];
        result[t][k] = {{p.x, p.y, p.z}, tile_.shading.normals.at(raw(corners[t][k]))};
      }
      std::ranges::rotate(result[t], std::ranges::min_element(result[t]));
    }
    return result;
  }

  const PublishedTile& tile_;
  VertexNumbers numbers_;
};

struct ShadedMesh {
  std::string name;
  LoadedMesh mesh;
};

std::vector<ShadedMesh> shaded_meshes() {
  std::vector<ShadedMesh> all{{"cube", loaded(tests::cube(18))},
                              {"torus", loaded(tests::torus(3000, 0.03F))},
                              {"knots", loaded(tests::non_manifold(2000, 0.1F))},
                              {"mirrored", bench::make_stress("mirrored", 3000)},
                              {"repeated", bench::make_stress("repeated", 3000)},
                              {"tangle", bench::make_stress("tangle", 3000)}};
  for (const char* how : {"charts", "face_colours", "soup"})
    all.push_back({std::string("cube in ") + how, bench::split(loaded(tests::cube(18)), how, 40)});
  return all;
}

TEST(ComputedNormals, SLOW_ChangeNothingOfTheMesh) {
  for (const auto& [name, mesh] : shaded_meshes()) {
    for (const auto& [method_name, method] : tests::all_simplify_methods()) {
      SCOPED_TRACE(name + ", " + method_name);
      const ShadedHierarchy with = build_shaded(mesh, method, Normals::smooth);
      const ShadedHierarchy without = build_shaded(mesh, method, Normals::none);
      EXPECT_THAT(with.problems, IsEmpty());
      EXPECT_THAT(without.problems, IsEmpty());
      ASSERT_EQ(with.tiles.size(), without.tiles.size());
      for (std::size_t i = 0; i < with.tiles.size(); ++i) {
        PublishedTile bare = with.tiles[i];
        bare.shading = {};
        tests::expect_same_mesh(bare, without.tiles[i]);
        tests::expect_same_attributes(bare, without.tiles[i]);
        ASSERT_FALSE(with.tiles[i].shading.empty());
        ASSERT_TRUE(without.tiles[i].shading.empty());
      }
    }
  }
}

// Each border triangle is in several tiles of a level, told by its positions alone.
TEST(ComputedNormals, AreTheSameOnBothSidesOfASeam) {
  for (const auto& [name, mesh] : shaded_meshes()) {
    if (name == "mirrored" || name == "repeated" || name == "tangle")
      continue;  // triangles of equal positions
    for (const auto& [method_name, method] : tests::all_simplify_methods()) {
      SCOPED_TRACE(name + ", " + method_name);
      const ShadedHierarchy built = build_shaded(mesh, method, Normals::smooth);
      std::map<std::pair<int, std::array<std::array<float, 3>, 3>>, ShownTriangle> seen;
      std::size_t compared = 0;
      for (const PublishedTile& tile : built.tiles) {
        for (const ShownTriangle& t : ShownTile(tile).border()) {
          const std::array<std::array<float, 3>, 3> places{t[0].first, t[1].first, t[2].first};
          const auto [other, is_new] = seen.try_emplace({int{raw(tile.node.level)}, places}, t);
          compared += std::size_t{!is_new};
          ASSERT_EQ(other->second, t);
        }
      }
      EXPECT_GT(compared, 100U);
    }
  }
}

TEST(ComputedNormals, OfACubeAreThoseOfItsSidesInAllPartitions) {
  for (const char* how : {"", "charts", "face_colours", "soup"}) {
    SCOPED_TRACE(how);
    const LoadedMesh cube = loaded(tests::cube(18));
    const std::string name = how;
    const ShadedHierarchy built =
        build_shaded(name.empty() ? cube : bench::split(cube, name, 40), {}, Normals::smooth);
    std::size_t splits = 0;
    const auto check = [](const std::vector<ShownTriangle>& triangles) {
      for (const ShownTriangle& t : triangles) {
        const auto at = [&](std::size_t k) {
          const auto& p = t[k].first;
          return Vec3d{p[0], p[1], p[2]};
        };
        const NormalCode side = normal_code(cross(at(1) - at(0), at(2) - at(0)));
        for (const ShownCorner& corner : t)
          ASSERT_EQ(corner.second, side);
      }
    };
    for (const PublishedTile& tile : built.tiles) {
      if (tile.node.level != built.tiles.back().node.level)
        continue;
      check(ShownTile(tile).interior());
      check(ShownTile(tile).border());
      splits += tile.shading.split_of.size();
    }
    EXPECT_EQ(splits > 0, name.empty() || name == "face_colours");
  }
}

/// Random triangles of vertices at 27 places, with texture coordinates: many have the same places.
std::string soup_with_texcoords(std::uint32_t seed) {
  std::uint32_t state = seed;
  const auto below = [&](std::uint32_t limit) {
    state = state * 1664525 + 1013904223;
    return (state >> 8) % limit;
  };
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 60\nproperty float x\nproperty float y\n"
      "property float z\nproperty float s\nproperty float t\nelement face 120\n"
      "property list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 60; ++i)
    text += fmt::format("{} {} {} 0.{} 0.{}\n", below(3), below(3), below(3), below(99), below(99));
  for (int i = 0; i < 120; ++i)
    text += fmt::format("3 {} {} {}\n", below(60), below(60), below(60));
  return text;
}

/// With these counts of partitions some stand for their parents, beside simplified tiles.
TEST(ComputedNormals, AgreeAtBordersOfPartitionsThatStandForTheirParents) {
  const tests::TemporaryDirectory directory;
  const auto files = storage::make_posix_file_system();
  execution::NoProgress progress;
  config::Config config = tests::quick_config();
  config.input = directory.path() / "soup.ply";
  config.output = directory.path() / "soup.hier";
  config.simplify.vertices = 5;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const std::string soup = soup_with_texcoords(seed);
    storage::write_file(*files, config.input[0], std::as_bytes(std::span(soup)));
    for (const std::uint32_t count : {3U, 5U, 6U, 7U}) {
      for (const auto method :
           {cluster_simplify::Method::edge_collapse, cluster_simplify::Method::half_edge,
            cluster_simplify::Method::cluster}) {
        config.partition.count = count;
        config.simplify.method = method;
        BuildOptions options;
        options.force = true;
        build_hierarchy(config, options, {*files, progress, execution::CancelToken()});
        EXPECT_THAT(verifying::verify_hierarchy(*files, config.output, {.input = config.input},
                                                progress, execution::CancelToken())
                        .problems,
                    IsEmpty())
            << seed << ", " << count << " partitions, method " << static_cast<int>(method);
      }
    }
  }
}

}  // namespace
}  // namespace meshhier::pipeline
