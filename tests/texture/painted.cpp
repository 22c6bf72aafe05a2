#include "tests/texture/painted.h"

#include "tests/texture/random_numbers.h"
#include "texture/charted_tile.h"
#include "texture/fill.h"
#include "texture/finer_points.h"
#include "texture/texel_light.h"
#include "texture/texel_raster.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meshhier::texture {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

TileTriangle corners_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return {TileVertex{a}, TileVertex{b}, TileVertex{c}};
}

}  // namespace

BakedTexture bake(const TexturedSurface& tile, std::span<const TexturedSurface> finer,
                  const BakeSize& size) {
  return tile.triangles.empty() ? BakedTexture{}
                                : bake(ChartedTile(tile, size, shapes_of(finer)), finer);
}

Mesh make_torus(std::uint32_t around, std::uint32_t across, double noise) {
  Mesh mesh;
  RandomNumbers random(5);
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double a = kTurn * i / around, b = kTurn * j / across;
      const double ring = 1 + 0.4 * std::cos(b);
      const auto jitter = [&] { return noise * (random.part() - 0.5); };
      mesh.positions.push_back(
          to_float(Vec3d{ring * std::cos(a) + jitter(), ring * std::sin(a) + jitter(),
                         0.4 * std::sin(b) + jitter()}));
      const std::uint32_t next_i = (i + 1) % around, next_j = (j + 1) % across;
      const std::uint32_t at = i * across + j, right = next_i * across + j;
      const std::uint32_t up = i * across + next_j, both = next_i * across + next_j;
      mesh.triangles.push_back(corners_of(at, right, both));
      mesh.triangles.push_back(corners_of(at, both, up));
    }
  }
  return mesh;
}

Mesh make_sphere(std::uint32_t around, std::uint32_t across) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= across; ++j) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const double a = kTurn * i / around, b = kTurn / 2 * j / across;
      mesh.positions.push_back(
          to_float(Vec3d{std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), -std::cos(b)}));
    }
  }
  for (std::uint32_t j = 0; j < across; ++j) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t at = j * around + i, right = j * around + (i + 1) % around;
      if (j > 0)
        mesh.triangles.push_back(corners_of(at, right, right + around));
      if (j + 1 < across)
        mesh.triangles.push_back(corners_of(at, right + around, at + around));
    }
  }
  return mesh;
}

Painted painted(const Mesh& mesh, std::uint32_t side, const Paint& paint) {
  // Grey all over, with charts; a point of a chart's plane is known by its triangle.
  BakedTexture charts = bake({mesh.positions, mesh.triangles, {}, nullptr}, {}, {side, 0});
  Painted result{mesh, charts.corners, images::Image(charts.image.width, charts.image.height, 3),
                 charts.texel};
  std::vector<std::uint8_t> is_known(charts.image.texels.size() / charts.image.channels);
  // Texels beside a triangle are painted first, then those within.
  for (const double grown : {1.5, 0.0}) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<TexelPoint, 3> at;
      for (std::size_t k = 0; k < 3; ++k)
        at[k] = {double(result.corners[t][k].u) * result.image.width,
                 double(result.corners[t][k].v) * result.image.height};
      const double twice =
          (at[1].x - at[0].x) * (at[2].y - at[0].y) - (at[2].x - at[0].x) * (at[1].y - at[0].y);
      if (twice <= 0)
        continue;
      const auto [low_x, high_x] = std::minmax({at[0].x, at[1].x, at[2].x});
      const auto [low_y, high_y] = std::minmax({at[0].y, at[1].y, at[2].y});
      for (double y = std::max(0.0, std::floor(low_y - grown)); y < high_y + grown; ++y) {
        for (double x = std::max(0.0, std::floor(low_x - grown)); x < high_x + grown; ++x) {
          if (x >= result.image.width || y >= result.image.height)
            continue;
          const double px = x + 0.5 - at[0].x, py = y + 0.5 - at[0].y;
          const double b = (px * (at[2].y - at[0].y) - (at[2].x - at[0].x) * py) / twice;
          const double c = ((at[1].x - at[0].x) * py - px * (at[1].y - at[0].y)) / twice;
          if (grown == 0 && std::min({b, c, 1 - b - c}) < -1e-9)
            continue;
          const Colour colour = paint(point_of(mesh, t, b, c));
          is_known[std::size_t(y) * result.image.width + std::size_t(x)] = 1;
          for (std::size_t k = 0; k < 3; ++k)
            result.image.at(std::uint32_t(x), std::uint32_t(y))[k] =
                static_cast<std::uint8_t>(std::clamp(colour[k] + 0.5, 0.0, 255.0));
        }
      }
    }
  }
  fill_unknown(result.image, is_known);
  return result;
}

