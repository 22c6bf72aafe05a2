// A file in a zip archive, stored as it is or packed by Deflate or Zstandard, as a file for
// reading.
//
// Problem. Readers ask for any range. What is packed can be unpacked from its beginning alone, and
// unpacked whole it takes memory that no budget counts.
//
// Idea. Unpack forwards in blocks and keep the last one; a read before it begins anew:
//
//   unpacked  |- - - - - - -|#########|             |       #: the block in memory
//                           ^ from here on reads go on
//
// Invariant. Who reads up to the end has the CRC-32 of all checked.
//
// Cost. 64 KiB, and the window: 32 KiB of Deflate, up to 8 MiB of Zstandard. A read backwards
// unpacks again from the beginning, so readers of much take it in order; a file of up to 16 MiB is
// one block from then on.
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace meshhier::storage {

enum class ZipMethod : std::uint16_t { stored = 0, deflated = 8, zstandard = 93 };

/// The place of a file's content in its archive.
struct ZipRange {
  ZipMethod method{};
  std::uint64_t begin = 0, packed = 0;  ///< in the archive, which has them
  std::uint64_t bytes = 0;              ///< unpacked; as many as `packed` if it is stored
  std::uint32_t crc = 0;                ///< of what is packed; else it is not looked at
};

/// Opens it under a path. Thread-safe, as File is. Reading throws Error(input) if the content is
/// damaged, or wants a larger window; Error(io).
std::unique_ptr<File> open_zip_content(std::filesystem::path path,
                                       std::shared_ptr<const File> archive, const ZipRange& range);

}  // namespace meshhier::storage
