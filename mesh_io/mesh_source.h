// A mesh file as two restartable streams, vertices and triangles, in bounded memory.
#pragma once

#include "base/error.h"
#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "hierarchy/ids.h"
#include "hierarchy/triangle.h"
#include "mesh_io/attribute_choice.h"
#include "mesh_io/block_runner.h"
#include "mesh_io/odd_syntax.h"
#include "mesh_io/polygon_counts.h"
#include "mesh_io/zeroed.h"
#include "storage/io/file.h"
#include "storage/io/file_checksum.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::mesh_io {

/// The header's facts, known before any vertex is read.
struct MeshDescription {
  std::string format;  ///< for people: "PLY binary little endian"
  std::uint64_t file_bytes = 0;
  std::uint64_t vertex_count = 0;  ///< N < 2^32
  /// Different places of vertices, if that is known; 0: each at its own.
  std::uint64_t place_count = 0;
  std::uint64_t face_count = 0;  ///< polygons, or triangle strips, as declared
  AttributeLayout attributes;
  /// Declared as double, int32 or uint32, which may not fit float exactly.
  bool wide_coordinates = false;
  bool vertices_in_place = false;  ///< vertices are binary, of one fixed size, at a known offset:
                                   ///< reading them again costs no more than their bytes
  std::uint64_t held_bytes = 0;    ///< memory that the source has all the time

  std::uint64_t places() const { return place_count > 0 ? place_count : vertex_count; }
};

/// Consecutive vertices of the file. Valid during the visit only.
struct VertexBlock {
  std::uint64_t first = 0;            ///< VertexId of the first
  std::span<const Vec3f> positions;   ///< empty if wide_coordinates
  std::span<const Vec3d> exact;       ///< empty unless wide_coordinates
  std::span<const float> attributes;  ///< count * attributes.channels(), see hierarchy/attributes.h
  ZeroedCounts zeroed;                ///< among these attributes

  /// Returns whether all finite coordinates are floats.
  bool fits_float() const;
};

/// Counts of all faces that were read.
struct FaceCounts {
  std::uint64_t faces = 0;
  std::uint64_t triangles = 0;  ///< handed out
  /// Dropped: a vertex twice, or a polygon of fewer than three corners.
  std::uint64_t degenerate_triangles = 0;
  PolygonCounts polygons;

  friend FaceCounts operator+(const FaceCounts& a, const FaceCounts& b) {
    return {a.faces + b.faces, a.triangles + b.triangles,
            a.degenerate_triangles + b.degenerate_triangles, a.polygons + b.polygons};
  }
};

/// Some triangles of consecutive faces. Valid until the memory that it was read into is used again.
struct TriangleBlock {
  std::span<const Triangle<VertexId>> triangles;
  std::uint64_t faces = 0;  ///< taken; those without a triangle here were degenerate
  bool whole = false;       ///< all faces of the block were taken
};

/// The memory that a block is read into; used again for the next one. One a thread.
struct BlockMemory {
  std::vector<std::byte> bytes;
  std::vector<Vec3f> positions;
  std::vector<Vec3d> exact;
  std::vector<float> attributes;
  std::vector<Triangle<VertexId>> triangles;
};

using VertexVisitor = std::function<void(const VertexBlock&)>;
using TriangleVisitor = std::function<void(std::span<const Triangle<VertexId>>)>;

/// A vertex has coordinates that are not finite. If no face uses it, the mesh is whole without it:
/// a PlySource with Unplaced::visited reads it.
class UnplacedVertexError : public Error {
 public:
  explicit UnplacedVertexError(const Error& error) : Error(error) {}
};

/// A mesh file that is read as often as one likes, in bounded memory: peak memory does not depend
/// on the file but for 10 bytes each 256 KiB.
///
/// Errors. Every failure throws Error(input) naming file, byte offset (binary) or line (text), what
/// was expected and what was found; Error(io) if the file cannot be read. An exception of a visitor
/// passes through.
///
/// Threads. One call at a time, but for read_vertex_block() and read_triangle_block(), which may
/// run side by side. Calls may come in any order.
class MeshSource {
 public:
  virtual ~MeshSource() = default;
  virtual const MeshDescription& description() const = 0;

