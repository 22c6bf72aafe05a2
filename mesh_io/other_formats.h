// The formats that people take for meshes that can be built, a row each, and other files that lie
// beside meshes: what they are, and what to do with them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// What a file is that begins so, and what to do with it: "a zip archive; unpack it, and build the
/// mesh in it". Empty if that is not known. `start`: unpacked, if the file is in gzip.
std::string other_format(std::string_view start);

/// Whether files of that ending, ".fbx", are of a known format, one that is read among them.
bool is_known_ending(std::string_view ending);

/// The endings of pictures, read or not, which may belong to a mesh.
std::vector<std::string_view> all_picture_endings();

}  // namespace meshhier::mesh_io
