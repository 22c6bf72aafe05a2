// Writes a textured surface: the mesh, and its pictures beside it.
#pragma once

#include "bench/textured_scan.h"
#include "hierarchy/texture.h"
#include "storage/io/file.h"
#include "storage/io/output_file.h"

#include <cstdint>

namespace meshhier::bench {

enum class MeshFileFormat { obj, ply };

struct TexturedFileOptions {
  MeshFileFormat mesh = MeshFileFormat::obj;
  ImageFormat image = ImageFormat::jpeg;  ///< jpeg or png
  int quality = 90;                       ///< quality of jpeg, 1 to 100
};

struct TexturedFileSizes {
  std::uint64_t mesh_bytes = 0;
  std::uint64_t image_bytes = 0;  ///< bytes of all pictures
};

/// Writes the files. Beside "NAME.obj" there are NAME.mtl and NAME_0000.jpg, NAME_0001.jpg ... The
/// mesh comes last. Pictures are made in parallel, each in O(side) memory. An OBJ has texture
/// coordinates of its own for each chart; a PLY has them in its faces, as MeshLab and VCG write it
/// (`texcoord`, `texnumber`, `comment TextureFile`). Throws Error(usage) if the output is no file,
/// or if an option is out of range, Error(exists | io).
TexturedFileSizes write_textured(storage::FileSystem& files, const storage::OutputRequest& request,
                                 const TexturedScan& surface, const TexturedFileOptions& options);

}  // namespace meshhier::bench
