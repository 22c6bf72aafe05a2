// Lines of an OBJ file whose numbers are parsed apart from those before and behind them.
//
// Problem. Parsing numbers takes nearly all of the time of an OBJ, and a line's meaning depends on
// all lines before it: indices count from the start or back from here, usemtl holds until the next.
//
// Idea. Blocks of whole lines are parsed in parallel into runs of like lines, as numbers without a
// meaning. The reader takes the blocks in their order and knows what their numbers mean:
//
//     text                    runs                          numbers
//     v 0 0 0                 positions, 2 lines            positions 0 0 0, 1 0 0
//     v 1 0 0
//     usemtl brick            others, 1 line at byte 16     (read by words)
//     f 1/1 2/2 3/3           faces, 2 lines, v/vt, 3       indices 1 1 2 2 3 3, 3 3 2 2 4 4
//     f 3/3 2/2 4/4
//
// Invariant. Lines that are not as simple as this (errors among them) are left to the reader by
// words: there is one place that says what is wrong.
#pragma once

#include "base/vec.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// The beginning of lines that look like comments and are colours of ZBrush.
inline constexpr std::string_view kObjPolypaint = "#MRGB";

/// Lines that follow one another and say the same kind of thing, a line each.
struct ObjRun {
  enum class Kind : std::uint8_t {
    positions,  ///< v x y z
    coloured,   ///< v x y z r g b
    texcoords,  ///< vt u v [w]
    normals,    ///< vn x y z
    faces,      ///< f of 3 or more corners that all name the same kinds of things
    nothing,    ///< blank, or a comment
    others      ///< whatever else: to be read by words
  };
  Kind kind = Kind::nothing;
  std::uint8_t corners = 0;   ///< corners of each face
  bool has_texcoord = false;  ///< its corners: v/vt or v/vt/vn
  bool has_normal = false;    ///< v//vn or v/vt/vn
  std::uint32_t lines = 0;
  std::uint32_t begin = 0;  ///< the place of its text in that of the block

  bool is_like(const ObjRun& run) const {
    return kind == run.kind && corners == run.corners && has_texcoord == run.has_texcoord &&
           has_normal == run.has_normal;
  }
  /// Returns how many numbers each face has.
  std::size_t indices() const {
    return corners * (std::size_t{1} + (has_texcoord ? 1 : 0) + (has_normal ? 1 : 0));
  }
};

/// A parsed block. Its numbers are sound in themselves; whether indices refer to something is not
/// checked.
struct ObjBlock {
  std::vector<char> text;  ///< whole lines
  std::vector<ObjRun> runs;
  std::vector<Vec3d> positions;                 ///< coordinates, in range
  std::vector<std::array<float, 3>> colours;    ///< colours of coloured runs
  std::vector<std::array<float, 2>> texcoords;  ///< finite
  std::vector<std::array<float, 3>> normals;    ///< finite
  std::vector<std::int32_t> indices;  ///< faces' indices as the file has them: v [vt] [vn] ...
  bool fits_float = true;             ///< all coordinates do (DecimalNumber)
};

/// The largest memory of a block of LineBlocks::kBytes: a line of 8 bytes is a run and a position.
inline constexpr std::uint64_t kObjBlockBytes = std::uint64_t{7} << 18;

/// Fills all but the text. Lines that are not as simple as above become runs of `others`, which the
/// reader reads by words; it never fails. O(bytes). Thread-safe for different blocks.
void parse(ObjBlock& block);

}  // namespace meshhier::mesh_io
