// The mesh files of a build: their formats and companions, and whether they can be read where they
// lie.
#pragma once

#include "base/bounds.h"
#include "execution/cancel.h"
#include "hierarchy/published.h"
#include "import/input_record.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_paths.h"
#include "mesh_io/mesh_source.h"
#include "mesh_io/mosaic.h"
#include "mesh_io/object_choice.h"
#include "mesh_io/ply_plan.h"
#include "mesh_io/tileset.h"
#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace meshhier::importing {

/// Textures that a mesh names are used, or passed over as if there were none.
enum class Textures : std::uint8_t { use, ignore };

/// The user's choices for making a mesh of the files.
struct InputUse {
  bool weld = false;  ///< vertices of equal position and attributes become one
  Textures textures = Textures::use;
  std::optional<BoundsD> crop{};  ///< only triangles that touch it; in the input's coordinates
  mesh_io::AttributeChoice attributes{};
  std::filesystem::path drape{};  ///< an orthophoto on rasters of heights; empty: none
  mesh_io::ObjectChoice objects{};
  std::filesystem::path object_table{};  ///< rows of properties of objects; empty: none
  /// The CRS that the mesh stands in. Rasters in degrees are brought there, others lie there,
  /// whatever they say; empty: as they say.
  std::string crs{};
  mesh_io::TilesetRoom tileset{};
};

/// Returns a file's name unpacked: "a.ply" for "a.ply.gz".
std::filesystem::path without_gz(std::filesystem::path path);

/// Returns whether a PLY's faces give their corners something of their own, so that it is imported.
bool has_corner_attributes(const mesh_io::PlyPlan& plan, Textures textures);

struct InputFileFacts {
  std::filesystem::path path;
  mesh_io::MeshFormat format;
  storage::FileIdentity identity;
  bool has_corner_attributes = false;          ///< as importing::has_corner_attributes()
  std::optional<mesh_io::TilesetMesh> tile{};  ///< place in `path`, of a tileset's tile
  std::size_t part = 0;  ///< number among the meshes of a file that is shown several times; or 0
  std::size_t face_values = 0;  ///< values that faces have; a colour counts as one
  bool names_ktx2 = false;      ///< it uses pictures in KTX2

  bool is_plain_ply() const { return format.kind == mesh_io::MeshKind::ply && !format.is_gzip; }
  /// Opens the file, or the data that stand for it.
  std::unique_ptr<storage::File> content(storage::FileSystem& files) const;
  /// Returns the content's name in messages when it is no longer packed.
  std::string unpacked_name() const { return path.string() + " (unpacked)"; }
};

/// The most names of SourceSummary::unused that are kept.
inline constexpr std::size_t kMostUnused = 100;

/// The files of a build and their companions.
class InputFiles {
 public:
  /// Recognises each file, and all files of a tileset. All is read by files.input(). Throws as
  /// mesh_io::detect_format and mesh_io::read_tileset.
  InputFiles(storage::FileSystem& files, const mesh_io::InputPaths& paths, const InputUse& use);

  /// Returns the file system in which all of them lie.
  storage::FileSystem& system() const { return files_; }
  /// The meshes.
  const std::vector<InputFileFacts>& all() const { return all_; }
  /// Returns the files that belong to the meshes: buffers of glTF files that are there; libraries
  /// and pictures as well, once an import or an earlier build has told them.
  const CompanionFiles& companions() const { return companions_; }
  void set_companions(CompanionFiles companions) { companions_ = std::move(companions); }
  /// Takes the companions of an earlier build, as they are now. Returns false, and changes nothing,
  /// if one is not there any more, or if one that was missing is there.
  bool recall(const InputRecord& earlier);
  /// Returns SourceSummary's units: metres if those of all meshes are.
  std::optional<Unit> units() const;
  /// Returns SourceSummary's unused attributes, each once: the first kMostUnused and how many more.
  std::vector<std::string> unused() const;
  /// Returns the rasters among them, as one; null if there are none.
  const std::shared_ptr<const mesh_io::Mosaic>& mosaic() const { return mosaic_; }
  /// Returns whether the input is rasters and nothing else, as they are: nothing is written then.
  bool is_terrain() const;
  /// Returns counts of the parts of tilesets that are not read.
  const std::vector<SourceCount>& tileset_counts() const { return tileset_counts_; }
  /// Returns warnings about pictures and tiles that are not used, a line each.
  const std::vector<std::string>& warnings() const { return warnings_; }
  bool weld() const { return use_.weld; }
  /// Returns the orthophoto that rasters show; empty: none.
  std::filesystem::path drape() const {
    return use_.textures == Textures::use ? use_.drape : std::filesystem::path();
  }
  /// Returns InputUse::crs.
  const std::string& crs() const { return use_.crs; }
  const std::optional<BoundsD>& crop() const { return use_.crop; }
  const mesh_io::AttributeChoice& attributes() const { return use_.attributes; }
  /// Says that there are vertices with coordinates that are not finite: an import leaves them out.
  void note_unplaced() { has_unplaced_ = true; }
  bool has_unplaced() const { return has_unplaced_; }
  Textures textures() const { return use_.textures; }
  const mesh_io::ObjectChoice& objects() const { return use_.objects; }
  const std::filesystem::path& object_table() const { return use_.object_table; }
  /// Returns whether there shall be objects, evident or not.
  bool asks_for_objects() const;
  /// Returns the name of a mesh file among them as an object: its path from the folder that all are
  /// in.
  std::string object_name(const std::filesystem::path& mesh) const;
  /// Returns false if the input is one PLY that is read in place as it is.
  bool needs_import() const {
    return is_changed() || asks_for_objects() || all_.size() != 1 || !all_[0].is_plain_ply() ||
           all_[0].has_corner_attributes;
  }

