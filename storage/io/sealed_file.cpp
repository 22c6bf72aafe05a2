#include "storage/io/sealed_file.h"

#include "base/error.h"
#include "storage/io/hash.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::storage {

std::vector<std::byte> read_sealed(FileSystem& files, const std::filesystem::path& path,
                                   const Seal& seal, std::uint64_t limit_bytes) {
  std::vector<std::byte> bytes = read_file(files, path, std::min(seal.bytes, limit_bytes));
  if (bytes.size() != seal.bytes) {
    throw Error(ErrorCode::corrupt, fmt::format("{}: has {} bytes, expected {}: the file is cut",
                                                path.string(), bytes.size(), seal.bytes));
  }
  const std::uint64_t found = checksum(bytes);
  if (found != seal.checksum) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: checksum is {:016x}, expected {:016x}: the file is damaged",
                            path.string(), found, seal.checksum));
  }
  return bytes;
}

}  // namespace meshhier::storage
