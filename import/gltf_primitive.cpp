#include "import/gltf_primitive.h"

#include <fmt/format.h>

namespace meshhier::importing {

using mesh_io::GltfComponent;
using mesh_io::GltfElementSource;
using mesh_io::GltfPrimitive;

PrimitiveSources::PrimitiveSources(mesh_io::GltfFile& file, const GltfPrimitive& primitive)
    : file_(file), primitive_(primitive) {
  if (primitive.draco)
    draco_ = decode_draco(file, primitive);
}

std::optional<GltfElementSource> PrimitiveSources::attribute(const std::string& name,
                                                             std::uint32_t least,
                                                             std::uint32_t most) const {
  const auto accessor = primitive_.attribute(name);
  if (!accessor)
    return std::nullopt;
  const auto decoded = draco_.attributes.find(name);
  GltfElementSource source =
      decoded != draco_.attributes.end() ? decoded->second : gltf_elements_of(file_, *accessor);
  if (source.components < least || source.components > most ||
      (source.component == GltfComponent::u32 && !name.starts_with('_')))
    file_.fail(fmt::format("{} is of no type that {} may have", source.name, name));
  return source;
}

std::optional<GltfElementSource> PrimitiveSources::indices() const {
  if (primitive_.draco)
    return draco_.indices;
  if (!primitive_.indices)
    return std::nullopt;
  GltfElementSource source = gltf_elements_of(file_, *primitive_.indices);
  const bool is_unsigned = source.component == GltfComponent::u8 ||
                           source.component == GltfComponent::u16 ||
                           source.component == GltfComponent::u32;
  if (!is_unsigned || source.components != 1)
    file_.fail(source.name + " is of no type that indices may have");
  source.normalized = false;
  return source;
}

GltfPrimitive::Mode PrimitiveSources::mode() const {
  return primitive_.draco ? GltfPrimitive::Mode::triangles : primitive_.mode;
}

}  // namespace meshhier::importing
