// Mesh files as a whole in memory, so that each is opened, read and unpacked once: for its mesh and
// for its checksum.
//
// Files beyond their share of memory are read where they lie, a range at a time, and once more for
// the checksum. Waiting for room here and then for room to decode cannot end in a circle: nobody
// waits here who decodes.
#pragma once

#include "execution/cancel.h"
#include "execution/memory_gate.h"
#include "import/input_files.h"
#include "storage/io/file.h"

#include <cstdint>
#include <memory>
#include <optional>

namespace meshhier::importing {

/// The content of a file.
struct ReadContent {
  std::shared_ptr<const void> memory{};         ///< room that it takes as long as this is there
  std::shared_ptr<const storage::File> file{};  ///< it, in memory or where it lies
  std::optional<std::uint64_t> checksum{};      ///< storage::FileChecksum, if all was read
};

/// Thread-safe.
class ContentReader {
 public:
  /// `memory_bytes`: for all files that are read at once.
  ContentReader(storage::FileSystem& files, std::uint64_t memory_bytes,
                const execution::CancelToken& cancel)
      : files_(files), most_(memory_bytes), cancel_(cancel), room_(memory_bytes) {}

  /// Waits until there is room. Throws Error(io), Error(interrupted), Error(input) if the file is
  /// packed and damaged.
  ReadContent read(const InputFileFacts& facts);

 private:
  storage::FileSystem& files_;
  std::uint64_t most_;
  const execution::CancelToken& cancel_;
  execution::MemoryGate room_;
};

}  // namespace meshhier::importing
