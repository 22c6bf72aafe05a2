// The materials of a mesh while files add theirs.
#pragma once

#include "images/material_list.h"
#include "import/input_record.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace meshhier::importing {

/// Collects materials and pictures. For one thread.
class MaterialTable {
 public:
  /// The most materials: vertices hold the numbers as floats, which are exact below.
  static constexpr std::size_t kMost = std::size_t{1} << 24;

  /// Returns the picture's number for Material::image. Pictures in the same bytes of a file are
  /// one; pictures that are held in memory are not compared.
  std::uint32_t add_picture(images::ImageSource picture);
  /// Returns the material's number. Throws Error(input) beyond kMost.
  std::uint32_t add(images::Material material);
  /// Adds all that another table has, and returns the number of its first material here.
  std::uint32_t append(MaterialTable&& other);
  /// Makes masks of materials that blend if there are others: a tile has one material, and a viewer
  /// that blends all of it draws it in the wrong order. Texels with at least half of their
  /// material's alpha are visible then. Returns how many became masks. Called once, when all
  /// materials are there.
  std::uint64_t mask_mixed();
  /// Notes that triangles should show a picture that is not there. A picture of the same name and
  /// place counts once. `name`: as `place`, a file, names it; `sought`: where it would have been
  /// found.
  void miss(const std::string& name, const std::string& place,
            const std::vector<std::filesystem::path>& sought);

  /// Notes that a library is not there which defines materials that triangles have. `obj` names it.
  void miss_library(const std::string& name, const std::filesystem::path& obj);

  /// Notes that no library defines a material that triangles have, or that libraries define some
  /// and no triangle has any.
  void miss_material(const std::string& name, const std::filesystem::path& obj);
  void leave_materials(const std::filesystem::path& obj) { left_.push_back(obj.string()); }

  /// Files that the materials come from, but for the pictures, and where missing ones would be.
  CompanionFiles& companions() { return companions_; }

  const images::MaterialList& list() const { return list_; }
  std::uint64_t missing() const { return missing_.size(); }
  /// Returns a warning about missing pictures, in one line; empty if there are none. `is_textured`:
  /// others are there.
  std::string warning(bool is_textured) const;
  /// Does the same for missing libraries.
  std::string warning_of_libraries() const;
  /// Do the same for materials.
  std::string warning_of_materials() const;
  std::string warning_of_left_materials() const;

 private:
  using Place = std::tuple<std::string, std::uint64_t, std::uint64_t>;

  images::MaterialList list_;
  std::map<Place, std::uint32_t> known_;
  std::set<std::pair<std::string, std::string>> missing_;
  CompanionFiles companions_;
  std::string first_missing_;
  std::uint64_t missing_libraries_ = 0;
  std::string first_missing_library_;
  std::uint64_t missing_materials_ = 0;
  std::string first_missing_material_;
  std::vector<std::string> left_;  ///< files with materials that no triangle has
};

}  // namespace meshhier::importing
