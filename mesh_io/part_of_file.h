// A part of a file as a file of its own: the glTF that a tile of 3D Tiles holds, or the content of
// gzip. Such files can only be read.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace meshhier::mesh_io {

/// Returns `bytes` of `file` from `offset` on, which it must have; under the path of `file`.
std::unique_ptr<storage::File> part_of(std::shared_ptr<const storage::File> file,
                                       std::uint64_t offset, std::uint64_t bytes);

/// Returns bytes in memory as a file under a path.
std::unique_ptr<storage::File> file_of_bytes(std::filesystem::path path,
                                             std::shared_ptr<const std::vector<std::byte>> bytes);

/// Returns the content of a file in gzip, under its path, for reading a little: it is unpacked once
/// for its size, and again from its beginning whenever bytes behind the first MiB are read. `file`
/// must outlive it. Throws Error(input) if it is damaged, Error(io).
std::unique_ptr<storage::File> unpacked(const storage::File& file);

}  // namespace meshhier::mesh_io
