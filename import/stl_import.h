// STL files as meshes: corners at one place become one vertex, unless colours of facets meet there.
#pragma once

#include "import/raw_mesh.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/stl_reader.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::importing {

enum class StlForm : std::uint8_t { binary, text };

struct StlImport {
  mesh_io::StlCounts counts;
  AttributeLayout layout;
  std::uint64_t welded_corners = 0;
  std::uint64_t degenerate_triangles = 0;
  std::uint64_t ignored_attributes = 0;  ///< facets with numbers that are no colours
  std::uint64_t white_facets = 0;        ///< facets without a colour, where others have one
};

/// Appends the mesh of a file to `mesh`, but for its layout: vertices by first appearance, with the
/// colours of their facets if there are any (mesh_io::StlColours). Throws as
/// mesh_io::read_binary_stl, and Error(input) if most facets have coordinates that are not finite.
StlImport import_stl(StlForm form, mesh_io::InputStream& stream, const std::filesystem::path& path,
                     RawMesh& mesh, const ImportRoom& room);

}  // namespace meshhier::importing
