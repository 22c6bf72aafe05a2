// The data behind a PLY header, element by element, in binary or in text.
#pragma once

#include "base/error.h"
#include "mesh_io/byte_window.h"
#include "mesh_io/mesh_blocks.h"
#include "mesh_io/odd_syntax.h"
#include "mesh_io/ply_faces.h"
#include "mesh_io/ply_plan.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

namespace meshhier::mesh_io {

/// A place in a file: the byte, and in text also the number of its line.
struct PlyPosition {
  std::uint64_t offset = 0;
  std::uint64_t line = 0;
};

/// A cursor over the rows. Every call starts at position() and ends behind the element's last row.
/// Throws Error(input) with the byte (binary) or line (text) of what is wrong, Error(io).
class PlyBody {
 public:
  virtual ~PlyBody() = default;

  virtual PlyPosition position() const = 0;
  virtual void skip(const PlyElementPlan& plan) = 0;
  /// Both read rows without a fixed size (ply_fixed_rows.h reads the others), from row `first` on,
  /// which begins at position().
  virtual void read_vertices(const PlyElementPlan& plan, std::uint64_t first,
                             VertexBlocks& blocks) = 0;
  virtual void read_faces(const PlyElementPlan& plan, std::uint64_t first,
                          TriangleBlocks& blocks) = 0;
  /// Visits whole rows of any element, with the properties for which plan.takes() is true. Lists
  /// have at most 2 * PlyFace::kMostCorners items, those of corners half as many. Vertex indices
  /// may have any value.
  virtual void read_rows(const PlyElementPlan& plan, const PlyRowVisitor& visit) = 0;
  /// Requires that nothing follows but one line end, perhaps behind up to two zeros (binary), or
  /// lines of which none could be one more row of an element (text).
  virtual void expect_end() = 0;
  /// Returns the oddities since the last call.
  virtual OddSyntax take_odd() = 0;
};

/// All refer to the file and the plan. Memory: one ByteWindow.
std::unique_ptr<PlyBody> make_binary_body(const InputFile& input, const PlyPlan& plan,
                                          PlyPosition start);
/// A row begins a line, as the format has it, and may go on in the next ones; rows that are longer
/// or shorter than the header says are errors. Integers may be written as floats. Numbers that
/// nothing asks for are not checked.
std::unique_ptr<PlyBody> make_text_body(const InputFile& input, const PlyPlan& plan,
                                        PlyPosition start);
/// Makes the body for the encoding that the file has.
std::unique_ptr<PlyBody> make_body(const InputFile& input, const PlyPlan& plan, PlyPosition start);

/// Returns whether `index` restarts a strip: -1, which a uint holds as 2^32 - 1 (no vertex can have
/// it).
bool is_strip_restart(std::int64_t index, PlyType type);

/// Returns "row 17 of 20 of element 'face'"; rows count from 0, as vertex indices do.
std::string row_name(const PlyElementPlan& plan, std::uint64_t row);
/// Says that the number read for a slot is not finite, no coordinate, or no colour.
std::string defect_text(const PlyElementPlan& plan, std::uint64_t row, int slot, double value);
/// Throws the error that `fail` throws; as UnplacedVertexError, if the defect is a coordinate that
/// is not finite.
template <class Fail>
void fail_for(const VertexRows::Defect& defect, const Fail& fail) {
  try {
    fail();
  } catch (const Error& error) {
    if (defect.slot < kFirstAttributeSlot && !std::isfinite(defect.value))
      throw UnplacedVertexError(error);
    throw;
  }
}
/// Returns the most items of a list that is read as a whole.
std::size_t most_items(const PlyElementPlan& plan, std::size_t property);
/// Says that such a list is longer.
std::string corners_text(const PlyElementPlan& plan, std::uint64_t row, std::uint64_t count);
/// Says that a face refers to a vertex that is not there.
std::string index_text(const PlyElementPlan& plan, std::uint64_t row, std::int64_t index,
                       std::uint64_t vertex_count);

}  // namespace meshhier::mesh_io
