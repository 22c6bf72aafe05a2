// EXT_meshopt_compression (Khronos, ratified 2021): buffer views as streams of meshoptimizer.
#pragma once

#include "mesh_io/gltf_document.h"

#include <cstddef>
#include <span>
#include <string>

namespace meshhier::mesh_io {

/// Returns what is wrong with the numbers of a compressed view; empty if nothing is. One fault is
/// that it has more elements than a stream of so many bytes can hold.
std::string meshopt_fault(const GltfMeshopt& view);

/// Decodes `stream` into count * stride bytes and undoes the filter; returns false if it is no such
/// stream. Requires a view without fault.
bool decode_meshopt(const GltfMeshopt& view, std::span<const std::byte> stream,
                    std::span<std::byte> plain);

}  // namespace meshhier::mesh_io
