// OSGB tiles as glTF files, one by one.
#pragma once

#include "hierarchy/published.h"
#include "import/input_record.h"
#include "mesh_io/gltf_file.h"
#include "mesh_io/gltf_transform.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace meshhier::importing {

struct OsgbImport {
  CompanionFiles tiles{};  ///< finer files that were read, and places of missing ones
  std::vector<SourceCount> counts{};
  std::vector<std::string> warnings{};
};

/// Calls `add` with the glTF of each file that has triangles, and its place: of the tile `path`,
/// and of the finer ones that it names. Pictures lie in the OSGB files. `room`: its content and
/// place are not asked. Calls `advance` with the bytes of each file. Throws as mesh_io::OsgbTiles.
OsgbImport import_osgb(
    const std::filesystem::path& path, const mesh_io::GltfRoom& room,
    const std::function<void(mesh_io::GltfFile&, const mesh_io::GltfTransform&)>& add,
    const std::function<void(std::uint64_t)>& advance);

}  // namespace meshhier::importing
