// What the name of a file says of it.
#pragma once

#include <string>
#include <string_view>

namespace meshhier {

/// Whether a file of that name is taken for a mesh: ".ply", ".obj", ".stl", ".off", ".gltf",
/// ".glb", perhaps with ".gz" behind it, upper or lower case; not if it begins with a dot.
bool is_mesh_name(std::string_view name);

/// The name without these endings: "david" of "david.ply.gz"; "" if it has none of them.
std::string mesh_stem(std::string_view name);

}  // namespace meshhier
