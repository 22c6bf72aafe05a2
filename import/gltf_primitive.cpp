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

template <class Corner>
void PrimitiveSources::assemble(const GltfElementSource& corners, mesh_io::TriangleBlocks& blocks,
                                const Corner& corner) const {
  const std::uint64_t count = corners.count;
  if (mode() == GltfPrimitive::Mode::triangles) {
    if (count % 3 != 0) {
      file_.fail(fmt::format("{} has {} elements for a list of triangles, expected three each",
                             corners.name, count));
    }
    for (std::uint64_t i = 0; i < count; i += 3) {
      const std::uint32_t a = corner(i), b = corner(i + 1);
      blocks.add_triangle_face(a, b, corner(i + 2));
    }
  } else if (mode() == GltfPrimitive::Mode::strip) {
    blocks.begin_strip();
    for (std::uint64_t i = 0; i < count; ++i)
      blocks.add_strip_corner(corner(i));
  } else {
    blocks.begin_polygon();
    for (std::uint64_t i = 0; i < count; ++i)
      blocks.add_polygon_corner(corner(i));
  }
}

mesh_io::FaceCounts PrimitiveSources::read_triangles(const GltfElementSource& position,
                                                     const mesh_io::TriangleVisitor& take) const {
  mesh_io::TriangleBlocks blocks(take);
  if (const auto source = indices()) {
    mesh_io::GltfElements all(file_, *source);
    assemble(*source, blocks, [&](std::uint64_t i) {
      const double index = all.at(i)[0];
      if (!(index < static_cast<double>(position.count))) {
        file_.fail(fmt::format("{}: element {} is {}, but there are {} vertices", source->name, i,
                               index, position.count));
      }
      return static_cast<std::uint32_t>(index);
    });
  } else {
    assemble(position, blocks, [](std::uint64_t i) { return static_cast<std::uint32_t>(i); });
  }
  return blocks.finish();
}

}  // namespace meshhier::importing
