// Surfaces from nothing: closed, counted right, the same every time.
#include "base/error.h"
#include "bench/generator.h"
#include "bench/noise.h"
#include "bench/patch_grid.h"
#include "tests/bench/collected.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

struct ShapeFacts {
  BaseShape shape;
  std::int64_t euler;
  std::size_t components;
};

class SurfaceShape : public testing::TestWithParam<ShapeFacts> {};

TEST_P(SurfaceShape, is_closed_manifold_and_oriented) {
  SurfaceOptions options;
  options.shape = GetParam().shape;
  options.triangles = 20'000;
  options.noise = 0.3;
  const Collected mesh = collect(*make_surface(options));
  const auto edges = tests::directed_edges(mesh.triangles);
  EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end()) << "an edge twice";
  EXPECT_TRUE(tests::is_closed(mesh.triangles));
  EXPECT_TRUE(has_one_ring_everywhere(mesh));
  EXPECT_FALSE(has_repeated_position(mesh.positions));
  EXPECT_EQ(tests::euler_characteristic(mesh.triangles), GetParam().euler);
  EXPECT_EQ(components(mesh), GetParam().components);
  for (const Vec3d p : mesh.positions)
    ASSERT_TRUE(std::fabs(p.x) <= 2 && std::fabs(p.y) <= 2 && std::fabs(p.z) <= 2);
}

TEST_P(SurfaceShape, has_the_least_grid_with_enough_triangles) {
  SurfaceOptions options;
  options.shape = GetParam().shape;
  const std::uint64_t patches =
      make_surface({.shape = options.shape, .triangles = 1})->content().triangle_count / 2;
  for (const std::uint64_t asked : {1u, 2u, 999u, 12'345u, 100'000u, 1'000'000u}) {
    options.triangles = asked;
    const mesh_io::PlyContent content = make_surface(options)->content();
    const auto cells =
        static_cast<std::uint64_t>(std::llround(std::sqrt(content.triangle_count / 2 / patches)));
    EXPECT_EQ(content.triangle_count, 2 * patches * cells * cells);
    EXPECT_GE(content.triangle_count, asked);
    if (cells > 1) {
      EXPECT_LT(2 * patches * (cells - 1) * (cells - 1), asked);
    }
    EXPECT_EQ(static_cast<std::int64_t>(content.vertex_count),
              static_cast<std::int64_t>(content.triangle_count / 2) + GetParam().euler);
  }
}

/// The volume that the smooth shape encloses: spheres by formula, the others as the limit of
/// Catmull and Clark's subdivision, which the patches approximate.
double ideal_volume(BaseShape shape) {
  constexpr double kUnitBall = 4.18879020478639;
  if (shape == BaseShape::sphere)
    return kUnitBall;
  if (shape == BaseShape::shells)
    return kUnitBall * (1 - 0.6 * 0.6 * 0.6);
  QuadMesh mesh = BaseSurface(shape).patches();
  for (int step = 0; step < 4; ++step)
    mesh = subdivided(mesh);
  double volume = 0;
  for (const auto& [a, b, c, d] : mesh.faces) {
    const auto& p = mesh.vertices;
    volume += (dot(p[a], cross(p[b], p[c])) + dot(p[a], cross(p[c], p[d]))) / 6;
  }
  return volume;
}

TEST_P(SurfaceShape, encloses_the_volume_of_its_shape) {
  SurfaceOptions options;
  options.shape = GetParam().shape;
  options.triangles = 50'000;
  options.height = 0;
  const double smooth = signed_volume(collect(*make_surface(options)));
  EXPECT_NEAR(smooth, ideal_volume(options.shape), 0.01 * smooth);
  options.height = 0.3;
  const double rough = signed_volume(collect(*make_surface(options)));
  EXPECT_NE(rough, smooth);
  EXPECT_NEAR(rough, smooth, 0.3 * smooth);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, SurfaceShape,
    testing::Values(ShapeFacts{BaseShape::sphere, 2, 1}, ShapeFacts{BaseShape::torus, 0, 1},
                    ShapeFacts{BaseShape::genus5, -8, 1}, ShapeFacts{BaseShape::shells, 4, 2}),
    [](const auto& tested) { return std::string(name_of(tested.param.shape)); });

TEST(Surface, smallest_grids_are_closed_too) {
  for (const BaseShape shape :
       {BaseShape::sphere, BaseShape::torus, BaseShape::genus5, BaseShape::shells}) {
    const auto one = make_surface({.shape = shape, .triangles = 1});
    for (const std::uint64_t factor : {1u, 4u, 9u}) {  // n = 1, 2, 3
      const Collected mesh = collect(
          *make_surface({.shape = shape, .triangles = one->content().triangle_count * factor}));
      EXPECT_EQ(mesh.triangles.size(), one->content().triangle_count * factor);
      EXPECT_TRUE(tests::is_closed(mesh.triangles));
      EXPECT_TRUE(has_one_ring_everywhere(mesh));
      EXPECT_FALSE(has_repeated_position(mesh.positions));
    }
  }
}

