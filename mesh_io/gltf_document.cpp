#include "mesh_io/gltf_document.h"

#include "base/named_value.h"
#include "base/plain_text.h"
#include "mesh_io/gltf_extensions.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/gltf_techniques.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// Offsets and sizes: sums of two or three are still numbers.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 53;
constexpr std::uint64_t kMostGltfElements = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kMostStride = 256;
constexpr std::size_t kLongestGltfName = 255;

/// Whoever shows such a picture finds that it cannot be read.
constexpr std::array<GltfPictureFormat, 2> kUnreadFormats{
    {{"EXT_texture_avif", "AVIF"}, {"MSFT_texture_dds", "DDS"}}};

/// The value of a table that `text` names.
template <class Table>
auto choice(const GltfObject& object, const char* key, const std::string& text,
            const Table& table) {
  const auto value = value_named(table, text);
  if (!value)
    object.fail(fmt::format("has the unknown {} \"{}\"", key, plain_text(text, kLongestGltfName)));
  return *value;
}

template <std::size_t size>
std::array<double, size> numbers(const GltfObject& object, const char* key,
                                 const std::array<double, size>& otherwise) {
  const auto found = object.numbers(key, size);
  std::array<double, size> numbers = otherwise;
  if (found)
    std::ranges::copy(*found, numbers.begin());
  return numbers;
}

Vec3d as_vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

struct Component {
  std::uint64_t number;  ///< the number that files have for it
  GltfComponent value;
  std::size_t bytes;
};
constexpr std::array kComponents{
    Component{5120, GltfComponent::i8, 1},  Component{5121, GltfComponent::u8, 1},
    Component{5122, GltfComponent::i16, 2}, Component{5123, GltfComponent::u16, 2},
    Component{5125, GltfComponent::u32, 4}, Component{5126, GltfComponent::f32, 4}};

GltfComponent read_component(const GltfObject& object) {
  const std::uint64_t number = object.require_count("componentType", kMostGltfElements);
  const auto found = std::ranges::find(kComponents, number, &Component::number);
  if (found == kComponents.end())
    object.fail("has an unknown componentType");
  return found->value;
}

std::uint32_t read_components(const GltfObject& object) {
  static constexpr std::array kSizes{
      NamedValue{"SCALAR", std::uint32_t{1}}, NamedValue{"VEC2", std::uint32_t{2}},
      NamedValue{"VEC3", std::uint32_t{3}},   NamedValue{"VEC4", std::uint32_t{4}},
      NamedValue{"MAT2", std::uint32_t{4}},   NamedValue{"MAT3", std::uint32_t{9}},
      NamedValue{"MAT4", std::uint32_t{16}}};
  return choice(object, "type", object.text("type").value_or(""), kSizes);
}

/// `name` of the object; of hostile length, or with control characters, not.
std::string read_name(const GltfObject& object) {
  return plain_text(object.text("name").value_or(""), kLongestGltfName);
}

/// The same as it is, for objects; what is no text is no name.
std::string read_whole_name(const GltfObject& object) {
  return object.has_text("name", "") ? *object.text("name") : std::string();
}

/// One reading of a document.
class DocumentReader {
 public:
  explicit DocumentReader(const GltfObject& root) : root_(root) {}

  GltfDocument read() {
    check_version();
    check_extensions();
    read_centre();
    root_.for_each("buffers", [&](const GltfObject& o) { read_buffer(o); });
    root_.for_each("bufferViews", [&](const GltfObject& o) { read_view(o); });
    root_.for_each("accessors", [&](const GltfObject& o) { read_accessor(o); });
    read_pictures();
    root_.for_each("materials", [&](const GltfObject& o) { read_material(o); });
    root_.for_each("meshes", [&](const GltfObject& o) { read_mesh(o); });
    root_.for_each("skins", [&](const GltfObject& o) { read_skin(o); });
    root_.for_each("nodes", [&](const GltfObject& o) { read_node(o); });
    read_roots();
    document_.animations = root_.item_count("animations");
    if (root_.has_object("extensions") &&
        root_.object("extensions")->has_object("EXT_structural_metadata"))
      document_.metadata = root_.extension("EXT_structural_metadata")->copy();
    return std::move(document_);
  }

 private:
  void check_version() const {
    const auto asset = root_.object("asset");
    if (!asset || !asset->has_text("version", "2."))
      root_.fail(
          fmt::format("is no glTF 2.0, which has an asset.version \"2.0\"; {}", kUpgradeGltf));
  }

  void check_extensions() {
    document_.required = root_.texts("extensionsRequired");
    for (const std::string& name : document_.required) {
      if (!may_be_required(name)) {
        root_.fail(
            fmt::format("requires the extension {}, which is not read; export the mesh "
                        "without it",
                        plain_text(name, kLongestGltfName)));
      }
    }
  }

