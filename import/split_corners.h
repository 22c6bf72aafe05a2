// Corners of triangles that show something else than others at the same vertex of a file become
// vertices of their own, out of core.
#pragma once

#include "import/raw_mesh.h"
#include "partition/external_sort.h"

#include <array>
#include <cstdint>
#include <functional>
#include <utility>

namespace meshhier::importing {

/// What a corner shows: a vertex of the file, and what it has there, as references or as bits; 0 is
/// none.
struct CornerParts {
  static constexpr std::size_t kCount = 3;
  static constexpr std::size_t kMaterial = 2;  ///< its number in the mesh's table, from 1 on

  std::uint32_t position = 0;
  std::array<std::uint32_t, kCount> parts{};
  friend bool operator==(const CornerParts&, const CornerParts&) = default;
};

using References = storage::RecordSpool<std::uint32_t>;

/// Vertices, one for each combination that corners use and for each position that none uses.
struct SplitVertices {
  explicit SplitVertices(storage::ScratchFile& scratch)
      : positions(scratch, kImportSpoolBytes),
        parts{{References(scratch, kImportSpoolBytes), References(scratch, kImportSpoolBytes),
               References(scratch, kImportSpoolBytes)}} {}

  std::uint64_t count() const { return positions.size(); }
  /// Throws Error(input) if there are 2^32 vertices or more.
  void add(const CornerParts& vertex);

  References positions;
  std::array<References, CornerParts::kCount> parts;
  std::array<std::uint64_t, CornerParts::kCount> without{};  ///< vertices whose part is 0
};

/// Takes the corners of triangles, three after three, then sorts them.
class CornerSplitter {
 public:
  explicit CornerSplitter(const ImportRoom& room)
      : room_(room), uses_(room.scratch, room.sort_bytes) {}

  void add(const CornerParts& corner);
  /// Appends the triangles to `mesh`, whose next vertices will be `vertices`: they are ordered by
  /// position, then by their parts. `positions`: how many the file has. `hides_material`: asked of
  /// ascending positions, of the same one perhaps again, whether corners there have no material
  /// after all; empty: none. Once.
  void split(std::uint64_t positions, SplitVertices& vertices, RawMesh& mesh,
             const std::function<bool(std::uint32_t)>& hides_material = {});

 private:
  struct Use {
    CornerParts shown;
    std::uint32_t corner_high, corner_low;  ///< not a u64, so that nothing is padded

    std::uint64_t corner() const { return std::uint64_t{corner_high} << 32 | corner_low; }
  };
  /// Of equal ones the corner does not matter.
  struct UseKey {
    using Key = std::pair<std::uint64_t, std::uint64_t>;
    Key operator()(const Use& use) const {
      const auto& [position, parts] = use.shown;
      return {std::uint64_t{position} << 32 | parts[0], std::uint64_t{parts[1]} << 32 | parts[2]};
    }
  };
  struct CornerVertex {
    std::uint64_t corner, vertex;
  };
  struct CornerKey {
    std::uint64_t operator()(const CornerVertex& c) const { return c.corner; }
  };
  using CornerSort = partition::ExternalSort<CornerVertex, CornerKey>;

  void number(std::uint64_t positions, const std::function<bool(std::uint32_t)>& hides_material,
              SplitVertices& vertices, CornerSort& corners);
  void append_triangles(CornerSort& corners, std::uint64_t base, RawMesh& mesh);

  const ImportRoom& room_;
  partition::ExternalSort<Use, UseKey> uses_;
  std::uint64_t corners_ = 0;
};

}  // namespace meshhier::importing