Painted baked(const Mesh& mesh, const std::vector<const Painted*>& finer, std::uint32_t side,
              float least_texel) {
  std::vector<TexturedSurface> surfaces;
  for (const Painted* surface : finer)
    surfaces.push_back(surface->surface());
  BakedTexture texture =
      bake({mesh.positions, mesh.triangles, {}, nullptr}, surfaces, {side, least_texel});
  return {mesh, texture.corners, texture.image, texture.texel, texture.lost};
}

Vec3d point_of(const Mesh& mesh, std::size_t triangle, double on_b, double on_c) {
  const auto corner = [&](std::size_t k) {
    return to_double(mesh.positions[raw(mesh.triangles[triangle][k])]);
  };
  return corner(0) * (1 - on_b - on_c) + corner(1) * on_b + corner(2) * on_c;
}

Colour shown(const Painted& of, std::size_t triangle, double on_b, double on_c) {
  const CornerTexcoords& at = of.corners[triangle];
  const double x = (at[0].u * (1 - on_b - on_c) + at[1].u * on_b + at[2].u * on_c) * of.image.width;
  const double y =
      (at[0].v * (1 - on_b - on_c) + at[1].v * on_b + at[2].v * on_c) * of.image.height;
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  std::array<float, 3> light{};
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const double weight_x = i == 0 ? left + 1 - (x - 0.5) : x - 0.5 - left;
      const double weight_y = j == 0 ? top + 1 - (y - 0.5) : y - 0.5 - top;
      const auto tx = std::uint32_t(std::clamp(left + i, 0.0, of.image.width - 1.0));
      const auto ty = std::uint32_t(std::clamp(top + j, 0.0, of.image.height - 1.0));
      for (std::size_t k = 0; k < 3; ++k)
        light[k] += float(weight_x * weight_y) * kLight[of.image.at(tx, ty)[k]];
    }
  }
  return {double(value_of_light(light[0])), double(value_of_light(light[1])),
          double(value_of_light(light[2]))};
}

double psnr(const Painted& of, const Paint& paint) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < of.mesh.triangles.size(); ++t) {
    for (const auto& [b, c] : {std::array{0.0, 0.0}, {0.33, 0.33}, {0.5, 0.5}, {0.2, 0.1}}) {
      const Colour is = shown(of, t, b, c), should = paint(point_of(of.mesh, t, b, c));
      for (std::size_t k = 0; k < 3; ++k)
        sum += (is[k] - should[k]) * (is[k] - should[k]);
      count += 3;
    }
  }
  return 10 * std::log10(255 * 255 / (sum / double(count)));
}

Paint checker(double cube, double blur) {
  return [=](const Vec3d& p) {
    const auto wave = [&](double at) {  // -1 ... 1
      const double part = at / (2 * cube) - std::floor(at / (2 * cube));
      const double to_edge = (0.25 - std::abs(part - 0.5)) * 2 * cube;  // > 0 in the middle
      return std::clamp(to_edge / (blur / 2), -1.0, 1.0);
    };
    const double sign = wave(p.x + 0.013) * wave(p.y + 0.029) * wave(p.z + 0.017);
    const double light = 0.5 + 0.4 * sign;
    const auto value = [](double l) { return double(value_of_light(static_cast<float>(l))); };
    return Colour{value(light), value(1 - light), value(0.3)};
  };
}

}  // namespace meshhier::texture
