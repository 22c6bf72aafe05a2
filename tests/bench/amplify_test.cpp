// Amplified meshes: every midpoint shared, nothing lost, nothing closed or torn.
#include "base/error.h"
#include "bench/generator.h"
#include "tests/bench/collected.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

struct EdgeCounts {
  std::size_t edges = 0;
  std::map<std::size_t, std::size_t> by_triangles;  ///< edges, by how many triangles they have
};

EdgeCounts edge_counts(const std::vector<MeshTriangle>& triangles) {
  std::map<tests::Edge, std::size_t> uses;
  for (const tests::Edge& edge : tests::undirected_edges(triangles))
    ++uses[edge];
  EdgeCounts counts{uses.size(), {}};
  for (const auto& [edge, count] : uses)
    ++counts.by_triangles[count];
  return counts;
}

struct NamedMesh {
  std::string name;
  tests::TestMesh mesh;
};

std::vector<NamedMesh> amplifiable_meshes() {
  tests::TestMesh with_loose_vertex = tests::open_grid(3, 2);
  with_loose_vertex.positions.insert(with_loose_vertex.positions.begin() + 5, {9, 9, 9});
  for (MeshTriangle& t : with_loose_vertex.triangles) {
    for (std::uint32_t& v : t)
      v += v >= 5 ? 1 : 0;
  }
  return {{"sphere", tests::sphere(200, 0.02f)},
          {"torus", tests::torus(150)},
          {"open grid", tests::open_grid(7, 4, 0.2f)},
          {"loose vertex", with_loose_vertex},
          {"moebius", tests::moebius(64)},
          {"non-manifold", tests::non_manifold(60)},
          {"duplicates", tests::duplicates(200)},
          {"soup", tests::soup(9)},
          {"points", tests::points(5)},
          {"nothing", {}}};
}

TEST(Amplify, every_step_makes_four_triangles_and_shares_every_midpoint) {
  for (const auto& [name, mesh] : amplifiable_meshes()) {
    SCOPED_TRACE(name);
    const EdgeCounts before = edge_counts(mesh.triangles);
    for (const int times : {0, 1, 2, 3}) {
      const std::size_t m = std::size_t{1} << times;
      const Collected result = collect(*amplify(loaded(mesh), {.times = times}));
      EXPECT_EQ(result.triangles.size(), mesh.triangles.size() * m * m);
      EXPECT_EQ(result.positions.size(), mesh.positions.size() + before.edges * (m - 1) +
                                             mesh.triangles.size() * (m - 1) * (m - 2) / 2);
      const EdgeCounts after = edge_counts(result.triangles);
      const std::size_t inner = mesh.triangles.size() * 3 * m * (m - 1) / 2;
      for (const auto& [triangles, count] : before.by_triangles) {
        // Copies of a triangle share what lies next to their corners too.
        if (name == "duplicates" && triangles > 1)
          continue;
        const std::size_t new_ones = triangles == 2 ? inner : 0;
        EXPECT_EQ(after.by_triangles.count(triangles) ? after.by_triangles.at(triangles) : 0,
                  count * m + new_ones)
            << triangles << " triangles at an edge";
      }
      std::vector<bool> used(result.positions.size());
      for (const MeshTriangle& t : result.triangles) {
        for (const std::uint32_t v : t) {
          ASSERT_LT(v, used.size());
          used[v] = true;
        }
      }
      EXPECT_TRUE(std::all_of(used.begin() + static_cast<std::ptrdiff_t>(mesh.positions.size()),
                              used.end(), [](bool u) { return u; }));
    }
  }
}

TEST(Amplify, keeps_the_original_vertices_first_and_bit_for_bit) {
  for (const auto& [name, mesh] : amplifiable_meshes()) {
    const Collected result = collect(*amplify(loaded(mesh), {.times = 2, .displacement = 0.2}));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      ASSERT_EQ(result.positions[v], to_double(mesh.positions[v])) << name << ' ' << v;
  }
}

TEST(Amplify, a_closed_surface_stays_closed_and_without_repeated_positions) {
  const tests::TestMesh sphere = tests::sphere(500, 0.01f);
  const Collected result = collect(*amplify(loaded(sphere), {.times = 3}));
  EXPECT_TRUE(tests::is_closed(result.triangles));
  EXPECT_TRUE(has_one_ring_everywhere(result));
  EXPECT_EQ(tests::euler_characteristic(result.triangles), 2);
  EXPECT_FALSE(has_repeated_position(result.positions));
}

TEST(Amplify, without_displacement_the_surface_is_the_same) {
  tests::TestMesh mesh = tests::open_grid(5, 5, 0.3f);
  LoadedMesh input = loaded(mesh);
  input.double_coordinates = true;
  const Collected before = collect(*amplify(input, {.times = 0}));
  const Collected after = collect(*amplify(input, {.times = 3, .displacement = 0}));
  EXPECT_NEAR(area(after), area(before), 1e-12 * area(before));
  for (std::size_t t = 0; t < after.triangles.size(); ++t) {
    const auto normal = [](const Collected& m, const MeshTriangle& c) {
      return cross(m.positions[c[1]] - m.positions[c[0]], m.positions[c[2]] - m.positions[c[0]]);
    };
    const Vec3d parent = normal(before, before.triangles[t / 64]);
    const Vec3d child = normal(after, after.triangles[t]);
    ASSERT_LT(length(child * 64 - parent), 1e-9) << "triangle " << t;
  }
}

