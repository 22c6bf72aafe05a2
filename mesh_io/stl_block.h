// Facets of an ASCII STL file whose numbers are parsed apart from those before and behind them.
#pragma once

#include "mesh_io/stl_reader.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Whole facets, and beginnings and ends of solids.
struct StlBlock {
  std::vector<char> text;
  bool is_plain = false;  ///< all is as follows; else it is to be read by words
  bool begins_in_solid = false, ends_in_solid = false;
  std::uint64_t lines = 0;
  std::uint64_t solids = 0;  ///< that begin
  std::vector<SoupTriangle> facets;
  bool fits_float = true;  ///< all coordinates do (DecimalNumber)
};

/// Of a block of LineBlocks::kBytes, at most: a facet has 65 bytes of text.
inline constexpr std::uint64_t kStlBlockBytes = std::uint64_t{1} << 20;

/// Fills all but the text. What is not as simple as programs write it is not plain; it never fails.
/// O(bytes).
void parse_facets(StlBlock& block);

/// Of a text that more follows, the bytes up to the end of its last facet: a LineCut.
std::size_t whole_facets(std::string_view text);

}  // namespace meshhier::mesh_io
