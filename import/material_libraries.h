// The materials that the triangles of an OBJ file use, from the MTL files that it names.
#pragma once

#include "execution/cancel.h"
#include "images/material_list.h"
#include "import/input_record.h"
#include "mesh_io/mtl_reader.h"
#include "mesh_io/named_files.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::importing {

/// The names of materials, as the triangles of a file use them.
class MaterialNames {
 public:
  /// The most different names of one file, and the most bytes of all names and statements.
  static constexpr std::size_t kMost = std::size_t{1} << 16;
  static constexpr std::size_t kMostBytes = std::size_t{1} << 24;

  /// `obj`: for messages.
  explicit MaterialNames(std::filesystem::path obj) : obj_(std::move(obj)) {}

  /// Takes the words behind an mtllib. Throws Error(input) beyond the limits, as use().
  void add_libraries(const std::string& statement);
  /// Returns the different libraries, in their order.
  const std::vector<std::string>& libraries() const { return libraries_; }
  static constexpr std::uint32_t kNoLibrary = UINT32_MAX;

  /// Begins a material: that of the triangles from here on.
  void begin(std::string name) {
    current_ = {std::move(name), library_};
    number_.reset();
  }
  /// Counts one more triangle of the material, and returns the number of its name behind this
  /// library, by first use. A triangle before the first name has a number like any other.
  std::uint32_t use(bool has_texcoords);

  struct Use {
    std::optional<std::string> name;
    std::uint32_t last_library = kNoLibrary;  ///< the last library before the name
    bool has_texcoords = false;               ///< true if one triangle has them
  };
  const std::vector<Use>& all() const { return uses_; }
  /// Returns whether a triangle has a name, or a statement names a library.
  bool are_any() const { return !libraries_.empty() || are_used(); }
  /// Returns whether a triangle has a name.
  bool are_used() const;
  const std::filesystem::path& obj() const { return obj_; }

 private:
  void limit(std::size_t count, std::size_t more_bytes);

  std::filesystem::path obj_;
  std::size_t bytes_ = 0;
  std::vector<std::string> libraries_;
  std::map<std::string, std::uint32_t> known_libraries_;
  /// A name, and the number of the library before it.
  using Named = std::pair<std::optional<std::string>, std::uint32_t>;
  std::uint32_t library_ = kNoLibrary;
  Named current_{std::nullopt, kNoLibrary};
  std::optional<std::uint32_t> number_;  ///< the number of current_, once it was used
  std::map<Named, std::uint32_t> numbers_;
  std::vector<Use> uses_;
};

/// The material that a name stands for.
struct LibraryMaterial {
  images::Material material;           ///< the material without a picture
  std::optional<mesh_io::MtlMap> map;  ///< the map of its picture
  std::filesystem::path defined_in;    ///< its file
  bool is_defined = false;             ///< if not, it is white
  bool has_other_alpha = false;        ///< map_d names another picture

  /// Returns whether the picture's name has "<UDIM>" in it: there is a picture for each square of
  /// texture coordinates.
  bool is_tiled() const;
  /// Returns the picture's name in a tile.
  std::string file_of(std::uint32_t tile) const;
};

struct Libraries {
  std::vector<LibraryMaterial> materials;  ///< one for each name in MaterialNames::all()
  std::size_t defined = 0;                 ///< names that the libraries define
  std::uint64_t missing = 0;               ///< libraries that are not there
  std::string first_missing;               ///< as the file names it
  std::uint64_t of_bytes = 0;  ///< libraries whose colours are bytes (mesh_io::MtlColours)
};

/// Reads the libraries that an OBJ file names, and if materials are not defined then, the one
/// beside it that has its name. If several libraries define a name, the one counts that was the
/// last to be named before the name, else the one before that, else the first behind it; within one
/// statement the first. A name that nobody defines means the one that differs by the case of
/// letters alone, if there is one such. If no triangle has a name and the libraries define one
/// material alone, all have that. Throws as mesh_io::read_mtl, and Error(input) if a library is too
/// large. `companions` gets the libraries.
Libraries read_libraries(const MaterialNames& names, mesh_io::NamedFiles& files,
                         CompanionFiles& companions, const execution::CancelToken& cancel);

}  // namespace meshhier::importing
