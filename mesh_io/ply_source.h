// PLY files as mesh sources.
#pragma once

#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_faces.h"
#include "mesh_io/ply_plan.h"
#include "storage/io/file.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// A PLY file, which may name pictures.
class PlySource : public MeshSource {
 public:
  /// The pictures that faces number; empty unless vertices or faces have texture coordinates.
  virtual const std::vector<std::string>& texture_files() const = 0;
  /// Whether faces have coordinates of their own, which count instead of those of vertices.
  virtual bool has_face_texcoords() const = 0;
  /// As read_triangles(), but whole faces with their textures; triangle strips as single triangles,
  /// of picture 0. Returns how many faces the file has, and what degenerate triangles strips had;
  /// polygons are visited as they are.
  virtual FaceCounts read_textured_faces(const PlyFaceVisitor& visit) = 0;
  /// Where a vertex lies; reads it again. Throws Error(io).
  virtual Vec3d place_of(std::uint32_t vertex) = 0;
};

/// Whether the file at the start of which is `start` names pictures and has coordinates in them;
/// false also if its header cannot be read.
bool ply_names_textures(std::string_view start, const std::filesystem::path& path);

/// Reads the header of `file` and checks it. What is accepted: ply_header.h, ply_plan.h,
/// ply_body.h.
std::unique_ptr<PlySource> make_ply_source(std::unique_ptr<storage::File> file,
                                           PlyWrittenBy writer = PlyWrittenBy::anyone);

}  // namespace meshhier::mesh_io
