// Turns `placement` into the transform of the tileset's root.
#pragma once

#include "base/bounds.h"
#include "config/config.h"
#include "geodesy/map_projection.h"
#include "geodesy/map_transform.h"
#include "hierarchy/frame.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::config {

/// PROJ's memory for a model with a crs: 14 to 15.4 MiB were measured, with a grid and without, 7
/// of them for its libraries.
inline constexpr std::uint64_t kMapMemoryBytes = std::uint64_t{18} << 20;

/// Returns the config with the crs and offset of the file `placement.metadata`, which all below
/// need; those that the config says itself win. Looks whether PROJ knows the crs. Throws
/// Error(usage), and Error(io) if a file or PROJ's database cannot be read.
Config with_map(storage::FileSystem& files, Config config);

/// Returns the config, which has no place, with that of the files that lie with its input; each
/// says what those before it do not. `maps`: one at least. Throws as with_map().
Config with_maps(storage::FileSystem& files, Config config,
                 const std::vector<std::filesystem::path>& maps);

/// Places a model with a crs, whose projection is given. `bounds`: the input's.
geodesy::MappedModel mapped_model(const Config& config, const BoundsD& bounds,
                                  const geodesy::MapProjection& projection);

/// Returns the transform of the tileset's root, if it needs one. `bounds`: the input's. Throws
/// Error(usage) if the model has no place on the globe.
std::optional<Transform> tileset_transform(const Config& config, const BoundsD& bounds);

/// Whether `transform` is within metres of the one that PROJ finds for a model with a crs. The last
/// bits are those of one version of PROJ, and other versions have other changes of datum, which are
/// some metres apart. True if this PROJ cannot tell.
bool fits_map(const Config& config, const BoundsD& bounds, const Transform& transform);

/// Returns lines for people on a model with a place: where it stands, and how large it is there or
/// how exactly; else "". `transform`: tileset_transform().
std::string placement_text(const Config& config, const BoundsD& bounds, const Transform& transform);

}  // namespace meshhier::config
