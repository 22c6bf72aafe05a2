// The mesh that a build reads: its input where it lies, or the PLY that it was imported to, or
// nothing any more, if an earlier build that was stopped has read it all.
#pragma once

#include "import/copy_list.h"
#include "import/import_input.h"
#include "import/input_files.h"
#include "mesh_io/mesh_source.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace meshhier::importing {

/// The input of a build. One call at a time; sources that open() returns have their own rules.
class MeshInput {
 public:
  /// The means that an import works with.
  struct Place {
    std::filesystem::path ply;      ///< becomes the imported mesh
    std::filesystem::path scratch;  ///< a temporary file
    storage::MemoryPool& pool;
    std::uint64_t sort_bytes = 0;  ///< memory of each of two sorts
    execution::Progress& progress;
    const execution::CancelToken& cancel;
    std::filesystem::path copies{};  ///< a temporary file
    /// Becomes the table of objects, which stays; empty: it goes with the PLY.
    std::filesystem::path objects{};
  };

  /// Opens the files and finds out what they are; reads the header if they are read in place.
  /// Throws as mesh_io::open_mesh and mesh_io::detect_format.
  MeshInput(const mesh_io::InputPaths& paths, storage::FileSystem& files, const InputUse& use = {});

  const InputFiles& files() const { return input_; }
  bool needs_import() const { return input_.needs_import(); }
  /// Does as InputFiles::note_unplaced().
  void note_unplaced();

  /// Imports; the PLY stays until drop() or the end of this object. Throws as import_input().
  void import(const Place& place);
  /// Finds the vertices that lie where others do: copies() and the description's place_count are
  /// known then. The list stays until drop() or the end of this object. Imports a PLY that has
  /// vertices without a place, if there is one.
  void find_copies(const Place& place);
  /// Returns the copies; none unless find_copies() has found any.
  const CopyList& copies() const { return copies_; }
  /// Returns how many copies lie where a vertex of another tile of a tileset does; 0 if that is not
  /// known.
  std::uint64_t copies_between_tiles() const { return copies_between_tiles_; }
  /// Returns whether find_copies() was called.
  bool was_looked_at() const { return copy_scratch_.has_value(); }

  /// Takes the companions of an earlier build, as InputFiles::recall.
  bool recall_files(const InputRecord& earlier) { return input_.recall(earlier); }
  /// Takes what import() and find_copies() would find out from an earlier build of the same files.
  void recall(const mesh_io::MeshDescription& found);

  /// Requires that nothing need be imported, or that import() or recall() has been called.
  const mesh_io::MeshDescription& description() const { return description_; }
  std::uint64_t imported_bytes() const { return ply_ ? ply_->bytes() : 0; }

  /// Returns whether there is something to read: not if it was recalled.
  bool can_be_read() const { return !needs_import() || ply_; }
  std::unique_ptr<mesh_io::MeshSource> open();
  /// Returns the materials that AttributeLayout::material of the description numbers; none if it
  /// was recalled.
  const images::MaterialList& materials() const { return facts_.materials; }
  /// Returns the table of objects; none if there are none, or if it was recalled.
  const std::optional<ImportedObjects>& objects() const { return facts_.objects; }
  /// Returns whether an attribute is a label whatever its values are: the input has names for
  /// these, or says that they are features of a glTF.
  bool is_sure_label(const std::string& name) const;
  /// Adds the facts that are not in the PLY.
  void complete(SourceSummary& summary) const { facts_.complete(summary); }
  /// Returns the record of the files; `checksum`: that of a mesh that is read in place.
  InputRecord record(std::uint64_t checksum) const;
  void drop();

  /// Returns SourceSummary's checksum of the files. Reads the bytes that were not read so far.
  std::uint64_t checksum(const execution::CancelToken& cancel);

 private:
  void look_for_copies(const Place& place);
  std::unique_ptr<mesh_io::MeshSource> open_imported();

  storage::FileSystem& system_;
  InputFiles input_;
  std::unique_ptr<mesh_io::MeshSource> in_place_;
  std::optional<TemporaryFile> ply_, objects_;
  ImportFacts facts_;
  mesh_io::MeshDescription description_;
  std::optional<storage::ScratchFile> copy_scratch_;
  CopyList copies_;
  std::uint64_t copies_between_tiles_ = 0;
};

}  // namespace meshhier::importing
