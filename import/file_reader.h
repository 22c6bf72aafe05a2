// Mesh files of all formats, read one behind the other into one mesh.
#pragma once

#include "import/added_file.h"
#include "import/import_input.h"
#include "import/raw_mesh.h"
#include "import/terrain_source.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::importing {

/// Facts about all files that were read.
struct ReadFacts {
  std::vector<std::uint64_t> checksums;  ///< those of the files, in their order
  std::vector<SourceCount> counts;       ///< of all files together, by name
  CompanionFiles tiles;                  ///< finer tiles that were read
  std::uint64_t near_apart = 0;          ///< triangles that were passed over: not near the crop
};

/// Reads files of any format one behind the other; each comes behind the vertices of the files
/// before. For one thread; blocks of texts and files of glTF are read on all threads.
class FileReader {
 public:
  virtual ~FileReader() = default;

  /// Looks for the pictures that files show and this machine cannot decode, before anything is
  /// read. Throws Error(io) naming the first one, as best_picture(); Error(input) if its file is
  /// broken.
  virtual void look_for_decoders() = 0;
  /// Appends the mesh of a file to that of all, but for its layouts, which it returns, of all its
  /// vertices in their order: join_layouts() brings them together. `room`: a path where the file
  /// may lie unpacked meanwhile. Throws as the reader of its format; Error(input) if the mesh gets
  /// 2^32 vertices or more; Error(io), Error(interrupted). Requires that run_of() says 0.
  virtual AddedFile read(const InputFileFacts& facts, const std::filesystem::path& room) = 0;
  /// Returns how many files from the first one on are for read_run(): none, several, or a tile
  /// that names others.
  static std::size_t run_of(std::span<const InputFileFacts> files);
  /// Does what read() does for each of the files, and calls `added` for each in order, or several
  /// times. The files are read in parallel, each to a mesh of its own, which then moves behind
  /// those before. Requires as many as run_of() says.
  virtual void read_run(std::span<const InputFileFacts> files,
                        const std::function<void(const AddedFile&)>& added) = 0;
  /// Reads the rasters of an input that has nothing else, and counts their cells. Their picture, if
  /// there is one, becomes the mesh's material.
  virtual Terrain read_terrain() = 0;
  /// Writes the content of a packed file to `to`.
  virtual void unpack(const InputFileFacts& facts, TemporaryFile& to) = 0;

  const ReadFacts& facts() const { return facts_; }

 protected:
  ReadFacts facts_;
};

/// Makes a reader that appends to `mesh`. All must outlive it.
std::unique_ptr<FileReader> make_file_reader(InputFiles& input,
                                             const ImportEnvironment& environment, RawMesh& mesh);

}  // namespace meshhier::importing