  /// Cesium adds the centre to what it has turned from y up to z up.
  void read_centre() {
    const auto rtc = root_.extension("CESIUM_RTC");
    if (!rtc)
      return;
    const auto c = numbers<3>(*rtc, "center", {0, 0, 0});
    document_.centre = {c[0], c[2], -c[1]};
  }

  void read_buffer(const GltfObject& o) {
    document_.buffers.push_back({o.require_count("byteLength", kMostBytes), o.text("uri")});
  }

  GltfMeshopt read_meshopt(const GltfObject& o) const {
    using Mode = GltfMeshopt::Mode;
    using Filter = GltfMeshopt::Filter;
    static constexpr std::array kModes{NamedValue{"ATTRIBUTES", Mode::attributes},
                                       NamedValue{"TRIANGLES", Mode::triangles},
                                       NamedValue{"INDICES", Mode::indices}};
    static constexpr std::array kFilters{NamedValue{"NONE", Filter::none},
                                         NamedValue{"OCTAHEDRAL", Filter::octahedral},
                                         NamedValue{"QUATERNION", Filter::quaternion},
                                         NamedValue{"EXPONENTIAL", Filter::exponential}};
    return {.buffer = o.require_index("buffer", document_.buffers.size()),
            .offset = o.count("byteOffset", kMostBytes).value_or(0),
            .bytes = o.require_count("byteLength", kMostBytes),
            .stride = o.require_count("byteStride", kMostStride),
            .count = o.require_count("count", kMostGltfElements),
            .mode = choice(o, "mode", o.text("mode").value_or(""), kModes),
            .filter = choice(o, "filter", o.text("filter").value_or("NONE"), kFilters)};
  }

  void read_view(const GltfObject& o) {
    GltfView view{.buffer = o.require_index("buffer", document_.buffers.size()),
                  .offset = o.count("byteOffset", kMostBytes).value_or(0),
                  .bytes = o.require_count("byteLength", kMostBytes),
                  .stride = o.count("byteStride", kMostStride).value_or(0)};
    if (const auto meshopt = o.extension("EXT_meshopt_compression"))
      view.meshopt = read_meshopt(*meshopt);
    document_.views.push_back(view);
  }

  GltfSparse read_sparse(const GltfObject& o) const {
    const GltfObject indices = o.require_object("indices");
    const GltfObject values = o.require_object("values");
    return {.count = o.require_count("count", kMostGltfElements),
            .index_view = indices.require_index("bufferView", document_.views.size()),
            .index_offset = indices.count("byteOffset", kMostBytes).value_or(0),
            .index_component = read_component(indices),
            .value_view = values.require_index("bufferView", document_.views.size()),
            .value_offset = values.count("byteOffset", kMostBytes).value_or(0)};
  }

  void read_accessor(const GltfObject& o) {
    GltfAccessor accessor{.view = o.index("bufferView", document_.views.size()),
                          .offset = o.count("byteOffset", kMostBytes).value_or(0),
                          .count = o.require_count("count", kMostGltfElements),
                          .component = read_component(o),
                          .components = read_components(o),
                          .normalized = o.flag("normalized")};
    if (const auto sparse = o.object("sparse"))
      accessor.sparse = read_sparse(*sparse);
    document_.accessors.push_back(accessor);
  }

  static Wrap read_wrap(const GltfObject& o, const char* key) {
    constexpr std::uint64_t kRepeat = 10497, kClamp = 33071, kMirrored = 33648;
    switch (o.count(key, kMostGltfElements).value_or(kRepeat)) {
      case kRepeat:
        return Wrap::repeat;
      case kClamp:
        return Wrap::clamp;
      case kMirrored:
        return Wrap::mirrored;
      default:
        o.fail(fmt::format("has an unknown {}", key));
    }
  }

  void read_pictures() {
    root_.for_each("images", [&](const GltfObject& o) {
      document_.images.push_back(
          {read_name(o), o.text("uri"), o.index("bufferView", document_.views.size())});
    });
    root_.for_each("samplers", [&](const GltfObject& o) {
      document_.samplers.push_back({read_wrap(o, "wrapS"), read_wrap(o, "wrapT")});
    });
    root_.for_each("textures", [&](const GltfObject& o) { read_texture(o); });
  }

  void read_texture(const GltfObject& o) {
    GltfTexture texture;
    add_forms(o, true, texture);
    if (const auto source = o.index("source", document_.images.size()))
      texture.forms.push_back(*source);
    texture.has_ktx2 = add_forms(o, false, texture);
    texture.sampler = o.index("sampler", document_.samplers.size());
    for (const GltfPictureFormat& format : kUnreadFormats)
      texture.unread = o.extension(format.extension) ? &format : texture.unread;
    document_.textures.push_back(std::move(texture));
  }

