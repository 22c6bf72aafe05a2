// OFF files (Geomview's object file format) in text.
#pragma once

#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "mesh_io/block_runner.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/mesh_blocks.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/odd_syntax.h"
#include "mesh_io/off_lines.h"
#include "mesh_io/unplaced.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace meshhier::mesh_io {

/// Returns whether a file that begins with that word is an OFF file: [ST][C][N][4][n]OFF.
bool is_off_keyword(std::string_view word);

struct OffCounts {
  std::uint64_t vertices = 0;
  FaceCounts faces;
  std::uint64_t unknown_colours = 0;  ///< faces whose colour is not three or four finite numbers
  AttributeLayout attributes;  ///< colours are u8 if all are integers from 0 to 255, else f32
  bool fits_float = true;      ///< all coordinates do (DecimalNumber)
  UnplacedVertices unplaced;   ///< which are visited all the same
  ZeroedCounts zeroed;
  OddSyntax odd;
};

/// One vertex; `attributes`: its channels in the order of AttributeLayout.
using OffVertexVisitor = std::function<void(Vec3d position, std::span<const float> attributes)>;

/// A face's colour; alpha is 1 if it has none.
struct OffColour {
  std::array<float, 4> numbers{1, 1, 1, 1};  ///< as the file has them
  bool has_alpha = false;
  bool are_bytes = false;  ///< integers from 0 to 255
};

/// One face, whose triangles are visited next or were; `triangles`: of all faces so far.
using OffFaceVisitor =
    std::function<void(std::uint64_t triangles, const std::optional<OffColour>& colour)>;

/// Reads, with comments from # to the end of a line,
///
///   [ST][C][N]OFF
///   vertices faces [edges]               also on the first line, even right behind OFF
///   x y z [nx ny nz] [r g b [a]] [s t]   a line each; alpha if the first vertex has it
///   n i1 ... in [colour]                 a line each; polygons are cut as TriangleBlocks does
///
/// Colours may also stand in a file whose first line does not say so: if the first vertex has three
/// or four numbers behind its coordinates. If the first vertex of such a file has a line of fewer
/// than three or more than seven numbers, or the first face a line that is too long for it and a
/// colour, lines may end anywhere, there are no colours, and nothing may follow. The keyword may be
/// in small letters, but for "noff", and each count on a line of its own. Lines behind the last
/// face are counted. Corners are below the count of vertices, numbers finite. Files of four
/// dimensions or in binary are refused. Throws Error(input) naming the line, Error(io).
///
/// `place_of` returns where a vertex lies that was visited. `runner` runs the blocks of the text,
/// of kOffLinesBytes each; visits come from its take().
OffCounts read_off(InputStream& stream, const std::filesystem::path& path,
                   const OffVertexVisitor& visit_vertex, const TriangleVisitor& visit_triangles,
                   const OffFaceVisitor& visit_face, const PlaceOf& place_of,
                   const BlockRunner& runner = {});

}  // namespace meshhier::mesh_io
