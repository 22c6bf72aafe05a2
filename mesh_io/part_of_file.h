// What lies within a file as a file of its own: the glTF that a tile of 3D Tiles holds, or what is
// packed by gzip. To be read only.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace meshhier::mesh_io {

/// `bytes` of `file` from `offset` on, which it must have; it has the path of `file`.
std::unique_ptr<storage::File> part_of(std::shared_ptr<const storage::File> file,
                                       std::uint64_t offset, std::uint64_t bytes);

/// Bytes in memory under a path.
std::unique_ptr<storage::File> file_of_bytes(std::filesystem::path path,
                                             std::shared_ptr<const std::vector<std::byte>> bytes);

/// What a file in gzip holds, under its path, for reading a little: it is unpacked once for its
/// size, and again from its beginning whenever bytes behind the first MiB are read. `file` must
/// outlive it. Throws Error(input) if it is damaged, Error(io).
std::unique_ptr<storage::File> unpacked(const storage::File& file);

}  // namespace meshhier::mesh_io
