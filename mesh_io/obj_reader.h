// OBJ files (Wavefront, "Advanced Visualizer", appendix B1) as streams of what a mesh is made of.
#pragma once

#include "base/vec.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/obj_block.h"
#include "mesh_io/odd_syntax.h"
#include "mesh_io/polygon_counts.h"
#include "mesh_io/unplaced.h"
#include "mesh_io/zeroed.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// The numbers that a corner of a face refers to; the first of each kind is 0.
struct ObjCorner {
  static constexpr std::uint32_t kNone = UINT32_MAX;
  std::uint32_t position = 0;
  std::uint32_t texcoord = kNone;
  std::uint32_t normal = kNone;
};
using ObjTriangle = std::array<ObjCorner, 3>;
using ObjColour = std::array<float, 3>;

/// Takes what a file holds, in its order; calls may throw.
class ObjVisitor {
 public:
  virtual ~ObjVisitor() = default;
  virtual void add_position(Vec3d position, const std::optional<ObjColour>& colour) = 0;
  /// Takes the colour of the next vertex that has none of these yet: ZBrush writes them behind all
  /// vertices.
  virtual void add_polypaint(const ObjColour& /*colour*/) {}
  virtual void add_texcoord(std::array<float, 2> texcoord) = 0;
  virtual void add_normal(Vec3f normal) = 0;
  /// Takes the rest of a line usemtl: the material of the triangles from here on.
  virtual void use_material(const std::string& /*name*/) {}
  /// Takes the rest of a line mtllib, which is one name or several.
  virtual void use_libraries(const std::string& /*names*/) {}
  /// Returns whether use_group() and use_object() are called.
  virtual bool takes_groups() const { return false; }
  /// Take the rest of lines g and o.
  virtual void use_group(const std::string& /*names*/) {}
  virtual void use_object(const std::string& /*name*/) {}
  /// Returns a position that was added, for polygons whose shape must be known.
  virtual Vec3d position(std::uint32_t number) = 0;
  /// Takes a triangle of three different positions.
  virtual void add_triangle(const ObjTriangle& triangle) = 0;
};

struct ObjCounts {
  std::uint64_t positions = 0;
  std::uint64_t coloured = 0;  ///< positions with a colour
  std::uint64_t painted = 0;   ///< colours of #MRGB
  std::uint64_t texcoords = 0;
  std::uint64_t normals = 0;
  std::uint64_t faces = 0;
  std::uint64_t triangles = 0;
  std::uint64_t degenerate_triangles = 0;  ///< dropped: a position twice, or fewer than 3 corners
  std::uint64_t corners = 0;               ///< corners of the triangles
  PolygonCounts polygons;                  ///< those before their vertices are fans
  std::uint64_t textured_corners = 0;
  std::uint64_t normal_corners = 0;
  std::uint64_t groups = 0;            ///< statements g
  std::uint64_t objects = 0;           ///< o
  std::uint64_t materials = 0;         ///< usemtl
  std::uint64_t libraries = 0;         ///< mtllib
  std::uint64_t points_and_lines = 0;  ///< p, l: ignored
  std::uint64_t others = 0;            ///< smoothing groups, curves, surfaces, ...: ignored
  bool fits_float = true;              ///< all coordinates do (DecimalNumber)
  UnplacedVertices unplaced;           ///< which are visited all the same
  ZeroedCounts zeroed;                 ///< among normals and texcoords
  OddSyntax odd;
};

/// Reads the blocks of a file, which were parsed apart from each other, in their order.
///
///   LineBlocks lines(stream);
///   while (lines.next(block.text)): parse(block), take(block);
///   take_rest(lines.rest()), finish().
class ObjReader {
 public:
  ObjReader(const std::filesystem::path& path, ObjVisitor& visitor);
  ~ObjReader();

  /// All throw as read_obj().
  void take(const ObjBlock& block);
  void take_rest(InputStream& rest);
  ObjCounts finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns whether a line of an OBJ file can begin with that word.
bool is_obj_statement(std::string_view word);

/// Reads
///
///   v x y z [w] | v x y z r g b [a]   w and a are ignored
///   vt u [v [w]]                      v is 0 if it is not there, w is ignored
///   vn x y z
///   f corner corner corner ...        corner: v | v/vt | v//vn | v/vt/vn, from 1 on, or from -1
///                                     back; polygons are cut as their shape asks for
///   usemtl NAME | mtllib NAME [NAME ...] | g NAME [NAME ...] | o NAME
///   #MRGB mmrrggbb...                 colours of ZBrush, 8 hexadecimal digits a vertex; the mask
///                                     mm is ignored
///
/// and counts all other statements. Indices may refer to what comes later; all are checked. Numbers
/// are finite. Less than 2^32 - 1 of each. Throws Error(input) naming the line, Error(io).
ObjCounts read_obj(InputStream& stream, const std::filesystem::path& path, ObjVisitor& visitor);

}  // namespace meshhier::mesh_io
