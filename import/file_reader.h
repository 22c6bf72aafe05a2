// Mesh files of all formats, read one behind the other into one mesh.
#pragma once

#include "import/import_input.h"
#include "import/place_vertices.h"
#include "import/raw_mesh.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace meshhier::importing {

/// What a file adds to the mesh besides vertices and triangles.
struct AddedFile {
  AttributeLayout layout{};
  bool fits_float = true;
  std::uint64_t faces = 0;
  std::uint64_t degenerate_triangles = 0;
  std::uint64_t material_colours = 0;  ///< that vertices have
  bool is_painted = false;             ///< no vertex has another one
  mesh_io::UnplacedVertices unplaced{};
};

/// Of one thread.
class FileReader {
 public:
  /// All must outlive this.
  FileReader(InputFiles& input, const ImportEnvironment& environment, RawMesh& mesh);
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;
  ~FileReader();

  /// Appends the mesh of a file to that of all, but for its layout. `room`: where the file may lie
  /// unpacked meanwhile. Throws as the reader of its format; Error(input) if the mesh gets 2^32
  /// vertices or more.
  AddedFile read(const InputFileFacts& facts, const std::filesystem::path& room);
  /// Writes the content of a packed file.
  void unpack(const InputFileFacts& facts, TemporaryFile& to);

  /// The checksums of the files that were read, in their order.
  const std::vector<std::uint64_t>& checksums() const;
  /// What was counted in them.
  const std::vector<SourceCount>& counts() const;
  /// Triangles that were passed over, as they are not near the crop.
  std::uint64_t near_apart() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshhier::importing
