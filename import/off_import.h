// OFF files as meshes: faces have colours if vertices have none.
#pragma once

#include "import/added_file.h"
#include "import/raw_mesh.h"
#include "mesh_io/input_stream.h"

#include <filesystem>

namespace meshhier::importing {

/// Appends the mesh of a file to `mesh`, but for its layout. If faces have colours and vertices
/// none, vertices are ordered as in the file, then by the colour of their faces; else they are
/// those of the file. Throws as mesh_io::read_off(), and Error(input) if there are 2^32 vertices or
/// more.
AddedFile import_off(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     const ImportRoom& room);

}  // namespace meshhier::importing
