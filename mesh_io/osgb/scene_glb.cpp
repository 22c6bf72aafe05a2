#include "mesh_io/osgb/scene_glb.h"

#include "base/srgb.h"
#include "mesh_io/osgb/coded_picture.h"
#include "mesh_io/osgb/kept_scene.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>
#include <osg/Array>
#include <osg/TriangleIndexFunctor>

namespace meshhier::mesh_io::osgb {
namespace {

using Json = nlohmann::json;

// Numbers of glTF 2.0.
constexpr int kFloat = 5126, kUnsigned = 5125;
constexpr int kRepeat = 10497, kMirror = 33648, kClamp = 33071;

struct TriangleCollector {
  std::vector<std::uint32_t> corners;
  void operator()(unsigned a, unsigned b, unsigned c) { corners.insert(corners.end(), {a, b, c}); }
};

std::vector<std::uint32_t> corners_of(const osg::Geometry& geometry) {
  osg::TriangleIndexFunctor<TriangleCollector> collector;
  geometry.accept(collector);
  return std::move(collector.corners);
}

/// Calls `take` with the array as what it is. Returns false if it is none of these.
template <class... Arrays, class Take>
bool visit_array(const osg::Array* array, const Take& take) {
  const auto visit = [&]<class Array>(std::type_identity<Array>) {
    const auto* const typed = dynamic_cast<const Array*>(array);
    if (typed != nullptr)
      take(*typed);
    return typed != nullptr;
  };
  return (visit(std::type_identity<Arrays>{}) || ...);
}

/// Returns `channels` numbers a vertex; nothing if there is no such array with one for each vertex.
std::vector<float> numbers_of(const osg::Array* array, std::size_t vertices, std::size_t channels) {
  std::vector<float> numbers;
  if (array == nullptr || array->getNumElements() != vertices ||
      array->getBinding() == osg::Array::BIND_OVERALL ||
      array->getBinding() == osg::Array::BIND_OFF)
    return numbers;
  visit_array<osg::Vec2Array, osg::Vec3Array, osg::Vec4Array, osg::Vec2dArray, osg::Vec3dArray,
              osg::Vec4dArray, osg::Vec3bArray, osg::Vec3sArray, osg::Vec4ubArray>(
      array, [&](const auto& typed) {
        using Element = std::remove_cvref_t<decltype(typed[0])>;
        using Number = Element::value_type;
        const double most =
            std::is_integral_v<Number> ? double{std::numeric_limits<Number>::max()} : 1;
        if (std::size_t{Element::num_components} < channels)
          return;
        numbers.reserve(vertices * channels);
        for (const Element& element : typed) {
          for (std::size_t k = 0; k < channels; ++k) {
            const auto number = element[static_cast<unsigned>(k)];
            if constexpr (std::is_same_v<Number, float>)
              numbers.push_back(number);
            else
              numbers.push_back(static_cast<float>(static_cast<double>(number) / most));
          }
        }
      });
  return numbers;
}

/// Positions relative to an origin, which is 0 where they are floats.
struct Positions {
  std::vector<float> numbers;
  osg::Vec3d origin;
  std::size_t count() const { return numbers.size() / 3; }
};

Positions positions_of(const osg::Geometry& geometry) {
  const osg::Array* const array = geometry.getVertexArray();
  Positions positions;
  const auto* const doubles = dynamic_cast<const osg::Vec3dArray*>(array);
  if (doubles == nullptr) {
    if (array != nullptr)
      positions.numbers = numbers_of(array, array->getNumElements(), 3);
    return positions;
  }
  if (!doubles->empty())
    positions.origin = doubles->front();
  for (const osg::Vec3d& position : *doubles) {
    const osg::Vec3d near = position - positions.origin;
    for (unsigned k = 0; k < 3; ++k)
      positions.numbers.push_back(static_cast<float>(near[k]));
  }
  return positions;
}

int wrap_of(osg::Texture::WrapMode mode) {
  return mode == osg::Texture::REPEAT ? kRepeat : mode == osg::Texture::MIRROR ? kMirror : kClamp;
}

class GlbWriter {
 public:
  void add(const Part& part) {
    const std::vector<std::uint32_t> corners = corners_of(*part.geometry);
    const Positions positions = positions_of(*part.geometry);
    if (corners.empty() || positions.count() == 0) {
      ++made_.without;
      return;
    }
    made_.triangles += corners.size() / 3;
    Json attributes = attributes_of(*part.geometry, positions);
    const bool has_texcoords = attributes.contains("TEXCOORD_0");
    json_["meshes"].push_back(
        {{"primitives", Json::array({{{"attributes", std::move(attributes)},
                                      {"indices", add_numbers(corners, 1, kUnsigned)},
                                      {"material", material_of(part, has_texcoords)}}})}});
    add_node(osg::Matrixd::translate(positions.origin) * part.place);
  }

  SceneGlb finish() {
    json_["asset"] = {{"version", "2.0"}};
    json_["scenes"] = Json::array({{{"nodes", nodes_}}});
    json_["buffers"] = Json::array({{{"byteLength", bin_.size()}}});
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto chunk = [&](std::uint32_t kind, const std::string& bytes) {
      append_word(static_cast<std::uint32_t>(bytes.size()));
      append_word(kind);
      made_.bytes += bytes;
    };
    constexpr std::uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBin = 0x004E4942;
    append_word(kMagic);
    append_word(2);
    append_word(static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + bin_.size()));
    chunk(kJson, text);
    const std::size_t begin = made_.bytes.size() + 8;
    chunk(kBin, bin_);
    for (const auto& [offset, image] : pictures_)
      made_.pictures.emplace(begin + offset, image);
    return std::move(made_);
  }

