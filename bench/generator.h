// The mesh generator: surfaces of any size from nothing, and larger or shuffled ones from a given
// mesh.
#pragma once

#include "base/vec.h"
#include "bench/base_surface.h"
#include "hierarchy/triangle.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_writer.h"
#include "storage/io/file.h"
#include "storage/io/output_file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::bench {

using MeshTriangle = Triangle<std::uint32_t>;

/// Consecutive vertices: positions and, for each, content().attributes.channels() floats. Positions
/// are exact floats unless content().double_coordinates.
using VertexBlockVisitor = std::function<void(std::span<const Vec3d>, std::span<const float>)>;
using TriangleBlockVisitor = std::function<void(std::span<const MeshTriangle>)>;

/// A mesh handed out as two streams, each of which can be had again and is the same every time: a
/// pure function of the options (and the input), whatever the block size. Exceptions of a visitor
/// pass through.
class GeneratedMesh {
 public:
  virtual ~GeneratedMesh() = default;
  virtual const mesh_io::PlyContent& content() const = 0;
  /// `block_size`: at most so many at a time, >= 1.
  virtual void visit_vertices(std::size_t block_size, const VertexBlockVisitor& visit) const = 0;
  virtual void visit_triangles(std::size_t block_size, const TriangleBlockVisitor& visit) const = 0;
};

struct SurfaceOptions {
  BaseShape shape = BaseShape::sphere;
  /// At least so many triangles; the next number that the grid can have is taken.
  std::uint64_t triangles = 1'000'000;
  std::uint64_t seed = 1;
  /// The relief stays within +- this, in parts of half the shape's thickness; [0, 0.9].
  double height = 0.3;
  /// Height of each finer octave of the relief relative to the one before; [0, 0.9].
  double roughness = 0.4;
  /// White measurement noise along the normal, in grid steps; [0, 1].
  double noise = 0;
  bool normals = false;
  bool colours = false;  ///< 8-bit red, green, blue
  bool alpha = false;    ///< a fourth colour channel; needs colours
  bool double_coordinates = false;
  Vec3d offset{};  ///< added to every position, for instance a geographic origin
};

/// A closed, manifold, consistently oriented surface with relief down to the grid's own step, in
/// [-2, 2]^3 before the offset. Memory is O(sqrt(triangles)). Throws Error(usage) naming the
/// option that is out of range, or if 2^32 vertices are not enough.
std::unique_ptr<GeneratedMesh> make_surface(const SurfaceOptions& options);

/// A mesh in memory: the input of the functions below.
struct LoadedMesh {
  AttributeLayout attributes;
  bool double_coordinates = false;
  std::vector<Vec3d> positions;
  std::vector<float> channels;  ///< positions.size() * attributes.channels()
  std::vector<MeshTriangle> triangles;
};

/// Reads all of `source`. Throws what the source throws.
LoadedMesh load_mesh(mesh_io::MeshSource& source);

struct AmplifyOptions {
  int times = 1;  ///< subdivision steps, each 1:4; [0, 10]
  std::uint64_t seed = 1;
  /// The farthest that an edge's midpoint moves along the normal, in parts of the edge's length;
  /// [0, 1].
  double displacement = 0.05;
};

/// Returns `mesh` after `times` steps: its vertices first, unchanged and in their order, then those
/// on its edges (edges in order of appearance), then those inside its triangles. Every midpoint is
/// shared by all triangles at its edge, so boundaries and non-manifold edges stay what they are.
/// Attributes are averaged; 8 and 16-bit colours rounded. Memory: that of `mesh` and 100 bytes a
/// triangle of it. Throws Error(usage) if an option is out of range or the result has 2^32 vertices
/// or more.
std::unique_ptr<GeneratedMesh> amplify(LoadedMesh mesh, const AmplifyOptions& options);

/// Returns `mesh` with its vertices and its triangles in random order; corners keep their order.
std::unique_ptr<GeneratedMesh> shuffle(LoadedMesh mesh, std::uint64_t seed);

/// Writes `mesh` as binary little endian PLY, complete or not at all; returns its bytes. Throws as
/// storage::OutputFile does.
std::uint64_t write_ply(storage::FileSystem& files, const storage::OutputRequest& request,
                        const GeneratedMesh& mesh);

}  // namespace meshhier::bench
