// Folders of OSGB tiles, as programs of photogrammetry leave them.
//
//   Data/Tile_+000_+000/Tile_+000_+000.osgb          ContextCapture, Smart3D
//                      /Tile_+000_+000_L18_0.osgb    a finer one, which the first one names
//   terra_osgbs/Data/BlockA/BlockA.osgb              DJI Terra, also without Data
//   model/scan.osgb, scan_L1_0.osgb                  all files in one folder
//
// A finer file has the name of its tile, "_L" and a level. Where the tile's first file is not
// there, those of its least level are the first ones.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <vector>

namespace meshhier::mesh_io {

/// Returns the first files of the tiles that a folder has: in folders of their names, or the one of
/// its own name, else all that lie in it and are no finer ones. Empty if it has none.
std::vector<std::filesystem::path> osgb_tiles(storage::FileSystem& files,
                                              const std::filesystem::path& folder);

/// Returns the tiles of a folder, or of the one in it that has a usual name.
std::vector<std::filesystem::path> find_osgb_tiles(storage::FileSystem& files,
                                                   const std::filesystem::path& folder);

/// Returns the tiles of the one folder below that has some, up to five levels down. Throws
/// Error(usage) if several have.
std::vector<std::filesystem::path> osgb_tiles_below(storage::FileSystem& files,
                                                    const std::filesystem::path& folder);

/// Returns the file that places an OSGB tile: a metadata.xml beside it, or in one of the two
/// folders above; none if there is none.
std::vector<std::filesystem::path> osgb_maps(storage::FileSystem& files,
                                             const std::filesystem::path& tile);

/// Returns the files that lie beside an OSGB file and belong to its tile by their names: all others
/// in a folder of its name, else those that begin with its name.
std::vector<std::filesystem::path> osgb_family(storage::FileSystem& files,
                                               const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
