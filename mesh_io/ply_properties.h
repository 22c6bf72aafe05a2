// Properties of a PLY file's elements by the names that programs give them.
//
// A name is looked for as it is written, else without regard to the case of ASCII letters, if one
// property alone fits.
#pragma once

#include "hierarchy/attributes.h"
#include "mesh_io/ply_header.h"

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// Returns the index of the scalar property `name`, or -1. Throws Error(input) if there are two.
int find_scalar(const PlyElement& element, std::string_view name,
                const std::filesystem::path& path);

/// Returns whether all `names` are there, and fills `found` with their indices.
bool find_all(const PlyElement& element, std::span<const std::string_view> names,
              std::span<int> found, const std::filesystem::path& path);

/// Returns the first list property that has one of `names`; none if there is none.
std::optional<std::size_t> find_list(const PlyElement& element,
                                     std::span<const std::string_view> names);

inline constexpr std::array<std::string_view, 9> kPlyNormals{
    "nx", "ny", "nz", "normalx", "normaly", "normalz", "normal_x", "normal_y", "normal_z"};
inline constexpr std::array<std::string_view, 10> kPlyTexcoords{
    "s", "t", "u", "v", "texture_u", "texture_v", "texture_s", "texture_t", "tu", "tv"};
inline constexpr std::array<std::string_view, 1> kPlyMaterial{"material"};

/// Attributes of vertices that are floats: what they are called. Colours and values say more.
struct PlyAttribute {
  AttributeKind kind;
  std::span<const std::string_view> names;  ///< spelling after spelling; the first is written
  bool is_of_faces = false;                 ///< what faces have of it is known from their vertices
  bool is_of_import = false;                ///< only files that the import writes have it

  std::span<const std::string_view> spelling(std::size_t number) const {
    const auto size = static_cast<std::size_t>(row_of(kind).size);
    return names.subspan(number * size, size);
  }
  std::size_t spellings() const { return names.size() / spelling(0).size(); }
};
inline constexpr std::array kPlyAttributes{
    PlyAttribute{AttributeKind::normals, kPlyNormals, true},
    PlyAttribute{AttributeKind::texcoords, kPlyTexcoords},
    PlyAttribute{AttributeKind::material, kPlyMaterial, false, true}};

/// The properties of the first spelling that is there; empty if none is.
std::vector<int> find_attribute(const PlyElement& element, const PlyAttribute& attribute,
                                const std::filesystem::path& path);

/// Names of the number of the texture that a face shows.
inline constexpr std::array<std::string_view, 4> kPlyTextureNumbers{"texnumber", "texture_number",
                                                                    "texture_index", "texid"};

/// Red, green, blue, and two names that alpha has.
using PlyColourNames = std::array<std::string_view, 5>;
inline constexpr std::array<PlyColourNames, 3> kPlyColours{
    {{"red", "green", "blue", "alpha", "a"},
     {"r", "g", "b", "a", "alpha"},
     {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha", "alpha"}}};

struct PlyColour {
  std::vector<int> properties;  ///< three, or four with alpha
  ColourType kind = ColourType::none;
  bool is_checked = false;  ///< the type holds values that `kind` does not
};

/// Returns the colour of these names; none unless the three are there and of one type.
std::optional<PlyColour> find_colour(const PlyElement& element, const PlyColourNames& names,
                                     const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
