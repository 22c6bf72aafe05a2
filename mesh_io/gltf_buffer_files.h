// The files that the buffers of a glTF file lie in, without reading more than one token at a time.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <vector>

namespace meshhier::mesh_io {

/// Returns the files that a glTF or GLB, packed by gzip or not, names for its buffers: each once,
/// in the order of the document, whether they are there or not. A broken file gives those before
/// its defect. Memory does not depend on the file, but for the names. Throws Error(io), and
/// Error(input) if the file is damaged gzip or has more than 65536 buffers in files.
std::vector<std::filesystem::path> gltf_buffer_files(const storage::File& file);

}  // namespace meshhier::mesh_io
