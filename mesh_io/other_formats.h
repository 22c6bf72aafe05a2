// Formats that are not read, a row each: formats that people take for meshes that can be built, and
// files that lie beside meshes. Each row says what such a file is and what to do with it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Returns what a file is that begins with `start`, and what to do with it: "a zip archive; unpack
/// it, and build the mesh in it". Empty if that is not known. `start`: unpacked, if the file is in
/// gzip.
std::string other_format(std::string_view start);

/// Returns whether files of that ending, such as ".fbx", are of a known format, read or not.
bool is_known_ending(std::string_view ending);

/// Returns whether a file of that name may be a picture of a mesh, whatever else it may be: a TIFF
/// may be a raster of heights, too.
bool may_be_picture(std::string_view name);

/// Returns the endings of pictures, read or not, which may belong to a mesh.
std::vector<std::string_view> companion_picture_endings();

}  // namespace meshhier::mesh_io
