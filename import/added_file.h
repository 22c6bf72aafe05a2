// Facts that the reader of a format returns about a file whose mesh it has appended.
#pragma once

#include "hierarchy/attributes.h"
#include "import/input_record.h"
#include "mesh_io/unplaced.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

/// Facts of a run of vertices that was appended to a mesh, and of their triangles.
struct AddedFile {
  AttributeLayout layout{};
  bool fits_float = true;
  std::uint64_t faces = 0;  ///< as the file declares them
  std::uint64_t degenerate_triangles = 0;
  std::uint64_t material_colours = 0;  ///< materials' colours that vertices have
  bool is_painted = false;             ///< vertices have no other colours
  mesh_io::UnplacedVertices unplaced{};
  std::uint64_t vertices = 0;
  std::uint64_t near_apart = 0;       ///< triangles that were passed over: not near the crop
  std::vector<SourceCount> counts{};  ///< what was filled in, left out or ignored, by name
  std::vector<std::string> warnings{};

  void count(std::string_view name, std::uint64_t number) { add_count(counts, name, number); }
  /// Counts what source_counts() knows.
  template <class Counts>
  void count(const Counts& more) {
    for (const SourceCount& one : source_counts(more))
      count(one.name, one.count);
  }
};

}  // namespace meshhier::importing
