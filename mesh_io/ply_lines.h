// Rows of a PLY in text, a line each, decoded block by block, by as many threads as there are.
//
// Rows that are not as simple as programs write them are left to make_text_body(), which also says
// what is wrong with them: lists of vertices, blank lines, lines that end with CR alone, values
// that are refused.
#pragma once

#include "mesh_io/block_runner.h"
#include "mesh_io/byte_window.h"
#include "mesh_io/mesh_blocks.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_body.h"
#include "mesh_io/ply_plan.h"

#include <cstdint>

namespace meshhier::mesh_io {

/// The end of reading in an element: all rows before `row` were read; the search for `row` goes on
/// at `position`.
struct PlyLinesRead {
  std::uint64_t row = 0;
  PlyPosition position;
};

/// The memory of a block: its text, of twice a checksum's block at most, and up to four times as
/// much for its rows' numbers.
inline constexpr std::uint64_t kPlyLinesBytes = std::uint64_t{1} << 21;

/// Visits vertices from `start` on. Throws Error(io), and what `visit` does.
PlyLinesRead read_vertex_lines(const InputFile& input, const PlyPlan& plan,
                               const MeshDescription& mesh, PlyPosition start,
                               const VertexVisitor& visit, const BlockRunner& runner);

/// Gives the polygons of an element to `blocks`; reads no strips. Throws likewise.
PlyLinesRead read_polygon_lines(const InputFile& input, const PlyElementPlan& faces,
                                std::uint64_t vertex_count, PlyPosition start,
                                TriangleBlocks& blocks, const BlockRunner& runner);

}  // namespace meshhier::mesh_io