 private:
  Json attributes_of(const osg::Geometry& geometry, const Positions& positions) {
    const std::size_t count = positions.count();
    Json attributes{{"POSITION", add_numbers(positions.numbers, 3, kFloat)}};
    const auto add = [&](const char* name, const std::vector<float>& numbers, std::size_t width) {
      if (!numbers.empty())
        attributes[name] = add_numbers(numbers, width, kFloat);
    };
    add("NORMAL", numbers_of(geometry.getNormalArray(), count, 3), 3);
    std::vector<float> colours = numbers_of(geometry.getColorArray(), count, 4);
    for (std::size_t i = 0; i < colours.size(); ++i)
      colours[i] = i % 4 == 3 ? colours[i] : static_cast<float>(light_of(colours[i]));
    add("COLOR_0", colours, 4);
    std::vector<float> texcoords = numbers_of(geometry.getTexCoordArray(0), count, 2);
    for (std::size_t i = 1; i < texcoords.size(); i += 2)
      texcoords[i] = 1 - texcoords[i];
    add("TEXCOORD_0", texcoords, 2);
    return attributes;
  }

  template <class Number>
  std::size_t add_numbers(const std::vector<Number>& numbers, std::size_t width, int type) {
    constexpr std::array kTypes{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const std::size_t offset = bin_.size();
    bin_.resize(offset + numbers.size() * sizeof(Number));
    storage::store_all_little<Number>(numbers, reinterpret_cast<std::byte*>(bin_.data() + offset));
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bin_.size() - offset}});
    json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1},
                                  {"componentType", type},
                                  {"count", numbers.size() / width},
                                  {"type", kTypes[width]}});
    return json_["accessors"].size() - 1;
  }

  void add_node(const osg::Matrixd& place) {
    Json node{{"mesh", json_["meshes"].size() - 1}};
    if (!place.isIdentity())
      node["matrix"] = std::vector<double>(place.ptr(), place.ptr() + 16);
    nodes_.push_back(json_["nodes"].size());
    json_["nodes"].push_back(std::move(node));
  }

  std::size_t material_of(const Part& part, bool has_texcoords) {
    const auto key = std::tuple(part.look, has_texcoords);
    const auto [known, is_new] = materials_.emplace(key, json_["materials"].size());
    if (is_new)
      json_["materials"].push_back(made_material(part.look, has_texcoords));
    return known->second;
  }

  /// A picture is shown as it is: what photogrammetry writes as the colour under it is light.
  Json made_material(const Look& look, bool has_texcoords) {
    Json base = Json::object();
    const auto texture =
        has_texcoords && look.texture != nullptr ? texture_of(*look.texture) : std::nullopt;
    if (texture) {
      base["baseColorTexture"] = {{"index", *texture}};
    } else if (look.material != nullptr) {
      const osg::Vec4 colour = look.material->getDiffuse(osg::Material::FRONT);
      base["baseColorFactor"] = {light_of(colour[0]), light_of(colour[1]), light_of(colour[2]),
                                 std::clamp(double{colour[3]}, 0.0, 1.0)};
    }
    Json material{{"pbrMetallicRoughness", std::move(base)}};
    if (look.cutoff) {
      material["alphaMode"] = "MASK";
      material["alphaCutoff"] = std::clamp(double{*look.cutoff}, 0.0, 1.0);
    } else if (look.is_blended) {
      material["alphaMode"] = "BLEND";
    }
    return material;
  }

  std::optional<std::size_t> texture_of(const osg::Texture& texture) {
    const osg::Image* const image = texture.getImage(0);
    const auto source = image == nullptr ? std::nullopt : image_of(*image);
    if (!source)
      return std::nullopt;
    json_["samplers"].push_back({{"wrapS", wrap_of(texture.getWrap(osg::Texture::WRAP_S))},
                                 {"wrapT", wrap_of(texture.getWrap(osg::Texture::WRAP_T))}});
    json_["textures"].push_back({{"sampler", json_["samplers"].size() - 1}, {"source", *source}});
    return json_["textures"].size() - 1;
  }

  std::optional<std::size_t> image_of(const osg::Image& image) {
    if (const auto known = images_.find(&image); known != images_.end())
      return known->second;
    const auto* const kept = dynamic_cast<const KeptImage*>(&image);
    Json entry{{"name", image.getFileName()}};
    if (kept != nullptr && kept->bytes.empty()) {
      entry["uri"] = kept->name;
    } else {
      const std::string bytes = picture_start(image);
      if (bytes.empty())
        return std::nullopt;
      pictures_.emplace(bin_.size(), &image);
      json_["bufferViews"].push_back(
          {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}});
      entry["bufferView"] = json_["bufferViews"].size() - 1;
      bin_ += bytes;
      bin_.resize((bin_.size() + 3) / 4 * 4);
    }
    json_["images"].push_back(std::move(entry));
    return images_.emplace(&image, json_["images"].size() - 1).first->second;
  }

  void append_word(std::uint32_t word) {
    std::array<std::byte, 4> bytes{};
    storage::store_little(word, bytes.data());
    made_.bytes.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  Json json_ = Json::object();
  Json nodes_ = Json::array();
  std::string bin_;
  std::map<std::tuple<Look, bool>, std::size_t> materials_;
  std::map<const osg::Image*, std::size_t> images_;
  std::map<std::size_t, const osg::Image*> pictures_;  ///< by where they begin in bin_
  SceneGlb made_;
};

}  // namespace

SceneGlb scene_glb(const std::vector<Part>& parts) {
  GlbWriter writer;
  for (const Part& part : parts)
    writer.add(part);
  return writer.finish();
}

}  // namespace meshhier::mesh_io::osgb
