// Takes up and place from the input where the config does not say them.
#pragma once

#include "config/config.h"
#include "storage/io/file.h"

namespace meshhier::config {

/// Returns the config with `up` set: if it does not say so, z if an input is a tileset of 3D Tiles,
/// a raster of heights or a folder with coordinates of a map, else y. A tileset on the globe, a
/// raster whose map is known and a folder that says where it is are placed there, unless the config
/// places them. Throws as mesh_io::globe_frame(), mesh_io::Mosaic, mesh_io::meshes_of() and
/// with_map().
Config with_input_frame(storage::FileSystem& files, Config config);

/// Returns the config with all that its files say: with_input_frame(), then with_map().
Config with_files(storage::FileSystem& files, Config config);

}  // namespace meshhier::config
