#include "bench/textured_mesh.h"

#include "base/error.h"
#include "base/srgb.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "images/image_codec.h"
#include "images/material_list.h"
#include "import/mesh_input.h"
#include "mesh_io/mesh_source.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

constexpr std::uint64_t kImportBytes = std::uint64_t{256} << 20;

// ---- materials -----------------------------------------------------------------------------

std::vector<std::byte> encoded(storage::FileSystem& files, const images::ImageSource& source) {
  if (source.file.empty())
    return source.data;
  const auto file = files.open(source.file);
  const std::uint64_t size = file->size();
  const std::uint64_t begin = std::min(source.offset, size);
  std::vector<std::byte> bytes(source.bytes == 0 ? size - begin
                                                 : std::min(source.bytes, size - begin));
  file->read_exact(begin, bytes);
  return bytes;
}

class MaterialLoader {
 public:
  MaterialLoader(storage::FileSystem& files, const images::MaterialList& list)
      : files_(files), list_(list) {}

  ShownMaterial shown(const images::Material& material) {
    ShownMaterial result;
    if (material.image)
      result.texture = texture(*material.image, {material.wrap_u, material.wrap_v});
    const auto light = [&](std::size_t c) { return light_of(material.colour[c]); };
    result.colour = to_float({light(0), light(1), light(2)});
    return result;
  }

 private:
  using Texture = std::shared_ptr<const render::MipTexture>;

  Texture texture(std::uint32_t image, render::Wraps wraps) {
    Texture& known = textures_[{image, wraps.u, wraps.v}];
    if (!known) {
      const images::ImageSource& source = list_.images.at(image);
      known = std::make_shared<render::MipTexture>(
          images::decode_image(encoded(files_, source), source.name, UINT32_MAX), wraps);
    }
    return known;
  }

  storage::FileSystem& files_;
  const images::MaterialList& list_;
  std::map<std::tuple<std::uint32_t, Wrap, Wrap>, Texture> textures_;
};

// ---- the mesh ------------------------------------------------------------------------------

class MeshLoader {
 public:
  MeshLoader(const AttributeLayout& layout, Vec3d origin, TexturedMesh& mesh)
      : layout_(layout), origin_(origin), mesh_(mesh) {}

  void add(const mesh_io::VertexBlock& block) {
    for (const Vec3f p : block.positions)
      mesh_.positions.push_back(to_float(to_double(p) - origin_));
    for (const Vec3d p : block.exact)
      mesh_.positions.push_back(to_float(p - origin_));
    const auto channels = static_cast<std::size_t>(layout_.channels());
    for (std::size_t i = 0; i < block.attributes.size(); i += channels)
      add_attributes(block.attributes.subspan(i, channels));
  }

 private:
  void add_attributes(std::span<const float> channels) {
    const auto uv = layout_.part(AttributeKind::texcoords).first;
    mesh_.texcoords.push_back({channels[uv], channels[uv + 1]});
    const float material = channels[layout_.part(AttributeKind::material).first];
    if (!(material >= 0 && material < static_cast<float>(mesh_.materials.size()))) {
      throw Error(ErrorCode::input,
                  fmt::format("vertex {} has the material {}, of {}", mesh_.texcoords.size() - 1,
                              material, mesh_.materials.size()));
    }
    mesh_.material_of.push_back(static_cast<std::uint32_t>(material));
  }

  AttributeLayout layout_;
  Vec3d origin_;
  TexturedMesh& mesh_;
};

double uv_area(Vec2f a, Vec2f b, Vec2f c) {
  return std::abs((double{b.u} - a.u) * (double{c.v} - a.v) -
                  (double{b.v} - a.v) * (double{c.u} - a.u)) /
         2;
}

double space_area(Vec3f a, Vec3f b, Vec3f c) {
  return length(cross(to_double(b) - to_double(a), to_double(c) - to_double(a))) / 2;
}

}  // namespace

void TexturedMesh::draw(render::Raster& raster) const {
  for (const auto& [a, b, c] : triangles) {
    const ShownMaterial& material = materials[material_of[a]];
    const auto corner = [&](std::uint32_t v) {
      return render::FacetCorner{positions[v], {}, material.colour};
    };
    raster.draw({corner(a), corner(b), corner(c)},
                {material.texture.get(), {texcoords[a], texcoords[b], texcoords[c]}});
  }
}

double TexturedMesh::texel() const {
  double space = 0, texels = 0;
  for (const auto& [a, b, c] : triangles) {
    const render::MipTexture* texture = materials[material_of[a]].texture.get();
    if (texture == nullptr)
      continue;
    space += space_area(positions[a], positions[b], positions[c]);
    texels +=
        uv_area(texcoords[a], texcoords[b], texcoords[c]) * texture->width() * texture->height();
  }
  return texels > 0 ? std::sqrt(space / texels) : 0;
}

TexturedMesh load_textured_mesh(storage::FileSystem& files, const mesh_io::InputPaths& paths,
                                const std::filesystem::path& scratch, Vec3d origin) {
  storage::MemoryPool pool(kImportBytes);
  execution::NoProgress progress;
  const execution::CancelToken cancel;
  importing::MeshInput input(paths, files);
  if (input.needs_import()) {
    input.import({scratch / "import.ply", scratch / "import.scratch", pool, kImportBytes / 8,
                  progress, cancel});
  }
  const AttributeLayout& layout = input.description().attributes;
  if (!layout.material) {
    throw Error(ErrorCode::usage,
                paths.string() + " has no textures to compare: no picture that a triangle shows");
  }
  TexturedMesh mesh;
  MaterialLoader materials(files, input.materials());
  for (const images::Material& material : input.materials().materials)
    mesh.materials.push_back(materials.shown(material));
  MeshLoader loader(layout, origin, mesh);
  const auto source = input.open();
  source->read_vertices([&](const mesh_io::VertexBlock& block) { loader.add(block); });
  source->read_triangles([&](std::span<const Triangle<VertexId>> block) {
    for (const Triangle<VertexId>& t : block)
      mesh.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
  });
  return mesh;
}

}  // namespace meshhier::bench
