// A textured mesh of which every colour is known: an OBJ with its materials and pictures.
#pragma once

#include "base/vec.h"
#include "hierarchy/texture.h"
#include "images/image.h"
#include "storage/io/file.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace meshhier::tests {

/// A corner as the file has it.
struct TexturedCorner {
  Vec3f position;
  Vec2f texcoord;  ///< from the upper left
};
struct TexturedTriangle {
  std::array<TexturedCorner, 3> corners;
  std::uint32_t picture = 0;
};

struct TexturedTorus {
  std::vector<TexturedTriangle> triangles;
  std::vector<images::Image> pictures;
};

/// Returns the colour of every picture at a point of the surface: red, green and blue, 0 ... 255.
std::array<double, 3> torus_colour(Vec3d point);

/// 8 * patches_around * 8 * patches_across quads. Each patch of 8 x 8 quads is a chart, every
/// second one turned by a quarter, in one of two pictures, with `quad_texels` texels a quad's side
/// and four more around the chart.
TexturedTorus make_textured_torus(std::uint32_t patches_around, std::uint32_t patches_across,
                                  std::uint32_t quad_texels = 6);

/// Writes torus.obj, torus.mtl and the pictures into `directory`; returns the OBJ's path.
std::filesystem::path write_obj(const TexturedTorus& torus, const std::filesystem::path& directory);

}  // namespace meshhier::tests
