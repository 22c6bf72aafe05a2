// Files of glTF as meshes, several at once within one memory.
#pragma once

#include "execution/memory_gate.h"
#include "import/content_reader.h"
#include "import/gltf_import.h"
#include "import/input_files.h"
#include "import/raw_mesh.h"
#include "mesh_io/feature_table.h"
#include "mesh_io/gltf_file.h"

#include <cstdint>
#include <memory>

namespace meshhier::importing {

/// Thread-safe for different meshes.
class GltfReader {
 public:
  /// All must outlive this.
  GltfReader(InputFiles& input, const ImportRoom& room);

  /// Returns a file's content, read at once if there is room: for import().
  ReadContent read(const InputFileFacts& facts) { return contents_.read(facts); }
  /// Appends the mesh of a glTF, GLB or tile to `mesh`. `content`: the file's, unpacked. Throws as
  /// import_gltf().
  AddedFile import(const InputFileFacts& facts, std::shared_ptr<const storage::File> content,
                   RawMesh& mesh);
  /// Looks for the pictures of a file, and for what decodes them. Throws as best_picture().
  void look_for_pictures(const InputFileFacts& facts);

  /// Returns the memory for all that is decoded at once: while a reader decodes, no sort runs.
  std::uint64_t decoding_bytes() const;
  /// The gate of that memory.
  execution::MemoryGate& decoding() { return decoding_; }

 private:
  /// The table of the b3dm that a glTF is in; null if it has none, or if that is damaged and nobody
  /// asked for it.
  std::unique_ptr<mesh_io::FeatureTable> batch_table(
      const std::shared_ptr<const storage::File>& content, const mesh_io::TilesetMesh& tile,
      const RawMesh& mesh, GltfPlace& place) const;
  mesh_io::GltfFile open(const InputFileFacts& facts, std::shared_ptr<const storage::File> content);

  InputFiles& input_;
  const ImportRoom& room_;
  execution::MemoryGate decoding_;
  ContentReader contents_;
};

}  // namespace meshhier::importing
