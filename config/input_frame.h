// Takes up and place from the input where the config does not say them.
#pragma once

#include "config/config.h"
#include "storage/io/file.h"

namespace meshhier::config {

/// Returns the config with `up` set: if it does not say so, z if an input named *.json or *.json.gz
/// is a tileset of 3D Tiles, else y. A tileset on the globe is placed where it stands, unless the
/// config places it. Throws as mesh_io::globe_frame().
Config with_input_frame(storage::FileSystem& files, Config config);

/// Returns the config with all that its files say: with_input_frame(), then with_map().
Config with_files(storage::FileSystem& files, Config config);

}  // namespace meshhier::config
