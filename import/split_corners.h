// Corners of triangles that show something else than others at the same vertex of a file become
// vertices of their own, out of core.
//
// Problem. In OBJ and PLY files corners have references: a position, and apart from it a texture
// coordinate, a normal, a material, values of the face. Vertices of a mesh have all of it together.
//
// Idea. Corners are sorted by position and parts; each group of equal ones is a vertex:
//
//       corner   0     1     2     3     4     5        sorted     p0 a  p1 a  p1 b  p2 a
//       shows    p0 a  p1 a  p2 a  p1 b  p2 a  p0 a     corners    0,5   1     3     2,4
//                                                       vertex      0     1     2     3
//
// A second sort, by corner, brings the numbers back to the triangles. Most positions show one
// combination alone, so with enough memory a table holds the first one of each position, and only
// the corners that show another one (3 above) are sorted.
//
// Invariant. Vertices are ordered by position, then by parts, with the table or without: the result
// depends on the corners alone.
//
// Cost. Two sorts of the corners, or of those that are not in the table.
#pragma once

#include "execution/spool_cursor.h"
#include "import/raw_mesh.h"
#include "partition/external_sort.h"

#include <array>
#include <cstdint>
#include <functional>
#include <tuple>
#include <vector>

namespace meshhier::importing {

/// A corner's parts: a vertex of the file, and the corner's own attributes there, as references or
/// as bits; 0 is none.
struct CornerParts {
  static constexpr std::size_t kCount = 4;
  static constexpr std::size_t kValues = 2;    ///< number of its face's values, from 1 on
  static constexpr std::size_t kMaterial = 3;  ///< its number in the mesh's table, from 1 on

  using Parts = std::array<std::uint32_t, kCount>;
  std::uint32_t position = 0;
  Parts parts{};
  friend bool operator==(const CornerParts&, const CornerParts&) = default;
};

using References = storage::RecordSpool<std::uint32_t>;

/// Vertices, one for each combination that corners use and for each position that none uses.
struct SplitVertices {
  explicit SplitVertices(storage::ScratchFile& scratch)
      : positions(scratch, kImportSpoolBytes),
        parts{{References(scratch, kImportSpoolBytes), References(scratch, kImportSpoolBytes),
               References(scratch, kImportSpoolBytes), References(scratch, kImportSpoolBytes)}} {}

  std::uint64_t count() const { return positions.size(); }
  /// Throws Error(input) if there are 2^32 vertices or more.
  void add(const CornerParts& vertex);

  References positions;
  std::array<References, CornerParts::kCount> parts;
  std::array<std::uint64_t, CornerParts::kCount> without{};  ///< vertices whose part is 0
};

/// Reads the vertices forwards.
class SplitCursor {
 public:
  SplitCursor(const SplitVertices& vertices, const execution::CancelToken& cancel)
      : positions_(vertices.positions, cancel),
        parts_{{{vertices.parts[0], cancel},
                {vertices.parts[1], cancel},
                {vertices.parts[2], cancel},
                {vertices.parts[3], cancel}}} {}

  std::uint64_t size() const { return positions_.size(); }
  std::uint32_t position(std::uint64_t vertex) { return positions_.at(vertex); }
  CornerParts::Parts parts(std::uint64_t vertex) {
    return {parts_[0].at(vertex), parts_[1].at(vertex), parts_[2].at(vertex), parts_[3].at(vertex)};
  }

 private:
  using Cursor = execution::SpoolCursor<std::uint32_t>;
  Cursor positions_;
  std::array<Cursor, CornerParts::kCount> parts_;
};

/// Takes the corners of triangles, three after three, then numbers their vertices. For one thread.
class CornerSplitter {
 public:
  /// `positions`: how many the file has; a corner's is below.
  CornerSplitter(std::uint64_t positions, const ImportRoom& room);

  /// Requires corner.position < positions.
  void add(const CornerParts& corner);
  /// Appends the triangles to `mesh`, whose next vertices will be `vertices`: they are ordered by
  /// position, then by their parts. `hides_material` is asked for ascending positions, perhaps
  /// again for the same one, whether corners there have no material after all; empty: all keep
  /// theirs. Called once.
  void split(SplitVertices& vertices, RawMesh& mesh,
             const std::function<bool(std::uint32_t)>& hides_material = {});

 private:
  using Parts = CornerParts::Parts;
  struct Use {
    CornerParts shown;
    std::uint32_t corner_high, corner_low;  ///< not a u64, so that nothing is padded

    std::uint64_t corner() const { return std::uint64_t{corner_high} << 32 | corner_low; }
  };
  /// The order of uses; among equal ones the corner does not matter.
  struct UseKey {
    using Key = std::tuple<std::uint64_t, std::uint64_t, std::uint32_t>;
    Key operator()(const Use& use) const {
      const auto& [position, parts] = use.shown;
      return {std::uint64_t{position} << 32 | parts[0], std::uint64_t{parts[1]} << 32 | parts[2],
              parts[3]};
    }
  };
  struct CornerVertex {
    std::uint64_t corner, vertex;
  };
  struct CornerKey {
    std::uint64_t operator()(const CornerVertex& c) const { return c.corner; }
  };
  using CornerSort = partition::ExternalSort<CornerVertex, CornerKey>;
  class Numbering;

  bool has_table() const { return !firsts_.empty(); }
  void number(Numbering& numbering, CornerSort& corners);
  void append_triangles(CornerSort& corners, std::uint64_t base, RawMesh& mesh);
  void append_looked_up(CornerSort& corners, std::uint64_t base, RawMesh& mesh);

  static constexpr std::uint32_t kUnused = UINT32_MAX;
  static constexpr std::uint64_t kTableBytes = sizeof(Parts) + sizeof(std::uint32_t);

  std::uint64_t positions_;
  const ImportRoom& room_;
  std::vector<Parts> firsts_;            ///< parts of the first corner at each position; or empty
  std::vector<std::uint32_t> vertices_;  ///< numbers of these; kUnused until there is a corner
  storage::RecordSpool<CornerParts> shown_;    ///< all corners, if there is a table
  std::uint64_t sort_bytes_;                   ///< memory of each of two sorts
  partition::ExternalSort<Use, UseKey> uses_;  ///< all corners, or those that are not in the table
  std::uint64_t corners_ = 0;
};

}  // namespace meshhier::importing
