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

/// Rows of vertices in a memory, written slot by slot: slots 0 to 2 are coordinates, from 3 on
/// attribute channels.
class VertexRows {
 public:
  /// What `mesh` says decides the slots. Makes room for `rows` rows in `memory`.
  VertexRows(const MeshDescription& mesh, std::size_t rows, BlockMemory& memory);

  /// Where a slot of a row goes, and the distance to the same slot of the row after it.
  struct Column {
    enum class Form : std::uint8_t { one_float, one_double, two_channels };

    std::byte* data = nullptr;
    std::size_t stride = 0;
    Form form = Form::one_float;
  };
  Column column(std::size_t row, int slot);
  /// Writes the value at `to.data`, as its type has it.
  static void put(const Column& to, double value);

  /// Of rows [first, first + count), as zero_what_is_not_finite().
  ZeroedCounts zero_what_is_not_finite(std::size_t first, std::size_t count);

  struct Defect {
    std::size_t row = 0;  ///< from the first one looked at
    int slot = 0;
    double value = 0;
  };
  /// The first number of rows [first, first + count), but for values, that is not finite, is a
  /// coordinate out of range, or is not what `checks` ask for.
  std::optional<Defect> find_defect(std::size_t first, std::size_t count,
                                    const RowChecks& checks) const;

  /// The first `rows` rows; `first_id`: VertexId of the first.
  VertexBlock block(std::uint64_t first_id, std::size_t rows, const ZeroedCounts& zeroed) const;

 private:
  bool all_checked_finite(std::size_t first, std::size_t count) const;
  Column::Form form_of(int slot) const;
  bool is_value(int slot) const;
  double value_of(std::size_t row, int slot) const;
  bool is_placed(std::size_t row) const;

  AttributeLayout layout_;
  std::size_t channels_;
  bool wide_;
  BlockMemory& memory_;
};

/// Vertices one by one: a reader sets the slots of the next row, then commits it.
class VertexBlocks {
 public:
  /// `mesh`: its vertex count is how many rows will come at most; `first`: VertexId of the first.
  VertexBlocks(const MeshDescription& mesh, const VertexVisitor& visit, std::uint64_t first = 0);

  void set(int slot, double value);
  /// Ends the row, unless it has a defect. What is not finite may become 0 before.
  std::optional<VertexRows::Defect> commit(const RowChecks& checks);

  /// Hands out what is left.
  void finish() { flush(); }

 private:
  void flush();

  const VertexVisitor& visit_;
  BlockMemory memory_;
  VertexRows rows_;
  std::size_t filled_ = 0;
  ZeroedCounts zeroed_;  ///< of the rows that are filled
  std::uint64_t first_;
};

/// Where a vertex lies.
using PlaceOf = std::function<Vec3d(std::uint32_t vertex)>;

/// Triangles of polygons and strips. All corners given are < the vertex count.
class TriangleBlocks {
 public:
  /// `place_of`: of a vertex, so that polygons that are not convex are cut as their shape asks for
  /// (polygon_cut.h). Without it all become fans. Both must outlive it.
  explicit TriangleBlocks(const TriangleVisitor& visit, const PlaceOf* place_of = nullptr)
      : visit_(visit),
        place_of_(place_of),
        block_(std::make_unique_for_overwrite<Triangle<VertexId>[]>(MeshSource::kBlockSize)) {}

  /// A whole face of three corners.
  void add_triangle_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    ++counts_.faces;
    add(a, b, c);
  }

  /// A polygon corner by corner, of any number without places, else of PolygonCut::kMostCorners.
  void begin_polygon() {
    corner_count_ = 0;
    corners_.clear();
  }
  void add_polygon_corner(std::uint32_t corner);
  void end_polygon();

  /// A triangle strip: triangle i of a run is (i, i + 1, i + 2), with the first two corners swapped
  /// if i is odd. restart_strip() begins a new run.
  void begin_strip() { corner_count_ = 0; }
  void restart_strip() { corner_count_ = 0; }
  void add_strip_corner(std::uint32_t corner);
  void end_strip() { ++counts_.faces; }

  /// Made so far, handed out or not.
  std::uint64_t triangles() const { return counts_.triangles + filled_; }

  /// Hands out what is left.
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
  std::vector<std::uint32_t> corners_;  ///< of a polygon, if places are known
  PolygonCut cut_;
  std::unique_ptr<Triangle<VertexId>[]> block_;  ///< kBlockSize
  std::size_t filled_ = 0;
  FaceCounts counts_;
  std::uint64_t corner_count_ = 0;
  std::uint32_t first_ = 0;  ///< of a polygon; of a strip: the corner before the previous one
  std::uint32_t previous_ = 0;
};

}  // namespace meshhier::mesh_io
