// Surfaces whose pictures show a colour that is known at each point of space.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "images/image.h"
#include "texture/bake.h"
#include "texture/corners.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Red, green and blue, 0 to 255, sRGB.
using Colour = std::array<double, 3>;
using Paint = std::function<Colour(const Vec3d& at)>;

struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<TileTriangle> triangles;
};

/// With that many squares around and across, and noise of that size on its points.
Mesh make_torus(std::uint32_t around, std::uint32_t across, double noise = 0);
Mesh make_sphere(std::uint32_t around, std::uint32_t across);

struct Painted {
  Mesh mesh;
  std::vector<CornerTexcoords> corners;
  images::Image image;
  float texel = 0;
  float lost = 0;

  TexturedSurface surface() const { return {mesh.positions, mesh.triangles, corners, &image}; }
};

/// Cuts charts for a picture of that size, and makes it.
BakedTexture bake(const TexturedSurface& tile, std::span<const TexturedSurface> finer,
                  const BakeSize& size);

/// A picture of at most side * side, painted.
Painted painted(const Mesh& mesh, std::uint32_t side, const Paint& paint);
/// The same mesh or a coarser one with a picture made of others'.
Painted baked(const Mesh& mesh, const std::vector<const Painted*>& finer, std::uint32_t side,
              float least_texel = 0);

/// Returns the colour of a surface at a point of a triangle, filtered in linear light.
Colour shown(const Painted& of, std::size_t triangle, double on_b, double on_c);
Vec3d point_of(const Mesh& mesh, std::size_t triangle, double on_b, double on_c);

/// Decibels, of `count` points in each triangle.
double psnr(const Painted& of, const Paint& paint);

/// Cubes of two colours, with edges that are `blur` wide.
Paint checker(double cube, double blur);

}  // namespace meshhier::texture