TEST(Surface, bytes_do_not_depend_on_the_block_size) {
  const auto mesh = make_surface(
      {.shape = BaseShape::torus, .triangles = 3000, .normals = true, .colours = true});
  const Collected reference = collect(*mesh, 1u << 20);
  for (const std::size_t block_size : {1u, 7u, 1000u})
    EXPECT_EQ(collect(*mesh, block_size), reference) << block_size;
}

// A change of these values is a change of every generated mesh: measurements before and after it
// cannot be compared.
TEST(Surface, golden_hashes) {
  const Collected mesh = collect(*make_surface({.shape = BaseShape::genus5,
                                                .triangles = 30'000,
                                                .seed = 7,
                                                .noise = 0.25,
                                                .normals = true,
                                                .colours = true,
                                                .alpha = true,
                                                .double_coordinates = true}));
  EXPECT_EQ(hash_of(mesh.positions), 14390456004359210203u);
  EXPECT_EQ(hash_of(mesh.attributes), 9397193127547357186u);
  EXPECT_EQ(hash_of(mesh.triangles), 13519297551673504365u);
}

TEST(Surface, another_seed_is_another_relief_on_the_same_grid) {
  const Collected first = collect(*make_surface({.triangles = 2000, .seed = 1}));
  const Collected again = collect(*make_surface({.triangles = 2000, .seed = 1}));
  const Collected other = collect(*make_surface({.triangles = 2000, .seed = 2}));
  EXPECT_EQ(first, again);
  EXPECT_EQ(first.triangles, other.triangles);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < first.positions.size(); ++v)
    moved += first.positions[v] == other.positions[v] ? 0 : 1;
  EXPECT_GT(moved, first.positions.size() * 9 / 10);
}