  /// Visits all vertices in file order, in blocks of at most kBlockSize, from one thread at a time.
  /// Coordinates are checked finite. `runner` runs the blocks of a text; visits come from its
  /// take().
  virtual void read_vertices(const VertexVisitor& visit, const BlockRunner& runner) = 0;
  void read_vertices(const VertexVisitor& visit) { read_vertices(visit, BlockRunner()); }

  /// Visits all triangles in file order, in blocks of at most kBlockSize: polygons cut into fans
  /// (0, i, i + 1), or as their shape asks for (polygon_cut.h), strips unrolled with alternating
  /// orientation; every index is < N; degenerate triangles dropped and counted.
  FaceCounts read_triangles(const TriangleVisitor& visit, const BlockRunner& runner = {}) {
    return read_triangles_from(0, visit, runner);
  }

  /// Returns the number of blocks of vertices that can be read one by one: 0 unless
  /// vertices_in_place.
  virtual std::uint64_t vertex_blocks() const = 0;
  /// Reads block `index` < vertex_blocks(); all blocks together are the vertices in file order.
  /// Throws for the first defect of the block. Thread-safe for different `memory`.
  virtual VertexBlock read_vertex_block(std::uint64_t index, BlockMemory& memory) const = 0;

  /// Returns the number of blocks of faces that can be read one by one, as long as all faces before
  /// them are triangles; 0 if the rows of triangles have no known place.
  virtual std::uint64_t triangle_blocks() const = 0;
  /// Reads block `index` < triangle_blocks(), up to the first face that is not a sound triangle.
  /// The result means nothing unless all blocks before it are whole. If they are, and it is not
  /// whole or the last one, read_triangles_from() goes on behind it. Thread-safe for different
  /// `memory`. Throws Error(io) only.
  virtual TriangleBlock read_triangle_block(std::uint64_t index, BlockMemory& memory) const = 0;
  /// Does as read_triangles(), but without the first `face` faces, all of which blocks have shown
  /// to be triangles; counts only faces from there on.
  virtual FaceCounts read_triangles_from(std::uint64_t face, const TriangleVisitor& visit,
                                         const BlockRunner& runner) = 0;

  /// Returns counts of oddities that were read although the format has them otherwise; complete
  /// once all was read.
  virtual OddSyntax odd_syntax() const = 0;

  /// Returns the file's storage::FileChecksum, for which it reads the blocks of the file that were
  /// not read so far. `check` is called before each read and may throw.
  virtual std::uint64_t checksum(const std::function<void()>& check) = 0;
  /// Returns the sums of the blocks that were read so far.
  virtual std::vector<storage::BlockSums> known_sums() const = 0;
  /// Takes the sums of blocks that another process has read of the same file; returns false if this
  /// file has no such blocks.
  virtual bool add_sums(const storage::BlockSums& sums) = 0;

  /// 768 KiB of positions: in the L2 cache, large enough to amortise.
  static constexpr std::size_t kBlockSize = 65536;
};

/// Opens a mesh file; the format is known by its content. Reads the header and checks that what it
/// declares can fit into the file; nothing is sized by a count before that.
///
/// PLY, ASCII and binary little and big endian: ply_header.h and ply_plan.h say what is read. In
/// text a row begins a line; in binary a line end may follow the data (ply_body.h). Coordinates and
/// colours that are not finite are errors, as no average or bound can be made of them; normals and
/// texture coordinates become 0 (zeroed.h), and values stay as they are. Errors are also a negative
/// list length, and an index that is no vertex's. read_triangles() also checks everything behind
/// the faces, up to the end of the file.
std::unique_ptr<MeshSource> open_mesh(storage::FileSystem& files, const std::filesystem::path& path,
                                      const AttributeChoice& attributes = {});

}  // namespace meshhier::mesh_io
