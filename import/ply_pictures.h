// The pictures that the faces of a PLY file show.
#pragma once

#include "import/raw_mesh.h"
#include "mesh_io/named_files.h"
#include "mesh_io/ply_source.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace meshhier::importing {

/// Finds the pictures that the header names; where faces number pictures that it does not name, as
/// Artec Studio writes them, model_0.jpg beside model.ply, or .jpeg, .png, .webp.
class PlyPictures {
 public:
  /// Finds the pictures of `textures`, where -1 is none, and notes those that are not there in
  /// `materials`.
  PlyPictures(const mesh_io::PlyPlan& plan, const std::filesystem::path& ply,
              const std::set<std::int32_t>& textures, mesh_io::NamedFiles& files,
              MaterialTable& materials);

  bool is_there(std::int32_t texture) const { return pictures_.contains(texture); }
  bool any_is_there() const { return !pictures_.empty(); }
  /// Returns the number of a texture's material in the table, to which it is added when it is asked
  /// for first.
  std::uint32_t material_of(std::int32_t texture, MaterialTable& materials);

 private:
  struct Picture {
    std::string name;
    std::filesystem::path path;
  };

  std::map<std::int32_t, Picture> pictures_;  ///< pictures that are there
  std::map<std::int32_t, std::string> missing_;
  std::map<std::int32_t, std::uint32_t> numbers_;
};

}  // namespace meshhier::importing