  /// Adds the pictures that extensions name; returns whether there is one.
  bool add_forms(const GltfObject& o, bool in_browsers, GltfTexture& to) const {
    const std::size_t before = to.forms.size();
    for (const ImageFormatRow& row : kImageFormats) {
      if (row.gltf_extension == nullptr || row.in_browsers != in_browsers)
        continue;
      if (const auto form = o.extension(row.gltf_extension))
        to.forms.push_back(form->require_index("source", document_.images.size()));
    }
    return to.forms.size() > before;
  }

  GltfTextureUse read_texture_use(const GltfObject& o) const {
    GltfTextureUse use{
        .texture = o.require_index("index", document_.textures.size()),
        .texcoord = static_cast<std::uint32_t>(o.count("texCoord", kMostGltfElements).value_or(0))};
    const auto transform = o.extension("KHR_texture_transform");
    if (!transform)
      return use;
    use.transform = {numbers<2>(*transform, "offset", {0, 0}), transform->number("rotation", 0),
                     numbers<2>(*transform, "scale", {1, 1})};
    if (const auto texcoord = transform->count("texCoord", kMostGltfElements))
      use.texcoord = static_cast<std::uint32_t>(*texcoord);
    return use;
  }

  void read_colour(const GltfObject& o, const char* factor, const char* texture,
                   GltfMaterial& material) const {
    material.factor = numbers<4>(o, factor, {1, 1, 1, 1});
    if (const auto use = o.object(texture))
      material.base = read_texture_use(*use);
  }

  /// A shader's texture or colour that its name tells to be the base colour, or its only texture.
  void read_technique(const GltfObject& o, GltfMaterial& material) const {
    const std::vector<GltfObject> values = technique_values(root_, o);
    const auto texture = technique_texture(values);
    material.is_unknown = texture.is_unknown;
    if (texture.use)
      material.base = read_texture_use(*texture.use);
    else if (const auto colour = technique_colour(values))
      material.factor = *colour;
  }

  /// An unlit material emits nothing besides what it shows.
  void read_emission(const GltfObject& o, GltfMaterial& material) const {
    constexpr double kMostLight = 1e6;
    if (o.extension("KHR_materials_unlit"))
      return;
    const auto strength = o.extension("KHR_materials_emissive_strength");
    const double times = strength ? strength->number("emissiveStrength", 1) : 1;
    const auto factor = numbers<3>(o, "emissiveFactor", {0, 0, 0});
    for (std::size_t c = 0; c < factor.size(); ++c)
      material.emission[c] = std::clamp(factor[c] * times, 0.0, kMostLight);
    if (const auto use = o.object("emissiveTexture"); use && material.emits())
      material.glow = read_texture_use(*use);
  }

  void read_material(const GltfObject& o) {
    GltfMaterial material{.name = read_name(o)};
    const auto metallic = o.object("pbrMetallicRoughness");
    const bool has_base =
        metallic && (metallic->has("baseColorFactor") || metallic->has("baseColorTexture"));
    const auto glossy = o.extension("KHR_materials_pbrSpecularGlossiness");
    if (has_base)
      read_colour(*metallic, "baseColorFactor", "baseColorTexture", material);
    else if (glossy)
      read_colour(*glossy, "diffuseFactor", "diffuseTexture", material);
    else if (const auto shader = o.extension("KHR_techniques_webgl"))
      read_technique(*shader, material);
    read_emission(o, material);
    material.alpha = choice(o, "alphaMode", o.text("alphaMode").value_or("OPAQUE"), kAlphaModes);
    material.alpha_cutoff = o.number("alphaCutoff", material.alpha_cutoff);
    document_.materials.push_back(std::move(material));
  }

  static GltfAttributes read_attributes(const GltfObject& o, std::size_t size) {
    GltfAttributes attributes;
    o.for_each_index(size, [&](const std::string& name, std::uint32_t number) {
      if (name == "POSITION" || name == "NORMAL" || name == "COLOR_0" ||
          name.starts_with("TEXCOORD_") || name.starts_with("JOINTS_") ||
          name.starts_with("WEIGHTS_") || name.starts_with('_') || name == "BATCHID")
        attributes.emplace(name, number);
    });
    return attributes;
  }

