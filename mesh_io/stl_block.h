// Facets of an ASCII STL file whose numbers are parsed apart from those before and behind them.
#pragma once

#include "mesh_io/stl_reader.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// A block of whole facets, and of beginnings and ends of solids.
struct StlBlock {
  std::vector<char> text;
  bool is_plain = false;  ///< the fields below hold all of it; else it must be read by words
  bool begins_in_solid = false, ends_in_solid = false;
  std::uint64_t lines = 0;
  /// A solid that begins: the facets of the block before it, and its name in `text`.
  struct Solid {
    std::size_t facets;
    std::string_view name;
  };
  std::vector<Solid> solids;
  std::vector<SoupTriangle> facets;
  bool fits_float = true;  ///< all coordinates do (DecimalNumber)
};

/// The largest memory of a block of LineBlocks::kBytes: a facet has 65 bytes of text.
inline constexpr std::uint64_t kStlBlockBytes = std::uint64_t{1} << 20;

/// Fills all but the text. A text that is not as simple as programs write it is not plain; parsing
/// never fails. O(bytes). Thread-safe for different blocks.
void parse_facets(StlBlock& block);

/// Returns the bytes up to the end of a text's last facet, where more text follows: a LineCut.
std::size_t whole_facets(std::string_view text);

}  // namespace meshhier::mesh_io