  /// Returns the formats of the meshes for people, equal ones together: "b3dm x 120".
  std::string formats() const;
  /// Returns true if the input is one packed PLY, to be unpacked and nothing else.
  bool is_unpacked_only() const {
    return !is_changed() && !asks_for_objects() && all_.size() == 1 &&
           all_[0].format.kind == mesh_io::MeshKind::ply && !all_[0].has_corner_attributes;
  }

  /// Returns file names, with ", " between them.
  std::string name() const;
  /// Returns the name in messages of the mesh that they are imported to.
  std::string imported_name() const;
  /// Returns the bytes of all files, companions among them.
  std::uint64_t bytes() const;
  /// Returns the bytes of meshes and buffers.
  std::uint64_t geometry_bytes() const;
  /// Returns one number for the times of all files: as long as it stays, so does their content.
  std::int64_t times() const;
  /// Returns the memory that the lists of files take; 0 if they are few.
  std::uint64_t held_bytes() const;
  /// Throws Error(input) if a file is not what it was any more.
  void check_unchanged() const;
  /// Returns SourceSummary's checksum. Reads all files.
  std::uint64_t checksum(const execution::CancelToken& cancel) const;
  /// Returns the record of all files, each with its checksum; `meshes`: those of the meshes. Reads
  /// the companions, and calls `visit` for each.
  InputRecord record(const std::vector<std::uint64_t>& meshes, const execution::CancelToken& cancel,
                     const std::function<void(const CompanionFile&)>& visit) const;
  /// Returns SourceSummary's files: one entry a mesh, and one for the files of each other part.
  std::vector<SourceFile> describe(const InputRecord& record) const;

 private:
  /// Returns whether the mesh is another one than that of the files.
  bool is_changed() const { return use_.weld || use_.crop || has_unplaced_; }
  void add_mesh(const std::filesystem::path& path);
  void add_osgb(const std::filesystem::path& path, const mesh_io::MeshFormat& format);
  void add_tileset(const std::filesystem::path& path);
  void join_rasters();
  void add_object_table();
  void find_common_folder();
  void number_parts();
  void warn_of_heights();
  void add_file(InputFileFacts facts, const storage::File& file);
  void add_outlined(InputFileFacts facts, const mesh_io::MeshOutline& outline);
  void look_into_ply(const storage::File& file, InputFileFacts& facts);
  void look_for_picture(const InputFileFacts& facts);
  std::uint64_t checksum_of(const std::filesystem::path& path,
                            const execution::CancelToken& cancel) const;
  /// Calls `visit(path, part, identity)` for each file, companions behind the meshes.
  template <class Visit>
  void for_each_file(const Visit& visit) const {
    for (const InputFileFacts& file : all_)
      visit(file.path, InputPart::mesh, file.identity);
    for (const CompanionFile& companion : companions_.files())
      visit(companion.path, companion.part, companion.identity);
  }

  storage::FileSystem& files_;  ///< may refuse to open a file
  mesh_io::InputPaths named_;   ///< meshes and tilesets
  std::vector<InputFileFacts> all_;
  /// The frame of the first tileset, if there is one; all tilesets stand in it.
  std::optional<std::optional<mesh_io::GlobeFrame>> frame_;
  std::shared_ptr<const mesh_io::Mosaic> mosaic_;
  std::vector<SourceCount> tileset_counts_;
  CompanionFiles companions_;
  std::vector<std::string> unused_, warnings_;
  std::set<std::string> known_unused_;
  InputUse use_;
  bool has_unplaced_ = false;
  std::filesystem::path common_folder_;  ///< that all meshes are in
};

}  // namespace meshhier::importing
