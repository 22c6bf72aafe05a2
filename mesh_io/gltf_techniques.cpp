#include "mesh_io/gltf_techniques.h"

#include "base/srgb.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

namespace meshhier::mesh_io {
namespace {

constexpr const char* kTechniques = "KHR_techniques_webgl";

bool has_word(const std::string& name, std::initializer_list<std::string_view> words) {
  std::string small = name;
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::any_of(
      words, [&](std::string_view word) { return small.find(word) != std::string::npos; });
}

bool is_base(const std::string& name) {
  return has_word(name, {"diffuse", "albedo", "basecolor", "base_color"});
}

bool is_other(const std::string& name) {
  return has_word(name, {"normal", "bump", "emissi", "specular", "gloss", "shin", "ambient",
                         "occlusion", "light", "reflect", "rough", "metal", "height"});
}

/// A value with the name of its uniform.
struct Uniform {
  std::string name;
  GltfObject holder;
  std::string key;  ///< key of the value in `holder`
};

/// Returns the uniforms of the material before those of its technique. Many materials may share a
/// technique, so no more are looked at than a shader has.
std::vector<Uniform> uniforms_of(const std::vector<GltfObject>& values) {
  constexpr std::size_t kMostUniforms = 1024;
  std::vector<Uniform> uniforms;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (const std::string& name : values[i].keys(kMostUniforms)) {
      if (i == 0)
        uniforms.push_back({name, values[i], name});
      else if (values[i].has_object(name.c_str()))
        uniforms.push_back({name, values[i].require_object(name.c_str()), "value"});
    }
  }
  return uniforms;
}

}  // namespace

std::vector<GltfObject> technique_values(const GltfObject& root, const GltfObject& material) {
  std::vector<GltfObject> values;
  values.push_back(material.object("values").value_or(material));
  const auto all = root.extension(kTechniques);
  const auto number = material.count("technique", std::numeric_limits<std::uint32_t>::max());
  if (!all || !number)
    return values;
  const auto technique = all->item("techniques", *number);
  if (technique && technique->has_object("uniforms"))
    values.push_back(technique->require_object("uniforms"));
  return values;
}

TechniqueTexture technique_texture(const std::vector<GltfObject>& values) {
  std::vector<Uniform> textures;
  for (Uniform& uniform : uniforms_of(values)) {
    const char* key = uniform.key.c_str();
    if (!uniform.holder.has_object(key) || !uniform.holder.require_object(key).has("index"))
      continue;
    if (is_base(uniform.name))
      return {uniform.holder.require_object(key)};
    if (!is_other(uniform.name))
      textures.push_back(std::move(uniform));
  }
  if (textures.empty())
    return {};
  const bool is_one = std::ranges::all_of(
      textures, [&](const Uniform& uniform) { return uniform.name == textures[0].name; });
  if (!is_one)
    return {std::nullopt, true};
  return {textures[0].holder.require_object(textures[0].key.c_str())};
}

std::optional<std::array<double, 4>> technique_colour(const std::vector<GltfObject>& values) {
  for (const Uniform& uniform : uniforms_of(values)) {
    for (const std::size_t size : {std::size_t{4}, std::size_t{3}}) {
      if (!is_base(uniform.name) || !uniform.holder.has_numbers(uniform.key.c_str(), size))
        continue;
      const std::vector<double> given = *uniform.holder.numbers(uniform.key.c_str(), size);
      std::array<double, 4> colour{1, 1, 1, 1};
      std::ranges::copy(given, colour.begin());
      for (std::size_t c = 0; c < 3; ++c)
        colour[c] = light_of(colour[c]);
      return colour;
    }
  }
  return std::nullopt;
}

}  // namespace meshhier::mesh_io
