// What a glTF names, found by looking through its JSON once, without keeping it.
#pragma once

#include "mesh_io/formats.h"
#include "storage/io/file.h"

namespace meshhier::mesh_io {

/// Returns the files that the buffers and the schema of a glTF or GLB, perhaps in gzip, name, each
/// once, as they would lie beside the file; and whether it says that it uses pictures in KTX2. JSON
/// that is broken ends the search: a reader tells. Throws Error(input) if there are more than
/// 65,536 buffers in files, Error(io).
MeshOutline outline_of_gltf(const storage::File& file);

}  // namespace meshhier::mesh_io
