// Materials and pictures of a GLB.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/texture.h"

#include <cstddef>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

/// The attribute's name for colours of vertices that viewers are to pass over; they multiply
/// pictures by `COLOR_0`.
inline constexpr const char* kUnshownColours = "_COLOR_0";
/// Returns the attribute's name for colours of vertices.
constexpr const char* colour_attribute(const AttributeLayout& layout, bool is_textured) {
  return is_textured && !layout.tints ? kUnshownColours
                                      : row_of(AttributeKind::colours).gltf.data();
}

inline constexpr const char* kUnlitExtension = "KHR_materials_unlit";

/// Returns a material that is neither metal, which is black without surroundings to mirror, nor
/// one-sided, as scans are open.
nlohmann::ordered_json material_json();
/// Returns the same with a texture, by its number; if `unlit`, the document uses kUnlitExtension.
nlohmann::ordered_json material_json(std::size_t texture, AlphaMode alpha, bool unlit);

/// Returns a material's reference to a texture that is a normal map, by the texture's number, with
/// the coordinates of that set.
nlohmann::ordered_json normal_texture_json(std::size_t texture, unsigned texcoord_set);

/// Returns the texture of an image, by its number, with the sampler 0; the document has the
/// format's extension.
nlohmann::ordered_json texture_json(std::size_t image, ImageFormat format);
/// Returns a sampler: linear, with mipmaps, without repeats.
nlohmann::ordered_json sampler_json();
/// Returns the image in the buffer view of that number.
nlohmann::ordered_json image_json(std::size_t view, ImageFormat format);

}  // namespace meshhier::storage
