#include "mesh_io/gltf_extensions.h"

#include <algorithm>
#include <array>

namespace meshhier::mesh_io {
namespace {

// docs/input_formats.md has both lists.

constexpr auto kUsed = std::to_array<GltfExtension>({
    {"CESIUM_RTC", "places the mesh"},
    {"EXT_mesh_gpu_instancing", "places copies of a mesh"},
    {"EXT_meshopt_compression", "packs buffers"},
    {"EXT_texture_avif", "pictures; refused where one is shown"},
    {"EXT_texture_webp", "pictures"},
    {"KHR_draco_mesh_compression", "packs meshes"},
    {"KHR_materials_emissive_strength", "light of materials"},
    {"KHR_materials_pbrSpecularGlossiness", "colours and pictures"},
    {"KHR_mesh_quantization", "types of numbers"},
    {"KHR_node_visibility", "leaves nodes out"},
    {"KHR_techniques_webgl", "colours and pictures"},
    {"KHR_texture_basisu", "pictures"},
    {"KHR_texture_transform", "places pictures"},
    {"MSFT_texture_dds", "pictures; refused where one is shown"},
});

constexpr auto kHarmless = std::to_array<GltfExtension>({
    {"ADOBE_materials_clearcoat_specular", "the coat of a surface"},
    {"ADOBE_materials_clearcoat_tint", "the coat of a surface"},
    {"ADOBE_materials_thin_transparency", "light through a surface"},
    {"AGI_articulations", "names what may move"},
    {"AGI_stk_metadata", "metadata"},
    {"BENTLEY_materials_line_style", "how lines are drawn"},
    {"BENTLEY_materials_point_style", "how points are drawn"},
    {"CESIUM_primitive_outline", "lines along edges"},
    {"EXT_instance_features", "numbers of copies"},
    {"EXT_lights_ies", "lights"},
    {"EXT_lights_image_based", "lights"},
    {"EXT_mesh_features", "numbers of vertices, which are attributes"},
    {"EXT_mesh_manifold", "the same triangles in another order"},
    {"EXT_mesh_primitive_edge_visibility", "lines along edges"},
    {"EXT_structural_metadata", "metadata"},
    {"FB_geometry_metadata", "metadata"},
    {"GODOT_single_root", "how the scene is loaded"},
    {"GRIFFEL_bim_data", "metadata"},
    {"KHR_animation_pointer", "animations"},
    {"KHR_audio", "sounds"},
    {"KHR_audio_emitter", "sounds"},
    {"KHR_implicit_shapes", "shapes for collisions"},
    {"KHR_interactivity", "what happens on a click"},
    {"KHR_lights_punctual", "lights"},
    {"KHR_materials_", "gloss, coats, light through a surface"},
    {"KHR_node_hoverability", "what a pointer meets"},
    {"KHR_node_selectability", "what a click meets"},
    {"KHR_physics_rigid_bodies", "how things move"},
    {"KHR_xmp", "metadata"},
    {"KHR_xmp_json_ld", "metadata"},
    {"MSFT_lod", "coarser meshes of a node, which are not shown"},
    {"MSFT_packing_normalRoughnessMetallic", "other maps of a surface"},
    {"MSFT_packing_occlusionRoughnessMetallic", "other maps of a surface"},
    {"OMI_collider", "shapes for collisions"},
    {"OMI_physics_body", "how things move"},
    {"OMI_physics_shape", "shapes for collisions"},
    {"OMI_seat", "where somebody may sit"},
    {"OMI_spawn_point", "where somebody begins"},
    {"VRM", "who a figure is, how it moves"},
    {"VRMC_materials_mtoon", "light on a surface"},
    {"VRMC_node_constraint", "how joints move"},
    {"VRMC_springBone", "how joints move"},
    {"VRMC_vrm", "who a figure is, how it moves"},
});

bool is_among(std::span<const GltfExtension> extensions, std::string_view name) {
  return std::ranges::any_of(extensions, [&](const GltfExtension& one) {
    return name == one.name || (one.name.ends_with('_') && name.starts_with(one.name));
  });
}

}  // namespace

std::span<const GltfExtension> read_extensions() {
  return kUsed;
}

std::span<const GltfExtension> harmless_extensions() {
  return kHarmless;
}

bool may_be_required(std::string_view extension) {
  return is_among(kUsed, extension) || is_among(kHarmless, extension);
}

}  // namespace meshhier::mesh_io
