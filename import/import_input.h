// The stage `import`: input that cannot be read where it lies becomes one PLY that can.
//
// A PLY that is packed and nothing else is unpacked. Of rasters the cells are counted, and nothing
// is written: terrain_source.h makes the mesh of them. All other input (other formats, several
// files, vertices to be welded) is read once as a stream into spools and written from there as a
// binary little endian PLY: coordinates as float, or as double if one of them does not fit;
// attributes in the types they have inside (hierarchy/attributes.h).
//
// A mesh is textured if a triangle's material names a picture that is there. Its vertices have the
// number of their material behind the texture coordinates, which are glTF's. A mesh of which all
// pictures are missing is imported as one that names none, with a warning.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "images/material_list.h"
#include "import/input_files.h"
#include "import/label_names.h"
#include "import/name_objects.h"
#include "import/terrain_source.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_plan.h"
#include "storage/io/file.h"
#include "storage/io/spool.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::importing {

/// A file that is removed with its object.
class TemporaryFile {
 public:
  /// The file's bytes count in `use` from counted() on.
  TemporaryFile(storage::FileSystem& files, std::filesystem::path path, storage::ScratchUse& use)
      : files_(files), path_(std::move(path)), use_(use) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  const std::filesystem::path& path() const { return path_; }
  /// Says that the file is written.
  void counted();
  std::uint64_t bytes() const { return bytes_; }

 private:
  storage::FileSystem& files_;
  std::filesystem::path path_;
  storage::ScratchUse& use_;
  std::uint64_t bytes_ = 0;
};

/// Facts of the files that are not in the PLY.
struct ImportFacts {
  InputRecord record;             ///< the files that were read, and places of missing ones
  std::vector<SourceFile> files;  ///< the same files, as the hierarchy tells of them
  std::vector<SourceCount> counts;
  /// Writer of the PLY; `anyone` if it is an input unpacked.
  mesh_io::PlyWrittenBy writer = mesh_io::PlyWrittenBy::anyone;
  std::optional<std::uint64_t> faces;  ///< none: as many as the PLY has
  std::uint64_t degenerate_triangles = 0;
  /// The materials that triangles use, as AttributeLayout::material of the PLY numbers them; empty
  /// unless the mesh is textured.
  images::MaterialList materials;
  AllLabelNames label_names;
  std::optional<ImportedObjects> objects;
  /// The count of vertices up to the end of each tile, if the mesh is several tiles of tilesets as
  /// they are; else none.
  std::vector<std::uint64_t> tile_ends;
  /// The mesh, if it is one of rasters, in the place of a PLY.
  std::optional<Terrain> terrain;
  /// The textures of a textured mesh. Texels are not counted: nothing is decoded here.
  std::optional<SourceTextures> textures;

  /// Completes the summary of a mesh that was read from the PLY.
  void complete(SourceSummary& summary) const;
};

/// Returns counts for people: "12 groups, 3 split vertices".
std::string counts_text(const std::vector<SourceCount>& counts);

/// The budget's division while it runs.
struct ImportMemory {
  std::uint64_t pool_bytes = 0;
  std::uint64_t sort_bytes = 0;  ///< memory of each of two sorts, or of a table
};
/// Divides the budget, but for `held_bytes`: InputFiles::held_bytes().
ImportMemory plan_import(std::uint64_t memory_budget, std::uint64_t held_bytes = 0);

/// Returns the most bytes of temporary files, about, the PLY included, by the files' sizes alone.
std::uint64_t predict_import(const InputFiles& input, const ImportMemory& memory);

struct ImportEnvironment {
  storage::FileSystem& files;
  storage::ScratchFile& scratch;  ///< for spools and sorts; its pool is the memory they have
  std::uint64_t sort_bytes = 0;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
  std::filesystem::path objects;  ///< becomes the table of objects, if there are any
};

/// Writes the PLY, and the table of objects, or counts the cells of rasters, and tells `input`
/// which companions it has. Parallel only within sorts; the result depends on the files alone, but
/// for the order of triangles if they are welded. Throws Error(input) naming file and line or byte,
/// also if files that are joined have not the same attributes, Error(io), Error(interrupted).
ImportFacts import_input(InputFiles& input, TemporaryFile& ply,
                         const ImportEnvironment& environment);

}  // namespace meshhier::importing
