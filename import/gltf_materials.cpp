#include "import/gltf_materials.h"

#include "base/srgb.h"
#include "import/gltf_picture_forms.h"

#include <algorithm>
#include <span>
#include <utility>

namespace meshhier::importing {
namespace {

/// A linear value as that of a screen, as fine as pictures have it.
float srgb(double linear) {
  constexpr float kWhite = 255;
  return static_cast<float>(screen_value(linear)) / kWhite;
}

/// Returns the material as it shows without a picture. `emits`: with the light that is its own.
images::Material plain_material(const mesh_io::GltfMaterial& from, bool emits) {
  images::Material to;
  to.name = from.name;
  const std::array<double, 3> light = emits ? plain_light(from) : std::array<double, 3>{};
  for (std::size_t c = 0; c < light.size(); ++c)
    to.colour[c] = srgb(from.factor[c] + light[c]);
  to.colour[3] = static_cast<float>(std::clamp(from.factor[3], 0.0, 1.0));
  to.alpha = from.alpha;
  to.alpha_cutoff = static_cast<float>(std::clamp(from.alpha_cutoff, 0.0, 1.0));
  return to;
}

std::vector<bool> coloured_materials(const mesh_io::GltfDocument& document) {
  std::vector<bool> are_coloured(document.materials.size());
  for (const mesh_io::GltfMesh& mesh : document.meshes) {
    for (const mesh_io::GltfPrimitive& primitive : mesh.primitives) {
      if (primitive.material && primitive.attribute("COLOR_0"))
        are_coloured[*primitive.material] = true;
    }
  }
  return are_coloured;
}

}  // namespace

std::array<double, 3> plain_light(const mesh_io::GltfMaterial& material) {
  return material.glow ? std::array<double, 3>{} : material.emission;
}

GltfLook look_of(const mesh_io::GltfMaterial& material, bool is_coloured) {
  GltfLook look{.factor = material.factor};
  if (material.base)
    look.texture = &*material.base;
  if (!material.emits())
    return look;
  const bool is_black = std::ranges::all_of(std::span(material.factor).first(3),
                                            [](double part) { return part <= 0; });
  if (!material.glow) {
    look.light = material.emission;
    look.is_untinted = is_black;
  } else if (material.base || (is_coloured && !is_black)) {
    look.drops_light = true;
  } else {
    const auto [red, green, blue] = material.emission;
    look.texture = &*material.glow;
    look.factor = {red, green, blue, material.factor[3]};
    std::copy_n(material.factor.begin(), look.light.size(), look.light.begin());
    look.is_untinted = is_black;
  }
  look.has_own_light = is_coloured && !look.is_untinted && look.light != std::array<double, 3>{};
  return look;
}

GltfMaterials::GltfMaterials(mesh_io::GltfFile& file) : file_(file) {
  const mesh_io::GltfDocument& document = file.document();
  const std::vector<bool> are_coloured = coloured_materials(document);
  for (std::size_t i = 0; i < document.materials.size(); ++i)
    looks_.push_back(look_of(document.materials[i], are_coloured[i]));
}

const GltfLook& GltfMaterials::look(std::optional<std::uint32_t> material) const {
  static const GltfLook kWhite;
  return material ? looks_[*material] : kWhite;
}

std::string GltfMaterials::texcoords(std::optional<std::uint32_t> material) const {
  const mesh_io::GltfTextureUse* shown = look(material).texture;
  return "TEXCOORD_" + std::to_string(shown != nullptr ? shown->texcoord : 0);
}

GltfMaterials::Use GltfMaterials::look_up(const GltfLook& look) {
  Use use;
  if (look.texture == nullptr)
    return use;
  const mesh_io::GltfTexture& texture = file_.document().textures[look.texture->texture];
  if (!texture.forms.empty()) {
    use.picture = best_picture(file_, texture);
    return use;
  }
  std::string unknown = "a picture";
  if (texture.unread != nullptr) {
    unread_.insert(texture.unread);
    unknown = std::string("one in ") + texture.unread->name + ", which cannot be read,";
  }
  use.picture = mesh_io::GltfPicture{.name = unknown};
  return use;
}

void GltfMaterials::use(std::optional<std::uint32_t> material, bool has_texcoords) {
  auto found = uses_.find(key(material));
  if (found == uses_.end()) {
    found = uses_.emplace(key(material), look_up(look(material))).first;
    colours_.add(colour(material));
    emit_ = emit_ || (material && file_.document().materials[*material].emits());
  }
  is_textured_ = is_textured_ || (has_texcoords && found->second.has_picture());
}

images::Material GltfMaterials::material(std::int64_t key, Use& use, MaterialTable& table) const {
  if (key == kDefault)
    return {};
  const mesh_io::GltfDocument& document = file_.document();
  const auto number = static_cast<std::size_t>(key);
  const GltfLook& look = looks_[number];
  images::Material to = plain_material(document.materials[number], !look.has_own_light);
  if (!use.has_picture())
    return to;
  const bool is_base = document.materials[number].base.has_value();
  if (!is_base && to.alpha == AlphaMode::mask)
    to.alpha = AlphaMode::opaque;  // alpha is that of the base colour
  for (std::size_t c = 0; c < to.factor.size(); ++c)
    to.factor[c] = static_cast<float>(is_base ? std::clamp(look.factor[c], 0.0, 1.0)
                                              : std::max(look.factor[c], 0.0));
  for (std::size_t c = 0; c < to.light.size() && !look.has_own_light; ++c)
    to.light[c] = static_cast<float>(std::max(look.light[c], 0.0));
  to.image = table.add_picture(source_of(*std::move(use.picture)));
  const auto sampler = document.textures[look.texture->texture].sampler;
  if (sampler) {
    to.wrap_u = document.samplers[*sampler].wrap_u;
    to.wrap_v = document.samplers[*sampler].wrap_v;
  }
  return to;
}

PlainColour GltfMaterials::colour(std::optional<std::uint32_t> material) const {
  return material ? PlainColour::of(plain_material(file_.document().materials[*material], true))
                  : PlainColour();
}

template <class Judge>
std::uint64_t GltfMaterials::count(const Judge& judge) const {
  return static_cast<std::uint64_t>(std::ranges::count_if(uses_, [&](const auto& used) {
    return used.first != kDefault && judge(static_cast<std::uint32_t>(used.first));
  }));
}

std::uint64_t GltfMaterials::dropped_lights(bool is_textured) const {
  return count([&](std::uint32_t material) {
    const GltfLook& look = looks_[material];
    return look.drops_light || (is_textured && look.has_own_light);
  });
}

std::uint64_t GltfMaterials::translucent() const {
  return count([&](std::uint32_t number) {
    const mesh_io::GltfMaterial& material = file_.document().materials[number];
    return material.alpha == AlphaMode::blend && material.factor[3] < 1;
  });
}

std::uint64_t GltfMaterials::unknown() const {
  return count([&](std::uint32_t number) { return file_.document().materials[number].is_unknown; });
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