TEST(Amplify, two_steps_are_one_step_twice) {
  LoadedMesh input = loaded(tests::torus(150, 0.01f));
  input.double_coordinates = true;
  const Collected once = collect(*amplify(input, {.times = 1, .displacement = 0}));
  LoadedMesh halfway;
  halfway.double_coordinates = true;
  halfway.positions = once.positions;
  halfway.triangles = once.triangles;
  Collected twice = collect(*amplify(halfway, {.times = 1, .displacement = 0}));
  Collected direct = collect(*amplify(input, {.times = 2, .displacement = 0}));
  const auto by_key = [](Vec3d a, Vec3d b) { return key(a) < key(b); };
  std::sort(twice.positions.begin(), twice.positions.end(), by_key);
  std::sort(direct.positions.begin(), direct.positions.end(), by_key);
  EXPECT_EQ(twice.positions, direct.positions);
}

TEST(Amplify, displacement_is_along_the_normal_and_bounded) {
  LoadedMesh input = loaded(tests::open_grid(6, 6));  // flat, edges of length 1 and sqrt 2
  const Collected result = collect(*amplify(input, {.times = 1, .displacement = 0.1}));
  std::size_t moved = 0;
  for (std::size_t v = input.positions.size(); v < result.positions.size(); ++v) {
    const Vec3d p = result.positions[v];
    EXPECT_EQ(2 * p.x, std::floor(2 * p.x));
    EXPECT_EQ(2 * p.y, std::floor(2 * p.y));
    EXPECT_LT(std::fabs(p.z), 0.1 * std::sqrt(2.0));
    moved += p.z != 0 ? 1 : 0;
  }
  EXPECT_EQ(moved, result.positions.size() - input.positions.size());
}

TEST(Amplify, attributes_are_averaged_and_colours_stay_whole_numbers) {
  LoadedMesh input = loaded(tests::open_grid(1, 1));
  input.attributes = {.normals = true, .colour = ColourType::u8, .alpha = true, .texcoords = true};
  for (std::size_t v = 0; v < 4; ++v) {
    const float x = static_cast<float>(v % 2);
    const std::array<float, 9> channels{x, 1 - x, 0, 255 * x, 10, 7 + 2 * x, 255, x, 0.5f};
    input.channels.insert(input.channels.end(), channels.begin(), channels.end());
  }
  const Collected result = collect(*amplify(input, {.times = 1, .displacement = 0}));
  ASSERT_EQ(result.positions.size(), 9u);
  for (std::size_t v = 0; v < 9; ++v) {
    const std::span<const float> got = std::span(result.attributes).subspan(9 * v, 9);
    const double x = result.positions[v].x;
    EXPECT_NEAR(length(Vec3f{got[0], got[1], got[2]}), 1, 1e-6);
    EXPECT_NEAR(got[0], x == 0.5 ? std::sqrt(0.5) : x, 1e-6);
    EXPECT_EQ(got[3], x == 0.5 ? 128 : 255 * x);
    EXPECT_EQ(got[4], 10);
    EXPECT_EQ(got[5], 7 + 2 * x);
    EXPECT_EQ(got[6], 255);
    EXPECT_EQ(got[7], static_cast<float>(x));
    EXPECT_EQ(got[8], 0.5f);
  }
}

TEST(Amplify, bytes_do_not_depend_on_the_block_size) {
  const auto mesh = amplify(loaded(tests::torus(150)), {.times = 2});
  const Collected reference = collect(*mesh, 1u << 20);
  for (const std::size_t block_size : {1u, 5u, 333u})
    EXPECT_EQ(collect(*mesh, block_size), reference) << block_size;
}

TEST(Amplify, golden_hashes) {
  const Collected mesh =
      collect(*amplify(loaded(tests::open_grid(9, 9, 0.2f)), {.times = 3, .seed = 5}));
  EXPECT_EQ(hash_of(mesh.positions), 11762744545348137671u);
  EXPECT_EQ(hash_of(mesh.triangles), 15925201291934362454u);
}

TEST(Amplify, options_out_of_range_are_usage_errors) {
  const auto code_of = [](const AmplifyOptions& options) {
    try {
      amplify(loaded(tests::soup(10'000)), options);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code_of({.times = -1}), ErrorCode::usage);
  EXPECT_EQ(code_of({.times = 11}), ErrorCode::usage);
  EXPECT_EQ(code_of({.displacement = -0.5}), ErrorCode::usage);
  EXPECT_EQ(code_of({.displacement = std::nan("")}), ErrorCode::usage);
  // 10,000 triangles that share nothing, 525,825 points each.
  EXPECT_EQ(code_of({.times = 10}), ErrorCode::usage);
}
}  // namespace
}  // namespace meshhier::bench
