// Extensions that a glTF file may require.
#pragma once

#include <span>
#include <string_view>

namespace meshhier::mesh_io {

struct GltfExtension {
  std::string_view name;  ///< one that ends in "_" stands for all that begin so
  std::string_view reason;
};

/// Returns the extensions that are read; a reason says what each is.
std::span<const GltfExtension> read_extensions();
/// Returns the extensions that are passed over, as they change nothing of the triangles, their
/// places, colours and pictures; a reason says what each changes.
std::span<const GltfExtension> harmless_extensions();

/// Says how a file of glTF 1.0 becomes one of 2.0.
inline constexpr std::string_view kUpgradeGltf =
    "convert the file to glTF 2.0 (`npx gltf-pipeline -i OLD.glb -o NEW.glb`), or all of a tileset "
    "by `npx 3d-tiles-tools upgrade --targetVersion 1.1 -i tileset.json -o FOLDER/tileset.json`";

/// Returns whether an extension is one of these. A file that requires another one may mean
/// something else than what would be read of it.
bool may_be_required(std::string_view extension);

}  // namespace meshhier::mesh_io
