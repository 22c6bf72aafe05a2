// STL files as meshes: corners at one place become one vertex, unless colours of facets meet there.
#pragma once

#include "import/added_file.h"
#include "import/raw_mesh.h"
#include "mesh_io/input_stream.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::importing {

enum class StlForm : std::uint8_t { binary, text };

/// Appends the mesh of a file to `mesh`, but for its layout: vertices by first appearance, with the
/// colours of their facets if there are any (mesh_io::StlColours). Throws as
/// mesh_io::read_binary_stl, and Error(input) if most facets have coordinates that are not finite.
AddedFile import_stl(StlForm form, mesh_io::InputStream& stream, const std::filesystem::path& path,
                     RawMesh& mesh, const ImportRoom& room);

}  // namespace meshhier::importing
