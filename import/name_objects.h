// Objects of triangles, once all files are read: they get their numbers and their table.
#pragma once

#include "hierarchy/published.h"
#include "import/raw_mesh.h"
#include "storage/format/object_table.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::importing {

/// The table of a mesh's objects, as an import has written it.
struct ImportedObjects {
  std::filesystem::path file;  ///< boxes, triangles and areas are not in it
  storage::ObjectTableFacts facts;
};

/// The means to name objects.
struct ObjectNaming {
  storage::FileSystem& files;
  std::string input;            ///< name of the input, for messages
  std::filesystem::path table;  ///< beside the mesh; empty: there is none
  std::filesystem::path to;     ///< becomes the table of objects
  const ImportRoom& room;
};

struct NamedObjects {
  ImportedObjects imported;
  std::vector<SourceCount> counts;
  std::vector<std::string> warnings;
};

/// Fills `whole` with `mesh`, whose spools are cleared: its vertices have the value of objects (as
/// put_objects() says, `ends` too). Returns nothing, and changes nothing, if none are evident.
/// Throws Error(input) if objects are asked for and there are none, as list_objects(), and as
/// PropertyTable::read(). Requires mesh.objects.
std::optional<NamedObjects> name_objects(RawMesh& mesh, RawMesh& whole,
                                         std::span<std::uint64_t> ends, const ObjectNaming& naming);

}  // namespace meshhier::importing
