// Objects that a label of vertices says.
#pragma once

#include "import/raw_mesh.h"

#include <string>

namespace meshhier::importing {

/// Says the object of each triangle by the value `name` of its corners: the one that most of them
/// have, of three different ones the first corner's. Objects are named by the value. Triangles may
/// get another order. Throws Error(input) if vertices have no label of that name. O(n), with sorts
/// where the labels exceed room.sort_bytes.
void find_label_objects(const std::string& name, RawMesh& mesh, const ImportRoom& room);

}  // namespace meshhier::importing
