// A file whose size and checksum stand in another file.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace meshhier::storage {

/// The size and checksum that a file must have.
struct Seal {
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64
};

/// Returns the whole file. `limit_bytes`: more than any such file has, so that a wrong seal
/// allocates no more. Throws Error(io), or Error(corrupt) if it is not the file that was sealed.
std::vector<std::byte> read_sealed(FileSystem& files, const std::filesystem::path& path,
                                   const Seal& seal, std::uint64_t limit_bytes);

}  // namespace meshhier::storage
