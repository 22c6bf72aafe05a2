// Mesh files of all formats, read one behind the other into one mesh.
#pragma once

#include "import/import_input.h"
#include "import/place_vertices.h"
#include "import/raw_mesh.h"
#include "import/terrain_source.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::importing {

/// Facts of a run of vertices that was added to the mesh, and of their triangles.
struct AddedFile {
  AttributeLayout layout{};
  bool fits_float = true;
  std::uint64_t faces = 0;
  std::uint64_t degenerate_triangles = 0;
  std::uint64_t material_colours = 0;  ///< materials' colours that vertices have
  bool is_painted = false;             ///< vertices have no other colours
  mesh_io::UnplacedVertices unplaced{};
  std::uint64_t vertices = 0;
};

/// Reads files of any format one behind the other; each comes behind the vertices of the files
/// before. For one thread; blocks of texts and files of glTF are read on all threads.
class FileReader {
 public:
  /// All must outlive this.
  FileReader(InputFiles& input, const ImportEnvironment& environment, RawMesh& mesh);
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;
  ~FileReader();

  /// Looks for the pictures that files show and this machine cannot decode, before anything is
  /// read. Throws Error(io) naming the first one, as best_picture(); Error(input) if its file is
  /// broken.
  void look_for_decoders();
  /// Appends the mesh of a file to that of all, but for its layouts, which it returns, of all its
  /// vertices in their order: join_layouts() brings them together. `room`: a path where the file
  /// may lie unpacked meanwhile. Throws as the reader of its format; Error(input) if the mesh gets
  /// 2^32 vertices or more; Error(io), Error(interrupted). Requires that run_of() says 0.
  AddedFile read(const InputFileFacts& facts, const std::filesystem::path& room);
  /// Returns how many files from the first one on are for read_run(): none, several, or a tile
  /// that names others.
  static std::size_t run_of(std::span<const InputFileFacts> files);
  /// Does what read() does for each of the files, and calls `added` for each in order, or several
  /// times. The files are read in parallel, each to a mesh of its own, which then moves behind
  /// those before. Requires as many as run_of() says.
  void read_run(std::span<const InputFileFacts> files,
                const std::function<void(const AddedFile&)>& added);
  /// Reads the rasters of an input that has nothing else, and counts their cells. Their picture, if
  /// there is one, becomes the mesh's material.
  Terrain read_terrain();
  /// Writes the content of a packed file to `to`.
  void unpack(const InputFileFacts& facts, TemporaryFile& to);

  /// Returns the checksums of the files that were read, in their order.
  const std::vector<std::uint64_t>& checksums() const;
  /// Returns the counts of all files together, by name.
  const std::vector<SourceCount>& counts() const;
  /// Returns the files of finer tiles that were read.
  const CompanionFiles& tiles() const;
  /// Returns how many triangles were passed over, as they are not near the crop.
  std::uint64_t near_apart() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshhier::importing
