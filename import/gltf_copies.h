// Where a glTF scene shows a mesh: once, or as often as EXT_mesh_gpu_instancing says.
#pragma once

#include "mesh_io/gltf_file.h"
#include "mesh_io/gltf_scene.h"

#include <cstdint>
#include <functional>

namespace meshhier::importing {

/// How many copies an accessor says that there are; 1 without any.
std::uint64_t copy_count(const mesh_io::GltfDocument& document,
                         const mesh_io::GltfInstance& instance);

/// Visits the place of each. Throws Error(input) naming the accessor if they are no places.
void for_each_copy(mesh_io::GltfFile& file, const mesh_io::GltfInstance& instance,
                   const std::function<void(const mesh_io::GltfTransform&)>& visit);

}  // namespace meshhier::importing
