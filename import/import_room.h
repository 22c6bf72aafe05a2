// The means that an import works with.
#pragma once

#include "execution/cancel.h"
#include "storage/io/spool.h"

#include <cstddef>
#include <cstdint>

namespace meshhier::importing {

/// Blocks of the import's spools: large writes, but small beside the least budget.
inline constexpr std::size_t kImportSpoolBytes = std::size_t{1} << 18;

struct ImportRoom {
  storage::ScratchFile& scratch;
  std::uint64_t sort_bytes = 0;  ///< memory of each of two sorts, or of a table
  const execution::CancelToken& cancel;
};

}  // namespace meshhier::importing
