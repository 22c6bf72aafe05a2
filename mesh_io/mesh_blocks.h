// Collects vertices and triangles into the blocks that visitors get.
#pragma once

#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_plan.h"
#include "mesh_io/polygon_cut.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// Rows of vertices in a memory, written slot by slot: slots 0 to 2 are coordinates, slots from 3
/// on attribute channels.
class VertexRows {
 public:
  /// Makes room for `rows` rows of the attributes and coordinates that `mesh` has in `memory`.
  VertexRows(const MeshDescription& mesh, std::size_t rows, BlockMemory& memory);

  /// The place of a row's slot, and the distance in bytes to the same slot of the next row.
  struct Column {
    enum class Form : std::uint8_t { one_float, one_double, two_channels };

    std::byte* data = nullptr;
    std::size_t stride = 0;
    Form form = Form::one_float;
  };
  Column column(std::size_t row, int slot);
  /// Writes the value at `to.data` in the slot's type.
  static void put(const Column& to, double value);

  /// Applies zero_what_is_not_finite() to rows [first, first + count).
  ZeroedCounts zero_what_is_not_finite(std::size_t first, std::size_t count);

  /// A number that must not be read.
  struct Defect {
    std::size_t row = 0;  ///< counted from the first one looked at
    int slot = 0;
    double value = 0;
  };
  /// Finds the first number of rows [first, first + count) that is not finite, is a coordinate out
  /// of range, or fails `checks`. Values may be anything.
  std::optional<Defect> find_defect(std::size_t first, std::size_t count,
                                    const RowChecks& checks) const;

  /// Returns the first `rows` rows as a block; `first_id`: VertexId of the first.
  VertexBlock block(std::uint64_t first_id, std::size_t rows, const ZeroedCounts& zeroed) const;

 private:
  bool all_checked_finite(std::size_t first, std::size_t count) const;
  Column::Form form_of(int slot) const;
  bool may_be_anything(int slot) const;
  double value_of(std::size_t row, int slot) const;
  bool is_placed(std::size_t row) const;

  AttributeLayout layout_;
  AttributeParts parts_;
  bool has_quantities_;
  std::size_t channels_;
  bool wide_;
  BlockMemory& memory_;
};

/// Takes vertices one by one: a reader sets the slots of the next row, then commits it.
class VertexBlocks {
 public:
  /// At most mesh.vertex_count rows will come; `first`: VertexId of the first.
  VertexBlocks(const MeshDescription& mesh, const VertexVisitor& visit, std::uint64_t first = 0);

  void set(int slot, double value);
  /// Ends the row, or returns its defect. Normals and texture coordinates that are not finite
  /// become 0 before.
  std::optional<VertexRows::Defect> commit(const RowChecks& checks);

  /// Hands out the rows that are left.
  void finish() { flush(); }

 private:
  void flush();

  const VertexVisitor& visit_;
  BlockMemory memory_;
  VertexRows rows_;
  std::size_t filled_ = 0;
  ZeroedCounts zeroed_;  ///< in the rows that are filled
  std::uint64_t first_;
};

/// Returns where a vertex lies.
using PlaceOf = std::function<Vec3d(std::uint32_t vertex)>;

/// Makes triangles of polygons and strips. All corners given are < the vertex count.
class TriangleBlocks {
 public:
  /// `place_of` returns where a vertex lies, so that polygons that are not convex are cut as their
  /// shape asks for (polygon_cut.h). Without it all become fans. Both arguments must outlive this.
  explicit TriangleBlocks(const TriangleVisitor& visit, const PlaceOf* place_of = nullptr)
      : visit_(visit),
        place_of_(place_of),
        block_(std::make_unique_for_overwrite<Triangle<VertexId>[]>(MeshSource::kBlockSize)) {}

  /// Adds a whole face of three corners.
  void add_triangle_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    ++counts_.faces;
    add(a, b, c);
  }

  /// Begins a polygon, which comes corner by corner: any number of them without places, else at
  /// most PolygonCut::kMostCorners.
  void begin_polygon() {
    corner_count_ = 0;
    corners_.clear();
  }
  void add_polygon_corner(std::uint32_t corner);
  void end_polygon();

  /// Begins a triangle strip: triangle i of a run is (i, i + 1, i + 2), with the first two corners
  /// swapped if i is odd. restart_strip() begins a new run.
  void begin_strip() { corner_count_ = 0; }
  void restart_strip() { corner_count_ = 0; }
  void add_strip_corner(std::uint32_t corner);
  void end_strip() { ++counts_.faces; }

  /// Returns how many were made so far, handed out or not.
  std::uint64_t triangles() const { return counts_.triangles + filled_; }

  /// Hands out the triangles that are left.
  FaceCounts finish();

 private:
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a == b || b == c || c == a) {
      ++counts_.degenerate_triangles;
      return;
    }
    block_[filled_++] = {VertexId{a}, VertexId{b}, VertexId{c}};
    if (filled_ == MeshSource::kBlockSize)
      flush();
  }
  void flush();
  void add_fan_corner(std::uint32_t corner);
  void cut_polygon();

  const TriangleVisitor& visit_;
  const PlaceOf* place_of_;
  std::vector<std::uint32_t> corners_;  ///< corners of the polygon, if places are known
  PolygonCut cut_;
  std::unique_ptr<Triangle<VertexId>[]> block_;  ///< kBlockSize
  std::size_t filled_ = 0;
  FaceCounts counts_;
  std::uint64_t corner_count_ = 0;
  std::uint32_t first_ = 0;  ///< a polygon's first corner; a strip's corner before the previous one
  std::uint32_t previous_ = 0;
};

}  // namespace meshhier::mesh_io
