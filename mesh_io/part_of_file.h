// A range of a file as a file of its own: the glTF that a tile of 3D Tiles holds.
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <memory>

namespace meshhier::mesh_io {

/// `bytes` of `file` from `offset` on, which it must have; it has the path of `file`. To be read
/// only.
std::unique_ptr<storage::File> part_of(std::shared_ptr<const storage::File> file,
                                       std::uint64_t offset, std::uint64_t bytes);

}  // namespace meshhier::mesh_io
