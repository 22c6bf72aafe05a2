// glTF files for tests, put together piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::tests {

using GltfJson = nlohmann::ordered_json;

inline std::string little(std::uint32_t value) {
  std::string bytes(4, '\0');
  for (std::size_t i = 0; i < 4; ++i)
    bytes[i] = static_cast<char>(value >> (8 * i));
  return bytes;
}

/// A GLB of a JSON text and bytes.
inline std::string glb_of(std::string json, std::string bin) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4);
  const auto size = [](std::size_t bytes) { return little(static_cast<std::uint32_t>(bytes)); };
  std::string glb = "glTF" + little(2) + size(12 + 8 + json.size() + 8 + bin.size());
  glb += size(json.size()) + "JSON" + json;
  return glb + size(bin.size()) + std::string("BIN\0", 4) + bin;
}

class GltfBuilder {
 public:
  GltfJson json{{"asset", {{"version", "2.0"}}}};
  std::string bin;

  /// A view of new bytes in buffer 0; returns its number.
  std::size_t view(std::string_view bytes, const GltfJson& more = GltfJson::object()) {
    bin.resize((bin.size() + 3) / 4 * 4);
    GltfJson view{{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
    view.update(more);
    bin += bytes;
    return add("bufferViews", view);
  }

  template <class Number>
  static std::string bytes_of(const std::vector<Number>& numbers) {
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
  }

  template <class Number>
  static int component() {
    if constexpr (std::is_same_v<Number, float>)
      return 5126;
    constexpr int kSizes[] = {0, 5120, 5122, 0, 5124};
    return kSizes[sizeof(Number)] + (std::is_unsigned_v<Number> ? 1 : 0);
  }

  /// An accessor of new, packed numbers; returns its number.
  template <class Number>
  std::size_t accessor(const std::vector<Number>& numbers, const std::string& type,
                       const GltfJson& more = GltfJson::object()) {
    const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
    GltfJson accessor{{"bufferView", view(bytes_of(numbers))},
                      {"componentType", component<Number>()},
                      {"count", numbers.size() / components},
                      {"type", type}};
    accessor.update(more);
    return add("accessors", accessor);
  }

  /// A mesh of one primitive; returns its number.
  std::size_t mesh(const GltfJson& primitive) {
    return add("meshes", {{"primitives", GltfJson::array({primitive})}});
  }
  /// A mesh and a node that shows it.
  void show(const GltfJson& primitive) { node({{"mesh", mesh(primitive)}}); }
  std::size_t node(const GltfJson& node) { return add("nodes", node); }

  std::size_t add(const std::string& list, const GltfJson& item) {
    json[list].push_back(item);
    return json[list].size() - 1;
  }

  /// A material that shows a picture; returns its number.
  std::size_t textured_material(const GltfJson& image, const GltfJson& use = GltfJson::object()) {
    const std::size_t texture = add("textures", {{"source", add("images", image)}});
    GltfJson base{{"index", texture}};
    base.update(use);
    return add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", base}}}});
  }

  /// The JSON, its buffer being the file `uri`, or the chunk of a GLB if it is empty.
  std::string text(const std::string& uri) const {
    GltfJson whole = json;
    GltfJson buffer{{"byteLength", bin.size()}};
    if (!uri.empty())
      buffer["uri"] = uri;
    if (!bin.empty() && !whole.contains("buffers"))
      whole["buffers"] = GltfJson::array({buffer});
    return whole.dump();
  }
  std::string glb() const { return glb_of(text(""), bin); }
};

}  // namespace meshhier::tests
