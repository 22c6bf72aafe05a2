// PLY files as mesh sources.
#pragma once

#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_faces.h"
#include "mesh_io/ply_plan.h"
#include "storage/io/file.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

namespace meshhier::mesh_io {

/// A PLY file, whose faces may show pictures or have colours.
class PlySource : public MeshSource {
 public:
  virtual const PlyPlan& plan() const = 0;
  /// Visits whole faces in file order, with their places in pictures and their colours: polygons as
  /// they are, triangle strips as single triangles of picture 0. Returns how many faces the file
  /// has, and how many degenerate triangles its strips had. Throws as read_triangles().
  virtual FaceCounts read_faces(const PlyFaceVisitor& visit) = 0;
  /// Visits u and v of all texture vertices. Both require PlyTexcoords::of_texture_faces.
  virtual void read_texture_vertices(const std::function<void(std::array<float, 2>)>& visit) = 0;
  virtual void read_texture_faces(const PlyTextureFaceVisitor& visit) = 0;
  /// Returns where a vertex lies; reads it again. Throws Error(io).
  virtual Vec3d place_of(std::uint32_t vertex) = 0;
};

/// Texture faces may have this many pictures if the header does not name them.
inline constexpr std::size_t kMostUnnamedTextures = std::size_t{1} << 16;

/// Plans the reading of a file that begins with `start`; none if its header cannot be read.
std::optional<PlyPlan> plan_of(std::string_view start, const std::filesystem::path& path,
                               const AttributeChoice& attributes = {});

struct PlyReading {
  PlyWrittenBy writer = PlyWrittenBy::anyone;
  Unplaced unplaced = Unplaced::refused;
  AttributeChoice attributes{};
};

/// Reads the header of `file` and checks it. ply_header.h, ply_plan.h and ply_body.h say what is
/// accepted.
std::unique_ptr<PlySource> make_ply_source(std::unique_ptr<storage::File> file,
                                           const PlyReading& reading = {});

}  // namespace meshhier::mesh_io
