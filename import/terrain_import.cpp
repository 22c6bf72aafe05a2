#include "import/terrain_import.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "import/terrain_drape.h"
#include "import/terrain_map.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// Refuses rasters whose blocks side by side take more than the import has.
void require_room(const InputFiles& input, const ImportEnvironment& environment) {
  const std::uint64_t room = 4 * environment.sort_bytes;
  const std::uint64_t held = input.mosaic()->held_bytes();
  if (room == 0 || held <= room)
    return;
  throw Error(ErrorCode::budget,
              mesh_io::file_message(
                  input.all().front().path,
                  fmt::format("its rows of blocks take {} MiB of memory, the import has {}; give "
                              "a larger memory_budget, or smaller blocks (`gdal_translate -co "
                              "TILED=YES -co BLOCKXSIZE=256 -co BLOCKYSIZE=256`)",
                              held >> 20, room >> 20)));
}

std::shared_ptr<const TerrainCells> count_cells(const mesh_io::Mosaic& mosaic, std::uint64_t bytes,
                                                const ImportEnvironment& environment) {
  double done = 0;
  const auto advance = [&](double part) {
    const auto before = static_cast<std::uint64_t>(done * static_cast<double>(bytes));
    done = std::min(1.0, done + part);
    environment.progress.advance(static_cast<std::uint64_t>(done * static_cast<double>(bytes)) -
                                 before);
  };
  return std::make_shared<const TerrainCells>(mosaic, advance, environment.cancel);
}

std::vector<SourceCount> counts_of(const mesh_io::Mosaic& mosaic, const TerrainCells& cells) {
  const mesh_io::SharedCells& shared = cells.shared();
  std::vector<SourceCount> counts;
  add_count(counts, "cells_without_height", mosaic.cells() - cells.vertices());
  add_count(counts, "cells_in_several_files", shared.equal + shared.different);
  add_count(counts, "cells_with_different_heights", shared.different);
  return counts;
}

void warn_of_differences(const mesh_io::SharedCells& shared, execution::Progress& progress) {
  if (shared.different == 0)
    return;
  progress.warn(fmt::format(
      "{} that several files have differ, by up to {:.3g}: the files that come first count",
      counted(shared.different, "heights"), shared.most));
}

/// Brings degrees to the map that the config asks for.
void find_map(const InputFiles& input, execution::Progress& progress, Terrain& terrain) {
  const mesh_io::Mosaic& mosaic = *input.mosaic();
  if (input.crs().empty() || mosaic.keys().kind != geodesy::MapKind::degrees)
    return;
  TerrainMap map = bring_to_map(mosaic, input.crs());
  for (const std::string& warning : map.warnings)
    progress.warn(mesh_io::file_message(mosaic.path(), warning));
  terrain.map = std::move(map.places);
}

/// Lays the picture onto the heights, if there is one.
void find_drape(const InputFiles& input, execution::Progress& progress, Terrain& terrain) {
  if (input.drape().empty())
    return;
  TerrainDrape drape = open_drape(input.system(), input.drape(), *input.mosaic(), input.crs());
  for (const std::string& warning : drape.warnings)
    progress.warn(warning);
  terrain.drape = std::move(drape.texcoords);
  terrain.materials = std::move(drape.materials);
  terrain.beside = std::move(drape.beside);
}

}  // namespace

TerrainImport import_terrain(const InputFiles& input, std::uint64_t bytes,
                             const ImportEnvironment& environment) {
  require_room(input, environment);
  TerrainImport made;
  Terrain& terrain = made.terrain;
  terrain.mosaic = input.mosaic();
  find_map(input, environment.progress, terrain);
  find_drape(input, environment.progress, terrain);
  terrain.cells = count_cells(*terrain.mosaic, bytes, environment);
  made.counts = counts_of(*terrain.mosaic, *terrain.cells);
  warn_of_differences(terrain.cells->shared(), environment.progress);
  return made;
}

}  // namespace meshhier::importing
