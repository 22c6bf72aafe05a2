// Faces of a PLY file with their places in pictures, or a colour of their own.
#pragma once

#include "mesh_io/ply_plan.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

struct PlyFace {
  std::optional<std::uint64_t> row;  ///< row in the polygons' element; none: the face is of a strip
  /// A face is held in memory, so it may not be of any size.
  static constexpr std::size_t kMostCorners = std::size_t{1} << 16;

  std::vector<std::uint32_t> corners;  ///< as the file has them
  std::vector<float> texcoords;        ///< u v of each corner, v from the bottom row; or empty
  std::int32_t texture = 0;            ///< number of its picture; -1: none
  std::array<float, 4> colour{};       ///< as attributes have it; of polygons, if they have any
  std::vector<double> values;          ///< PlyPlan::face_values; of polygons
};

/// A face's place in a picture, which stands in an element of its own.
struct PlyTextureFace {
  std::uint64_t face = 0;              ///< row of the element with the faces
  std::vector<std::uint32_t> corners;  ///< texture vertices, one for each corner of the face
  std::int32_t texture = 0;            ///< as PlyFace's
};

/// The numbers of a row.
struct PlyRow {
  std::uint64_t number = 0;
  std::vector<std::vector<double>> values;  ///< per property; empty if it was not asked for
};

/// Returns what is wrong with a row; empty if nothing is. Valid during the visit only.
using PlyRowVisitor = std::function<std::string(const PlyRow&)>;

/// The limits of numbers in faces.
struct PlyFaceLimits {
  std::uint64_t vertices = 0;  ///< or texture vertices
  std::uint64_t faces = 0;
  std::size_t textures = 0;
};

/// Makes a face of a row of polygons; returns as PlyRowVisitor does.
std::string take_face(const PlyElementPlan& plan, const PlyRow& row, const PlyFaceLimits& limits,
                      PlyFace& face);
/// Does the same for a row of texture faces.
std::string take_texture_face(const PlyElementPlan& plan, const PlyRow& row,
                              const PlyFaceLimits& limits, PlyTextureFace& face);

/// Valid during the visit only.
using PlyFaceVisitor = std::function<void(const PlyFace&)>;
using PlyTextureFaceVisitor = std::function<void(const PlyTextureFace&)>;

}  // namespace meshhier::mesh_io
