// A textured mesh in memory, pictures and all, to be drawn.
#pragma once

#include "base/vec.h"
#include "hierarchy/texture.h"
#include "hierarchy/triangle.h"
#include "mesh_io/input_paths.h"
#include "render/mip_texture.h"
#include "render/raster.h"
#include "storage/io/file.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace meshhier::bench {

struct ShownMaterial {
  std::shared_ptr<const render::MipTexture> texture;  ///< null: the colour is shown
  Vec3f colour{1, 1, 1};                              ///< linear light
};

struct TexturedMesh {
  std::vector<Vec3f> positions;
  std::vector<Vec2f> texcoords;            ///< per vertex, v from above
  std::vector<std::uint32_t> material_of;  ///< per vertex; equal at the corners of a triangle
  std::vector<Triangle<std::uint32_t>> triangles;
  std::vector<ShownMaterial> materials;

  void draw(render::Raster& raster) const;
  /// Returns the mean side of a texel on the surface; 0 without textures.
  double texel() const;
};

/// Imports the files as a build does, into temporary files in `scratch`, and decodes all pictures
/// whole: 4 bytes a texel. Positions are relative to `origin`. Throws Error(usage) if the mesh has
/// no textures, Error(input | io).
TexturedMesh load_textured_mesh(storage::FileSystem& files, const mesh_io::InputPaths& paths,
                                const std::filesystem::path& scratch, Vec3d origin);

}  // namespace meshhier::bench
