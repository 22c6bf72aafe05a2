// STL files (3D Systems, 1988) as soups of triangles.
#pragma once

#include "base/vec.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/odd_syntax.h"
#include "mesh_io/stl_colours.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace meshhier::mesh_io {

// A binary file: 80 bytes of any kind, the count of facets as u32, then facets of 12 float32 (the
// normal, then three corners) and a u16 of no fixed meaning. Little endian.
inline constexpr std::size_t kStlHeaderBytes = 84;
inline constexpr std::size_t kStlFacetBytes = 50;

using SoupTriangle = std::array<Vec3d, 3>;
using SoupVisitor = std::function<void(std::span<const SoupTriangle>)>;
/// Visits the name of a solid of a text, before its facets.
using StlSolidVisitor = std::function<void(std::string_view name)>;
/// Visits the last two bytes of the facets of the SoupVisitor's call before.
using StlAttributeVisitor = std::function<void(std::span<const std::uint16_t>)>;

/// Facets with a coordinate that is not finite: they are not handed out.
struct DroppedFacets {
  std::uint64_t count = 0;
  std::string first;  ///< for messages: file, place, which facet, and what was found
};

struct StlCounts {
  std::uint64_t facets = 0;
  std::uint64_t solids = 0;      ///< solids of a text
  std::uint64_t attributes = 0;  ///< facets of a binary file whose last two bytes are not 0
  std::optional<StlColour> header_colour;
  DroppedFacets dropped;
  std::uint64_t bytes_behind = 0;  ///< bytes behind the last facet of a binary file: ignored
  bool fits_float = true;          ///< all coordinates do (DecimalNumber)
  OddSyntax odd;
};

/// Returns whether a word of an ASCII file is this keyword, in any case.
bool is_stl_keyword(std::string_view word, std::string_view keyword);

/// Hands out all facets in order, in blocks; their normals, which follow from the corners, are
/// ignored. A count of 0 in the header means all facets up to the end: some programs do not go back
/// to write it. Facets number from 0. Throws Error(input) naming the byte of the content,
/// Error(io).
StlCounts read_binary_stl(InputStream& stream, const std::filesystem::path& path,
                          const SoupVisitor& visit,
                          const StlAttributeVisitor& visit_attributes = {});

struct StlBlock;

/// Reads an ASCII file of one solid or several from blocks that were parsed apart from each other.
/// Throws as read_text_stl(). For one thread.
class StlTextReader {
 public:
  /// Path and visitor must outlive it.
  StlTextReader(const std::filesystem::path& path, const SoupVisitor& visit,
                StlSolidVisitor visit_solid = {});
  ~StlTextReader();

  /// Takes the blocks of the file in their order (LineBlocks, by whole_facets()).
  void take(const StlBlock& block);
  /// Reads the text behind the blocks by words. Once, after all blocks.
  void take_rest(InputStream& rest);
  StlCounts finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Does the same as read_binary_stl() for an ASCII file; errors name the line. A solid's end may be
/// glued to its name, or be two words. A solid may begin where another one has not ended, and end
/// twice: these lines are counted as odd.
StlCounts read_text_stl(InputStream& stream, const std::filesystem::path& path,
                        const SoupVisitor& visit);

}  // namespace meshhier::mesh_io
