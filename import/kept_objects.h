// Objects of a piece of a hierarchy, whose table has them already: beside the mesh lies
// objects.bin, and names in the mesh, or values of a label, are numbers of its rows.
//
//     table      0 "barn"   1 "house"   2 "mill"   3 "tower"
//     in the mesh              "1"                    "3"
//     the list   0 "house" (1)   1 "tower" (3)
//
// Rows keep their names, values and types, and their order: nothing is sorted.
#pragma once

#include "import/object_list.h"
#include "import/object_names.h"
#include "import/raw_mesh.h"
#include "storage/format/object_table.h"
#include "storage/io/file.h"

#include <cstddef>
#include <filesystem>

namespace meshhier::importing {

/// Whether a file is a table of a hierarchy's objects.
bool is_object_table(const storage::File& file);

/// Fills the list, and `file` with it. Throws Error(input) if a name is no number of a row,
/// Error(io | corrupt | interrupted). O(rows), a bit each.
void keep_objects(const MeshObjects& objects, const storage::ObjectTable& table,
                  const std::filesystem::path& path, storage::File& file, ObjectList& list,
                  const execution::CancelToken& cancel);

/// Takes a value, by its place in layout.values, from all vertices.
void drop_value(RawMesh& mesh, std::size_t value, const ImportRoom& room);

}  // namespace meshhier::importing
