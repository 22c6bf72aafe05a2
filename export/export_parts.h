// Writes parts of a hierarchy as GLB and OBJ. For export*.cpp only.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/cut_part.h"
#include "hierarchy/ids.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/io/file.h"
#include "storage/io/output_file.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace meshhier::exporting {

/// The parts to be written, tile by tile. `load` and `places` return the same for the same number.
struct ExportedParts {
  std::size_t count = 0;
  std::function<NodeId(std::size_t)> node;
  std::function<CutPart(std::size_t)> load;
  /// One vertex for each of the part's own places; those of all parts have the numbers that
  /// CutPart::places names, from 0 on.
  std::function<VertexArray(std::size_t)> places;
};

struct PartsJob {
  storage::FileSystem& files;
  const storage::HierarchyReader& reader;
  const storage::OutputRequest& request;
  storage::OutputFile& output;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
  std::uint64_t memory_budget;
  bool numbers_objects = false;  ///< an OBJ names objects by their numbers
};

/// Writes glTF binary: a primitive and a picture a tile, and a table of the objects. Reads each
/// part twice; holds one, and some 80 bytes for each. Throws Error(usage) if there are no
/// triangles, or more than a GLB can hold. Both return a line for people.
std::string write_glb(const PartsJob& job, const ExportedParts& parts);

/// Writes Wavefront OBJ, a group a tile, or the faces of each object behind "o" and its name; for a
/// textured hierarchy also NAME.mtl, a material a tile, and the pictures in NAME_textures, WebP as
/// PNG. They appear before the OBJ does; throws Error(exists) if they are there already and not to
/// be replaced. Holds one part. Publishes the output.
std::string write_obj(const PartsJob& job, const ExportedParts& parts);

}  // namespace meshhier::exporting
