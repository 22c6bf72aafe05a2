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

/// Selects the outline's lines.
struct OutlineSelection {};

/// The part to be exported: a whole level (Cut::of_level); one node's tile with its border
/// triangles and ghosts; the cut in a text file (cut_file.h); tiles by their error; the outline.
using ExportSelection =
    std::variant<Level, NodeId, std::filesystem::path, LargestError, OutlineSelection>;

struct ExportOptions {
  ExportSelection selection;
  /// A file or a stream (storage::OutputFile); .glb and .obj by its ending, all else is PLY.
  std::filesystem::path output;
  std::uint64_t memory_budget = 1U << 30;  ///< bytes
  bool replace = false;                    ///< takes the place of a file that is there
  /// Nothing else is written, and tiles elsewhere are not read. Not of the outline.
  RegionRequest region{};
  bool clip = false;  ///< triangles end where the region does; else those that touch it come whole
  bool numbers_objects = false;  ///< an OBJ names objects by their numbers, not by their names
};

/// Returns the files that an export reads besides the hierarchy; its output must not replace them.
std::vector<std::filesystem::path> files_named(const ExportOptions& options);

/// Assembles the selection seamlessly, tile by tile, into options.output. Returns a line for
/// people.
///
/// GLB and OBJ have the pictures of a textured hierarchy, and a primitive or group a tile: its
/// triangles, at vertices of its own in a GLB, at common positions in an OBJ. Of a mesh of objects
/// the groups of an OBJ are these. The tiles of an OBJ of a region share no positions. The outline
/// goes into a PLY alone.
///
/// A PLY has no textures. Vertices are shared between tiles; coordinates are doubles if the
/// hierarchy has an origin. Vertices of a level or cut are those of CutVertices; those of a node
/// come as in its file; those of a region come as triangles first use them, and vertices of one
/// place with the same attributes are one. Triangles of the input come with all their copies; of
/// coarser ones exact duplicates (same corners, same orientation) come once. Triangles of a level
/// or cut start with their smallest corner and ascend, tile by tile; those of the last level ascend
/// as a whole, and its places are in the order of ranks.
///
/// The output appears complete or not at all, and depends on hierarchy and options alone. Throws
/// Error(usage) if the output has another format's ending, lies in a hierarchy or would replace
/// what is read, a region is asked for with the outline, the outline is to go into a GLB
/// or OBJ, the selection is not in the tree, the cut file is no cut, or nothing lies in the region;
/// Error(budget) if the borders of tiles in it exceed the memory; Error(input) for a polygon that
/// is none; Error(io | corrupt | exists | interrupted).
std::string export_mesh(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                        const ExportOptions& options, execution::Progress& progress,
                        const execution::CancelToken& cancel);

}  // namespace meshhier::exporting
