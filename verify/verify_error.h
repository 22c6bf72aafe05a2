// Measures how far the surfaces of a hierarchy are from the original one, and compares that with
// the bounds that the hierarchy promises.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/ids.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::verifying {

/// Selects every level of simplified tiles.
struct AllLevels {};

struct ErrorOptions {
  /// The cuts to be measured: a level (Cut::of_level); all; the cut in a text file (parse_nodes()).
  std::variant<Level, AllLevels, std::filesystem::path> selection = Level{};
  std::uint64_t samples = 400'000;         ///< in each direction, >= 1; Metro figures use so many
  std::uint64_t memory_budget = 1U << 30;  ///< bytes
};

/// Distances from one surface to another, input units. All 0 if nothing could be measured.
struct DistanceSummary {
  double mean = 0;
  double rms = 0;
  double max = 0;
};

/// The ratio bound / measured maximum over the tiles of a cut: 1 would be a perfect bound.
struct BoundRatio {
  double median = 0;
  double p95 = 0;
};

/// One cut, measured.
struct ErrorMeasurement {
  std::optional<Level> level;  ///< none: a cut from a file
  std::string name;            ///< "level 3"
  std::uint64_t tiles = 0;
  std::uint64_t triangles = 0;  ///< triangles that the cut draws
  std::uint64_t flat = 0;       ///< triangles without area: edges or points of the surface
  double diagonal = 0;          ///< diagonal of the source's bounds, input units
  std::uint64_t samples = 0;    ///< samples that were asked for, in each direction
  DistanceSummary forward;      ///< from the original surface to the cut's
  DistanceSummary backward;     ///< from the cut's surface to the original
  double error = 0;             ///< the mean over the samples of their tiles' errors, input units
  double bound = 0;             ///< the largest bound of the tiles shown, input units
  std::optional<BoundRatio> ratio;    ///< none if no tile is off by more than rounding
  std::vector<std::string> problems;  ///< empty: bounds and errors hold
};

/// Measures the Hausdorff-like distances of Metro (Cignoni, Rocchini & Scopigno 1998) between the
/// cut's surface and that of all partitions: from area-uniform samples of one to the nearest point
/// of the other, both ways. Distances are exact for each sample (to double rounding); places
/// between samples are not seen, so maxima are from below. Triangles without area have no samples,
/// but are part of the surface that is measured to.
///
/// A sample belongs to the tile of the cut that shows it: for the original surface the tile above
/// the partition, for the cut's surface the tile that draws it; on a border triangle, whose corners
/// several tiles have, to the one of them with the largest bound. A tile whose samples are off by
/// more than its bound, in either direction, is a problem; so is a cut that is off on average by
/// more than twice its tiles' errors, and by more than a 64th of the largest bound.
///
/// Deterministic to the bit for any threads and budget. Memory stays about `memory_budget`. Throws
/// Error(usage) if the selection is not in the tree or the file is no cut, Error(io | corrupt) if a
/// file cannot be read or is damaged, Error(interrupted).
std::vector<ErrorMeasurement> measure_errors(storage::FileSystem& files,
                                             const std::filesystem::path& directory,
                                             const ErrorOptions& options,
                                             execution::Progress& progress,
                                             const execution::CancelToken& cancel);

/// Returns a table for people.
std::string to_text(const ErrorMeasurement& measurement);

/// Returns an object for scripts: level, name, tiles, triangles, flat_triangles, diagonal, samples,
/// forward and backward with mean, rms, max; error; bound; ratio with median, p95; problems.
/// Lengths in input units; level is null for a cut from a file, ratio if there is none.
nlohmann::ordered_json to_json(const ErrorMeasurement& measurement);

}  // namespace meshhier::verifying
