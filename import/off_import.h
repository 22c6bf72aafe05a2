// OFF files as meshes: faces have colours if vertices have none.
#pragma once

#include "hierarchy/attributes.h"
#include "import/raw_mesh.h"
#include "mesh_io/off_reader.h"

#include <cstdint>
#include <filesystem>

namespace meshhier::importing {

struct OffImport {
  mesh_io::OffCounts counts;
  AttributeLayout layout;
  std::uint64_t split_vertices = 0;  ///< vertices that a vertex of the file has beyond one
  std::uint64_t white_faces = 0;     ///< faces without a colour, beside others that have one
  /// Colours of faces that are unknown, or that vertices have already.
  std::uint64_t ignored_colours = 0;
};

/// Appends the mesh of a file to `mesh`, but for its layout. If faces have colours and vertices
/// none, vertices are ordered as in the file, then by the colour of their faces; else they are
/// those of the file. Throws as mesh_io::read_off(), and Error(input) if there are 2^32 vertices or
/// more.
OffImport import_off(mesh_io::InputStream& stream, const std::filesystem::path& path, RawMesh& mesh,
                     const ImportRoom& room);

}  // namespace meshhier::importing
