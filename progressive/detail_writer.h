// One file of a progressive stream, from the lists of the levels it spans.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "progressive/foreign_corners.h"
#include "progressive/level_lists.h"
#include "progressive/stream_index.h"
#include "progressive/traced_tile.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace meshhier::progressive {

/// The levels that a file leads from and to.
struct DetailSpan {
  std::uint32_t step = 0;       ///< 0: the base
  std::optional<Level> coarse;  ///< none: from nothing
  Level fine{};
};

/// The sources of a file. At a level the client knows the vertices of the level, and those that
/// stand for others; it hears of a vertex that is neither with the next file.
struct DetailSource {
  const std::vector<LevelLists>& lists;  ///< by level
  const progressive::Sector& sector;
  const AttributeLayout& layout;
  const ForeignCorners& all_foreign;     ///< the last level's: they number the foreign vertices
  const ForeignCorners& coarse_foreign;  ///< empty for the base
  const ForeignCorners& fine_foreign;
  std::size_t runs_in_flight = 1;
};

/// Writes the file and returns its line of the index, in which `shown_*` are left 0. Lists of
/// several levels are merged as they are read: memory for a few runs a thread. Deterministic.
/// Throws Error(io | interrupted).
progressive::ProgressiveFile write_detail(storage::FileSystem& files,
                                          const std::filesystem::path& path, const DetailSpan& span,
                                          const DetailSource& source, execution::Progress& progress,
                                          const execution::CancelToken& cancel);

}  // namespace meshhier::progressive
