// The pictures that triangles of an OBJ file show, and their places on them.
#pragma once

#include "hierarchy/texture.h"
#include "import/material_libraries.h"
#include "import/material_table.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::importing {

/// A picture's part of texture coordinates: the whole, or one of several squares (UDIM).
class PictureTile {
 public:
  constexpr PictureTile() = default;
  /// Returns the square from (column, row) on; none if its number has not four digits.
  static std::optional<PictureTile> at(double column, double row);
  static constexpr PictureTile from(std::uint32_t number) { return PictureTile(number); }

  std::uint32_t number() const { return number_; }  ///< 1001 + column + 10 row; 0: the whole
  std::uint32_t column() const { return number_ == 0 ? 0 : (number_ - kFirst) % 10; }
  std::uint32_t row() const { return number_ == 0 ? 0 : (number_ - kFirst) / 10; }
  friend constexpr auto operator<=>(const PictureTile&, const PictureTile&) = default;

 private:
  static constexpr std::uint32_t kFirst = 1001;
  constexpr explicit PictureTile(std::uint32_t number) : number_(number) {}
  std::uint32_t number_ = 0;
};

/// Numbers materials and pictures in the order in which triangles ask for them.
class ObjTextures {
 public:
  using Texcoord = std::array<float, 2>;

  /// `table` gets the materials.
  ObjTextures(std::vector<LibraryMaterial> materials, mesh_io::NamedFiles& files,
              MaterialTable& table)
      : materials_(std::move(materials)),
        files_(files),
        table_(table),
        first_number_(static_cast<std::uint32_t>(table.list().materials.size())) {}

  bool is_tiled(std::uint32_t name) const { return materials_[name].is_tiled(); }
  /// Returns the square in which a triangle of these coordinates lies; none if no picture can be
  /// there.
  std::optional<PictureTile> tile_of(std::uint32_t name,
                                     const std::array<Texcoord, 3>& corners) const;

  /// Looks for a picture that a triangle shows; returns whether it is there.
  bool find_picture(std::uint32_t name, PictureTile tile);
  /// Returns whether one was found.
  bool has_pictures() const { return has_pictures_; }

  /// The material that a triangle shows.
  struct Shown {
    std::uint32_t number = 0;  ///< in the table
    bool has_picture = false;
  };
  Shown show(std::uint32_t name, std::optional<PictureTile> tile);
  /// Returns a coordinate of a corner that shows a picture, as glTF has it.
  Vec2f texcoord(std::uint32_t number, Texcoord texcoord) const;

  const std::vector<LibraryMaterial>& materials() const { return materials_; }

 private:
  /// The way from the file's coordinates to the picture's, for a material's number.
  struct Mapping {
    std::array<double, 2> scale{1, 1}, offset{};
  };
  using Key = std::pair<std::uint32_t, PictureTile>;

  Shown make(std::uint32_t name, std::optional<PictureTile> tile,
             const std::optional<std::filesystem::path>& picture);

  std::vector<LibraryMaterial> materials_;
  mesh_io::NamedFiles& files_;
  MaterialTable& table_;
  std::uint32_t first_number_;
  bool has_pictures_ = false;
  std::map<Key, std::optional<std::filesystem::path>> pictures_;
  std::map<std::pair<std::uint32_t, std::optional<PictureTile>>, Shown> shown_;
  std::vector<Mapping> mappings_;  ///< from first_number_ on
};

}  // namespace meshhier::importing
