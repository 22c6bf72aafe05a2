#include "import/gltf_materials.h"

#include "hierarchy/srgb.h"

#include <algorithm>
#include <utility>

namespace meshhier::importing {
namespace {

/// A linear value as that of a screen, as fine as pictures have it.
float srgb(double linear) {
  constexpr float kWhite = 255;
  return static_cast<float>(screen_value(linear)) / kWhite;
}

/// What it shows without a picture.
images::Material plain_material(const mesh_io::GltfMaterial& from) {
  images::Material to;
  to.name = from.name;
  to.colour = {srgb(from.factor[0]), srgb(from.factor[1]), srgb(from.factor[2]),
               static_cast<float>(std::clamp(from.factor[3], 0.0, 1.0))};
  to.alpha = from.alpha;
  to.alpha_cutoff = static_cast<float>(std::clamp(from.alpha_cutoff, 0.0, 1.0));
  return to;
}

}  // namespace

GltfMaterials::Use GltfMaterials::look_up(const mesh_io::GltfMaterial& material) {
  Use use;
  if (!material.texture)
    return use;
  const mesh_io::GltfTexture& texture = file_.document().textures[*material.texture];
  const char* unknown = texture.is_ktx2 ? "one in KTX2, which cannot be read," : "a picture";
  shows_ktx2_ = shows_ktx2_ || (texture.is_ktx2 && !texture.image);
  use.picture =
      texture.image ? file_.picture(*texture.image) : mesh_io::GltfPicture{.name = unknown};
  return use;
}

void GltfMaterials::use(std::optional<std::uint32_t> material, bool has_texcoords) {
  auto found = uses_.find(key(material));
  if (found == uses_.end()) {
    Use use = material ? look_up(file_.document().materials[*material]) : Use{};
    found = uses_.emplace(key(material), std::move(use)).first;
    colours_.add(colour(material));
  }
  is_textured_ = is_textured_ || (has_texcoords && found->second.has_picture());
}

images::Material GltfMaterials::material(std::int64_t key, Use& use, MaterialTable& table) const {
  if (key == kDefault)
    return {};
  const mesh_io::GltfDocument& document = file_.document();
  const mesh_io::GltfMaterial& from = document.materials[static_cast<std::size_t>(key)];
  images::Material to = plain_material(from);
  if (!use.has_picture())
    return to;
  for (std::size_t c = 0; c < to.factor.size(); ++c)
    to.factor[c] = static_cast<float>(std::clamp(from.factor[c], 0.0, 1.0));
  to.image =
      table.add_picture({use.picture->name, use.picture->file.value_or(""), use.picture->offset,
                         use.picture->bytes, std::move(use.picture->data)});
  const auto sampler = document.textures[*from.texture].sampler;
  if (sampler) {
    to.wrap_u = document.samplers[*sampler].wrap_u;
    to.wrap_v = document.samplers[*sampler].wrap_v;
  }
  return to;
}

PlainColour GltfMaterials::colour(std::optional<std::uint32_t> material) const {
  return material ? PlainColour::of(plain_material(file_.document().materials[*material]))
                  : PlainColour();
}

void GltfMaterials::add_to(MaterialTable& table) {
  for (auto& [key, use] : uses_)
    use.number = table.add(material(key, use, table));
}

void GltfMaterials::tell_missing(MaterialTable& table) const {
  for (const auto& [key, use] : uses_) {
    if (use.picture && !use.has_picture())
      table.miss(use.picture->name, file_.path().string(), use.picture->sought);
  }
}

std::uint32_t GltfMaterials::number(std::optional<std::uint32_t> material) const {
  return uses_.at(key(material)).number;
}

}  // namespace meshhier::importing
