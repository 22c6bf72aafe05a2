// Writes parts of a hierarchy as an ordinary mesh: PLY, or with pictures GLB or OBJ.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "export/cut_by_error.h"
#include "hierarchy/ids.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace meshhier::exporting {

/// The outline's lines.
struct OutlineSelection {};

/// A whole level (Cut::of_level); one node's tile with its border triangles and
/// ghosts; the cut in a text file (inspection/cut_file.h); tiles by their error; the
/// outline.
using ExportSelection =
    std::variant<Level, NodeId, std::filesystem::path, LargestError, OutlineSelection>;

struct ExportOptions {
  ExportSelection selection;
  /// A file or a stream (storage::OutputFile); .glb and .obj by its ending, all else is PLY.
  std::filesystem::path output;
  std::uint64_t memory_budget = 1U << 30;  ///< bytes
  bool replace = false;                    ///< a file that is there
  /// Nothing else is written, and tiles elsewhere are not read. Of cuts only.
  RegionRequest region{};
  bool clip = false;  ///< triangles end where the region does; else those that touch it come whole
};

/// The files that an export reads besides the hierarchy: none takes their place.
std::vector<std::filesystem::path> files_named(const ExportOptions& options);

/// Assembles the selection seamlessly, tile by tile, into options.output.
///
/// GLB and OBJ have the pictures of a textured hierarchy, and a primitive or group a tile: what the
/// tile draws, at vertices of its own in a GLB, at common positions in an OBJ. The outline goes
/// into a PLY alone.
///
/// Of a region the tiles of an OBJ share no positions, and vertices of a PLY come as triangles
/// first use them; those of one place with the same attributes are one.
///
/// A PLY has no textures. Vertices are shared
/// between tiles; coordinates are doubles if the hierarchy has an origin. Triangles of the input
/// come with all their copies, of coarser ones exact duplicates (same corners, same orientation)
/// come once. Vertices of a level or cut are those of CutVertices, of a node they come as in its
/// file. Triangles of a level or cut start with their smallest corner and ascend, tile by tile;
/// those of the last level ascend as a whole, and its places are in the order of ranks. The output
/// appears complete or not at all. Returns a line for people. Deterministic. Throws Error(usage) if
/// the selection is not in the tree, the cut file is no cut, or nothing lies in the
/// region; Error(budget) if the borders of tiles in it exceed the memory; Error(input) for a
/// polygon that is none; Error(io | corrupt).
std::string export_mesh(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                        const ExportOptions& options, execution::Progress& progress,
                        const execution::CancelToken& cancel);

}  // namespace meshhier::exporting
