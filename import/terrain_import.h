// Rasters of heights in the stage `import`: their cells are counted, their picture is looked at.
#pragma once

#include "import/import_input.h"
#include "import/terrain_source.h"

#include <cstdint>
#include <vector>

namespace meshhier::importing {

struct TerrainImport {
  Terrain terrain;
  std::vector<SourceCount> counts;
};

/// Counts the cells of the input's rasters. Their picture, if there is one, becomes the mesh's
/// material. `bytes`: of the files, by which progress advances. Warns of heights that files do not
/// agree about, and of a picture that none of them shows. Throws as open_drape() and TerrainCells;
/// Error(budget) if the rasters' blocks side by side take more memory than the import has.
TerrainImport import_terrain(const InputFiles& input, std::uint64_t bytes,
                             const ImportEnvironment& environment);

}  // namespace meshhier::importing