  GltfPrimitive read_primitive(const GltfObject& o) const {
    constexpr auto kLastMode = static_cast<std::uint64_t>(GltfPrimitive::Mode::fan);
    constexpr auto kTriangles = static_cast<std::uint64_t>(GltfPrimitive::Mode::triangles);
    const std::size_t accessors = document_.accessors.size();
    GltfPrimitive primitive{
        .mode = static_cast<GltfPrimitive::Mode>(o.count("mode", kLastMode).value_or(kTriangles)),
        .attributes = read_attributes(o.require_object("attributes"), accessors),
        .indices = o.index("indices", accessors),
        .material = o.index("material", document_.materials.size()),
        .morph_targets = o.item_count("targets")};
    if (const auto draco = o.extension("KHR_draco_mesh_compression")) {
      primitive.draco = {draco->require_index("bufferView", document_.views.size()),
                         read_attributes(draco->require_object("attributes"), kMostGltfElements)};
    }
    if (o.has_object("extensions") && o.object("extensions")->has_object("EXT_mesh_features"))
      primitive.features = o.extension("EXT_mesh_features")->copy();
    return primitive;
  }

  void read_mesh(const GltfObject& o) {
    GltfMesh mesh;
    o.for_each("primitives",
               [&](const GltfObject& p) { mesh.primitives.push_back(read_primitive(p)); });
    mesh.name = read_whole_name(o);
    document_.meshes.push_back(std::move(mesh));
  }

  void read_skin(const GltfObject& o) {
    GltfSkin skin{o.indices("joints", root_.item_count("nodes")),
                  o.index("inverseBindMatrices", document_.accessors.size())};
    if (skin.joints.empty())
      o.fail("has no joints");
    document_.skins.push_back(std::move(skin));
  }

  static GltfTransform read_transform(const GltfObject& o) {
    if (o.has("matrix"))
      return gltf_matrix(numbers<16>(o, "matrix", {}));
    const auto rotation = numbers<4>(o, "rotation", {0, 0, 0, 1});
    if (rotation == std::array<double, 4>{})
      o.fail("has a rotation of zeros");
    return gltf_placement(as_vector(numbers<3>(o, "translation", {0, 0, 0})), rotation,
                          as_vector(numbers<3>(o, "scale", {1, 1, 1})));
  }

  std::optional<GltfInstancing> read_instancing(const GltfObject& o) const {
    const auto extension = o.extension("EXT_mesh_gpu_instancing");
    if (!extension)
      return std::nullopt;
    const GltfObject attributes = extension->require_object("attributes");
    const std::size_t accessors = document_.accessors.size();
    GltfInstancing copies{attributes.index("TRANSLATION", accessors),
                          attributes.index("ROTATION", accessors),
                          attributes.index("SCALE", accessors)};
    if (const auto features = o.extension("EXT_instance_features")) {
      copies.features = features->copy();
      attributes.for_each_index(accessors, [&](const std::string& name, std::uint32_t accessor) {
        copies.attributes.emplace(name, accessor);
      });
    }
    return copies;
  }

  void read_node(const GltfObject& o) {
    const auto visibility = o.extension("KHR_node_visibility");
    document_.nodes.push_back(
        {o.index("mesh", document_.meshes.size()), o.indices("children", root_.item_count("nodes")),
         read_transform(o), o.index("skin", document_.skins.size()), o.has("camera"),
         !visibility || !visibility->has("visible") || visibility->flag("visible"),
         read_instancing(o), read_whole_name(o), o.values("extras")});
  }

  void read_roots() {
    const auto scene = root_.index("scene", root_.item_count("scenes"));
    std::uint32_t number = 0;
    root_.for_each("scenes", [&](const GltfObject& o) {
      if (number++ == scene.value_or(0))
        document_.roots = o.indices("nodes", document_.nodes.size());
    });
    if (number == 0)
      document_.roots = parentless_nodes();
  }

  std::vector<std::uint32_t> parentless_nodes() const {
    std::vector<bool> is_child(document_.nodes.size());
    for (const GltfNode& node : document_.nodes) {
      for (const std::uint32_t child : node.children)
        is_child[child] = true;
    }
    std::vector<std::uint32_t> roots;
    for (std::uint32_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i])
        roots.push_back(i);
    }
    return roots;
  }

  const GltfObject& root_;
  GltfDocument document_;
};

}  // namespace

std::size_t bytes_of(GltfComponent component) {
  return row_with(kComponents, component).bytes;
}

std::optional<std::uint32_t> GltfPrimitive::attribute(const std::string& name) const {
  const auto found = attributes.find(name);
  return found == attributes.end() ? std::nullopt : std::optional(found->second);
}

GltfDocument read_gltf_document(std::string json, const std::filesystem::path& path,
                                std::uint64_t most_bytes) {
  const nlohmann::json parsed = parse_gltf_json(std::move(json), path, most_bytes);
  return DocumentReader(GltfObject(parsed, path)).read();
}

}  // namespace meshhier::mesh_io
