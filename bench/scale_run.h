// Meshes of growing size, built in many ways by the real program, and measured.
#pragma once

#include "bench/scale_tables.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::bench {

struct ScaleOptions {
  std::filesystem::path meshhier;  ///< the programs
  std::filesystem::path meshgen;
  std::filesystem::path base;          ///< a PLY file that is amplified; empty: a torus is made
  std::filesystem::path work;          ///< an existing directory; all that is written goes below it
  std::uint64_t smallest = 800'000;    ///< triangles; sizes grow by 4
  std::uint64_t largest = 15'000'000;  ///< triangles
  std::uint64_t largest_shuffled = 60'000'000;
  std::uint64_t usual_largest = 15'000'000;  ///< threads and methods are compared at no larger size
  std::vector<unsigned> threads{1, 2};       ///< the last is the usual number
  std::vector<std::uint64_t> budgets;        ///< bytes; the first is the usual budget
  std::vector<std::string> methods{"edge_collapse", "cluster"};  ///< the first is the usual one
  unsigned repeat = 1;  ///< builds of each setting; the fastest counts
};

/// Says what goes on, a line at a time.
using Tell = std::function<void(std::string_view)>;

/// Runs everything; removes all it wrote, whatever happens. A size for which the disk is too small
/// is left out, with a line. Throws Error(input) if a program fails for another reason,
/// Error(interrupted) after Ctrl-C. This process stays small: children would be counted with it.
ScaleReport run_scale(storage::FileSystem& files, const ScaleOptions& options, const Tell& tell);

/// How much faster `threads` threads do `threads` times the work than one does it alone: the most
/// that a build could gain.
double compute_gain(unsigned threads);

/// Seconds to read `from` and to write as many bytes as `output_bytes` to `to`, synced: what moving
/// the data alone takes. `to` is removed.
double copy_seconds(storage::FileSystem& files, const std::filesystem::path& from,
                    std::uint64_t output_bytes, const std::filesystem::path& to);

}  // namespace meshhier::bench
