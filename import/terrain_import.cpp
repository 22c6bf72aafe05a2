#include "import/terrain_import.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "import/terrain_drape.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <memory>
#include <optional>
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

}  // namespace

TerrainImport import_terrain(const InputFiles& input, std::uint64_t bytes,
                             const ImportEnvironment& environment) {
  const mesh_io::Mosaic& mosaic = *input.mosaic();
  std::optional<TerrainDrape> drape;
  if (!input.drape().empty())
    drape = open_drape(input.system(), input.drape(), mosaic);
  require_room(input, environment);
  TerrainImport made;
  Terrain& terrain = made.terrain;
  terrain.mosaic = input.mosaic();
  terrain.cells = count_cells(mosaic, bytes, environment);
  made.counts = counts_of(mosaic, *terrain.cells);
  warn_of_differences(terrain.cells->shared(), environment.progress);
  if (!drape)
    return made;
  if (drape->lies_beside) {
    environment.progress.warn(
        mesh_io::file_message(input.drape(), "lies beside the heights: nothing of them shows it"));
  }
  terrain.drape = drape->texcoords;
  terrain.materials = std::move(drape->materials);
  return made;
}

}  // namespace meshhier::importing