TEST(Surface, finer_meshes_have_finer_relief) {
  // Without relief the area is the sphere's; every octave that the grid can show adds to it.
  const auto area_of = [](std::uint64_t triangles) {
    return area(collect(*make_surface({.triangles = triangles, .roughness = 0.6})));
  };
  const double coarse = area_of(2'000);
  const double middle = area_of(32'000);
  const double fine = area_of(512'000);
  EXPECT_GT(coarse, 4 * 3.14159);
  EXPECT_GT(middle, coarse * 1.05);
  EXPECT_GT(fine, middle * 1.05);
}

TEST(Surface, noise_moves_every_vertex_by_less_than_a_grid_step) {
  SurfaceOptions options{.triangles = 20'000, .double_coordinates = true};
  const Collected still = collect(*make_surface(options));
  options.noise = 0.5;
  const Collected noisy = collect(*make_surface(options));
  const double step = std::sqrt(2 * area(still) / static_cast<double>(still.triangles.size()));
  double sum = 0;
  for (std::size_t v = 0; v < still.positions.size(); ++v) {
    const double distance = length(noisy.positions[v] - still.positions[v]);
    EXPECT_LT(distance, step);
    sum += distance;
  }
  // The mean of |u| for u uniform in [-1, 1) is a half.
  EXPECT_NEAR(sum / static_cast<double>(still.positions.size()), 0.25 * step, 0.1 * step);
}

TEST(Surface, normals_fit_the_relief) {
  for (const BaseShape shape :
       {BaseShape::sphere, BaseShape::torus, BaseShape::genus5, BaseShape::shells}) {
    const Collected mesh =
        collect(*make_surface({.shape = shape, .triangles = 100'000, .normals = true}));
    std::vector<Vec3d> sums(mesh.positions.size());
    for (const MeshTriangle& t : mesh.triangles) {
      const Vec3d a = mesh.positions[t[0]];
      const Vec3d n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
      for (const std::uint32_t v : t)
        sums[v] = sums[v] + n;
    }
    double agreement = 0;
    for (std::size_t v = 0; v < sums.size(); ++v) {
      const Vec3d normal{mesh.attributes[3 * v], mesh.attributes[3 * v + 1],
                         mesh.attributes[3 * v + 2]};
      ASSERT_NEAR(length(normal), 1, 1e-6);
      agreement += dot(normal, sums[v]) / length(sums[v]);
    }
    EXPECT_GT(agreement / static_cast<double>(sums.size()), 0.95) << name_of(shape);
  }
}

TEST(Surface, colours_are_bytes_and_vary) {
  const auto generated = make_surface({.triangles = 20'000, .colours = true, .alpha = true});
  EXPECT_EQ(generated->content().attributes.colour, ColourType::u8);
  EXPECT_TRUE(generated->content().attributes.alpha);
  const Collected mesh = collect(*generated);
  for (std::size_t channel = 0; channel < 4; ++channel) {
    std::set<float> values;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      values.insert(mesh.attributes[4 * v + channel]);
    for (const float value : values)
      EXPECT_TRUE(value >= 0 && value <= 255 && value == std::floor(value)) << value;
    EXPECT_GT(values.size(), 20u) << channel;
  }
}

TEST(Surface, double_coordinates_hold_more_than_floats) {
  SurfaceOptions options{.triangles = 5000, .offset = {500'000, 5'400'000, 200}};
  const auto float_exact = [](const Collected& mesh) {
    return std::count_if(mesh.positions.begin(), mesh.positions.end(),
                         [](Vec3d p) { return to_double(to_float(p)) == p; });
  };
  const Collected narrow = collect(*make_surface(options));
  EXPECT_EQ(float_exact(narrow), static_cast<std::ptrdiff_t>(narrow.positions.size()));
  options.double_coordinates = true;
  const Collected wide = collect(*make_surface(options));
  EXPECT_EQ(float_exact(wide), 0);
  EXPECT_FALSE(has_repeated_position(wide.positions));
  for (const Vec3d p : wide.positions)
    ASSERT_LT(length(p - options.offset), 2);
}

TEST(Surface, billions_of_triangles_are_counted_at_once) {
  const mesh_io::PlyContent content =
      make_surface({.shape = BaseShape::torus, .triangles = 8'000'000'000})->content();
  EXPECT_GE(content.triangle_count, 8'000'000'000u);
  EXPECT_LT(content.triangle_count, 8'010'000'000u);
  EXPECT_EQ(content.vertex_count, content.triangle_count / 2);
}

void expect_usage_error(const SurfaceOptions& options, const std::string& name) {
  try {
    make_surface(options);
    ADD_FAILURE() << name << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
  }
}

TEST(Surface, options_out_of_range_are_named) {
  expect_usage_error({.triangles = 0}, "triangles");
  expect_usage_error({.triangles = ~std::uint64_t{0}}, "triangles");
  expect_usage_error({.triangles = std::uint64_t{1} << 33}, "triangles");
  expect_usage_error({.height = -0.1}, "height");
  expect_usage_error({.roughness = 0.95}, "roughness");
  expect_usage_error({.noise = std::nan("")}, "noise");
  expect_usage_error({.alpha = true}, "alpha");
  expect_usage_error({.offset = {0, HUGE_VAL, 0}}, "offset");
}

TEST(PatchGrid, numbers_owned_points_in_walking_order) {
  for (const BaseShape shape : {BaseShape::sphere, BaseShape::genus5}) {
    const BaseSurface base(shape);
    for (const std::uint32_t cells : {1u, 2u, 3u, 8u}) {
      const PatchGrid grid(base.patches(), cells);
      std::uint64_t expected = 0;
      for (std::uint32_t patch = 0; patch < grid.patch_count(); ++patch) {
        for (std::uint32_t row = 0; row <= cells; ++row) {
          for (std::uint32_t column = 0; column <= cells; ++column) {
            if (grid.is_owned({patch, column, row})) {
              ASSERT_EQ(grid.index({patch, column, row}), expected++);
            }
          }
        }
      }
      EXPECT_EQ(grid.vertex_count(), expected);
    }
  }
}

TEST(BaseSurface, neighbours_agree_along_their_sides) {
  for (const BaseShape shape :
       {BaseShape::sphere, BaseShape::torus, BaseShape::genus5, BaseShape::shells}) {
    const BaseSurface base(shape);
    const auto opposite = opposite_sides(base.patches());
    const auto on_side = [&](PatchSide at, double t) {
      const std::array<std::array<double, 2>, 4> uv{{{t, 0}, {1, t}, {1 - t, 1}, {0, 1 - t}}};
      return base.at(at.face, uv[at.side][0], uv[at.side][1]);
    };
    for (std::uint32_t face = 0; face < opposite.size(); ++face) {
      for (std::uint32_t side = 0; side < 4; ++side) {
        for (const double t : {0.0, 0.3, 0.5, 1.0}) {
          const SurfacePoint here = on_side({face, side}, t);
          const SurfacePoint there = on_side(opposite[face][side], 1 - t);
          ASSERT_LT(length(here.position - there.position), 1e-12);
          ASSERT_GT(dot(here.normal, there.normal), 0.98);
        }
      }
    }
  }
}

TEST(FractalNoise, gradient_is_the_values_slope) {
  const FractalNoise noise({.seed = 3, .height = 0.7, .frequency = 1.3, .gain = 0.6, .octaves = 4});
  constexpr double kStep = 1e-5;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Vec3d p{2 * signed_unit(random_at(1, 3 * i)), 2 * signed_unit(random_at(1, 3 * i + 1)),
                  2 * signed_unit(random_at(1, 3 * i + 2))};
    const NoiseSample sample = noise.at(p);
    const auto slope = [&](Vec3d direction) {
      return (noise.at(p + direction * kStep).value - noise.at(p - direction * kStep).value) /
             (2 * kStep);
    };
    EXPECT_NEAR(sample.gradient.x, slope({1, 0, 0}), 1e-5);
    EXPECT_NEAR(sample.gradient.y, slope({0, 1, 0}), 1e-5);
    EXPECT_NEAR(sample.gradient.z, slope({0, 0, 1}), 1e-5);
    EXPECT_LT(std::fabs(sample.value), 0.7 / (1 - 0.6));
  }
}
}  // namespace
}  // namespace meshhier::bench
