// Files that people take for meshes that can be built.
#pragma once

#include <string>
#include <string_view>

namespace meshhier::mesh_io {

/// What a file is that begins so, and what to do with it: "a zip archive; unpack it, and build the
/// mesh in it". Empty if that is not known. `start`: unpacked, if the file is in gzip.
std::string foreign_format(std::string_view start);

}  // namespace meshhier::mesh_io
