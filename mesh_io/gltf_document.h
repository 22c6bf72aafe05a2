// A glTF 2.0 document as values (Khronos, glTF 2.0 specification), as far as meshes and their base
// colours go. Each value is checked by itself. gltf_elements.h checks that ranges fit into buffers.
#pragma once

#include "base/vec.h"
#include "hierarchy/object_row.h"
#include "hierarchy/texture.h"
#include "mesh_io/gltf_transform.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::mesh_io {

struct GltfBuffer {
  std::uint64_t bytes = 0;
  std::optional<std::string> uri;
};

/// The stream that a view's bytes are decoded from (EXT_meshopt_compression).
struct GltfMeshopt {
  enum class Mode : std::uint8_t { attributes, triangles, indices };
  enum class Filter : std::uint8_t { none, octahedral, quaternion, exponential };
  std::uint32_t buffer = 0;
  std::uint64_t offset = 0, bytes = 0;
  std::uint64_t stride = 0, count = 0;
  Mode mode = Mode::attributes;
  Filter filter = Filter::none;
};

struct GltfView {
  std::uint32_t buffer = 0;
  std::uint64_t offset = 0, bytes = 0;
  std::uint64_t stride = 0;  ///< 0: elements are packed
  std::optional<GltfMeshopt> meshopt{};
};

enum class GltfComponent : std::uint8_t { i8, u8, i16, u16, u32, f32 };
std::size_t bytes_of(GltfComponent component);

/// Values that replace some elements of an accessor.
struct GltfSparse {
  std::uint64_t count = 0;
  std::uint32_t index_view = 0;
  std::uint64_t index_offset = 0;
  GltfComponent index_component = GltfComponent::u32;
  std::uint32_t value_view = 0;
  std::uint64_t value_offset = 0;
};

struct GltfAccessor {
  std::optional<std::uint32_t> view;  ///< none: zeros
  std::uint64_t offset = 0;
  std::uint64_t count = 0;  ///< < 2^32
  GltfComponent component = GltfComponent::f32;
  std::uint32_t components = 1;  ///< numbers an element has: 1 to 4; 9 and 16 are matrices
  bool normalized = false;
  std::optional<GltfSparse> sparse{};

  std::uint64_t element_bytes() const { return components * bytes_of(component); }
};

/// Names of attributes, each with the number of the accessor or of the Draco attribute that holds
/// it.
using GltfAttributes = std::map<std::string, std::uint32_t>;

/// KHR_draco_mesh_compression.
struct GltfDraco {
  std::uint32_t view = 0;
  GltfAttributes ids;
};

struct GltfPrimitive {
  enum class Mode : std::uint8_t { points, lines, line_loop, line_strip, triangles, strip, fan };
  Mode mode = Mode::triangles;
  GltfAttributes attributes;  ///< numbers are those of accessors
  std::optional<std::uint32_t> indices;
  std::optional<std::uint32_t> material;
  std::optional<GltfDraco> draco{};
  std::uint64_t morph_targets = 0;
  std::shared_ptr<const nlohmann::json> features{};  ///< EXT_mesh_features as it is; null: none

  bool has_triangles() const { return mode >= Mode::triangles; }
  std::optional<std::uint32_t> attribute(const std::string& name) const;
};

struct GltfMesh {
  std::vector<GltfPrimitive> primitives;
  std::string name{};
};

/// Copies of a node's mesh within the node (EXT_mesh_gpu_instancing): accessors with an element for
/// each copy. An accessor that is missing means no move, no turn, size 1.
struct GltfInstancing {
  std::optional<std::uint32_t> translation, rotation, scale;
  GltfAttributes attributes{};                       ///< accessors by name, if there are features
  std::shared_ptr<const nlohmann::json> features{};  ///< EXT_instance_features as it is; null: none
};

struct GltfSkin {
  std::vector<std::uint32_t> joints;             ///< nodes, one or more
  std::optional<std::uint32_t> inverse_binds{};  ///< an accessor; none: all are the identity
};

