// The places where a glTF scene shows a mesh: one, or as many as EXT_mesh_gpu_instancing says.
#pragma once

#include "mesh_io/gltf_file.h"
#include "mesh_io/gltf_scene.h"

#include <cstdint>
#include <functional>

namespace meshhier::importing {

/// Returns how many copies of the mesh there are, by the accessors' counts; 1 without any.
std::uint64_t copy_count(const mesh_io::GltfDocument& document,
                         const mesh_io::GltfInstance& instance);

/// Visits the place of each copy. Throws Error(input) naming the accessor if its numbers are no
/// places.
void for_each_copy(mesh_io::GltfFile& file, const mesh_io::GltfInstance& instance,
                   const std::function<void(const mesh_io::GltfTransform&)>& visit);

}  // namespace meshhier::importing