struct GltfNode {
  std::optional<std::uint32_t> mesh;
  std::vector<std::uint32_t> children;
  GltfTransform transform;
  std::optional<std::uint32_t> skin{};  ///< skin of its mesh
  bool is_camera = false;
  bool is_visible = true;  ///< KHR_node_visibility; else neither it nor what is below it is shown
  std::optional<GltfInstancing> instancing{};
  std::string name{};
  /// Values of its "extras", by key.
  std::vector<std::pair<std::string, ObjectValue>> extras{};
};

/// KHR_texture_transform: offset + rotation * (scale * coordinate).
struct GltfTextureTransform {
  std::array<double, 2> offset{0, 0};
  double rotation = 0;
  std::array<double, 2> scale{1, 1};
  friend bool operator==(const GltfTextureTransform&, const GltfTextureTransform&) = default;
};

/// A texture as a material shows it.
struct GltfTextureUse {
  std::uint32_t texture = 0;
  std::uint32_t texcoord = 0;  ///< number of the texture coordinates that it takes
  GltfTextureTransform transform{};
};

struct GltfMaterial {
  std::string name;
  /// The factor of the base colour: linear, and alpha.
  std::array<double, 4> factor{1, 1, 1, 1};
  std::optional<GltfTextureUse> base{};  ///< the base colour's picture
  /// The light of its own, linear, from 0 on: emissiveFactor times KHR_materials_emissive_strength.
  std::array<double, 3> emission{};
  /// The picture that `emission` multiplies; none where that is 0.
  std::optional<GltfTextureUse> glow{};
  /// KHR_techniques_webgl has pictures of which none is known to be `base`.
  bool is_unknown = false;
  AlphaMode alpha = AlphaMode::opaque;
  double alpha_cutoff = 0.5;

  bool emits() const { return emission != std::array<double, 3>{}; }
  /// Returns true if nothing of it shows, whatever its picture and the colours of vertices are.
  bool is_invisible() const {
    return (alpha == AlphaMode::blend && factor[3] <= 0) ||
           (alpha == AlphaMode::mask && factor[3] < alpha_cutoff);
  }
};

struct GltfSampler {
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

/// A format of pictures that is not read.
struct GltfPictureFormat {
  const char* extension;
  const char* name;
};

struct GltfTexture {
  /// The forms of its picture, each an image: WebP, what "source" names, KTX2. None: it is of a
  /// format that is not read.
  std::vector<std::uint32_t> forms;
  bool has_ktx2 = false;  ///< the last one is KTX2
  std::optional<std::uint32_t> sampler{};
  const GltfPictureFormat* unread = nullptr;  ///< an extension has a picture for it
};

struct GltfImage {
  std::string name;
  std::optional<std::string> uri;
  std::optional<std::uint32_t> view;
};

struct GltfDocument {
  std::vector<GltfBuffer> buffers;
  std::vector<GltfView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfSkin> skins;
  std::vector<GltfNode> nodes;
  std::vector<GltfMaterial> materials;
  std::vector<GltfTexture> textures;
  std::vector<GltfSampler> samplers;
  std::vector<GltfImage> images;
  std::vector<std::uint32_t> roots;  ///< roots of the scene that is shown
  std::uint64_t animations = 0;
  /// The vector that is added to all positions, in the document's own axes (CESIUM_RTC).
  Vec3d centre{};
  std::vector<std::string> required;                 ///< extensions
  std::shared_ptr<const nlohmann::json> metadata{};  ///< EXT_structural_metadata as it is, or null
};

/// Reads a document. The scene is the one that it names, else the first; if there is none, all
/// nodes that are no children are roots. Throws Error(input) naming file and place if it is no glTF
/// 2.x, if a value is not what the specification says, or if it requires an extension that is not
/// known; and as parse_gltf_json().
GltfDocument read_gltf_document(std::string json, const std::filesystem::path& path,
                                std::uint64_t most_bytes);

}  // namespace meshhier::mesh_io
