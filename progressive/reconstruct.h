// Rebuilds a mesh from a progressive stream, as a client does.
#pragma once

#include "execution/cancel.h"
#include "execution/progress.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::progressive {

struct ReconstructOptions {
  std::optional<std::uint32_t> details{};  ///< number of those applied, in order; not set: all
  std::filesystem::path output;            ///< PLY; a file or a stream (storage::OutputFile)
  std::uint64_t memory_budget = 1U << 30;  ///< bytes; the two arrays must fit
  bool replace = false;                    ///< a file that is there
};

/// A step of the reconstruction, by one file.
struct ReconstructedStep {
  std::string file;
  std::uint64_t bytes = 0;
  std::uint64_t vertices = 0;   ///< the mesh's with this file
  std::uint64_t triangles = 0;  ///< likewise
  std::uint64_t entries = 0;    ///< in its three lists
  double seconds = 0;           ///< to read it, and to put it in its places
};

struct ReconstructReport {
  std::vector<ReconstructedStep> steps;  ///< the base first
  std::uint64_t array_bytes = 0;         ///< size of the two arrays
  std::string summary;                   ///< a line for people
};

/// Reads the index, the base and the details (files behind those are not looked at), and writes the
/// mesh they show as a PLY: vertices in the order of the original, each once. The output appears
/// complete or not at all. Memory is the two arrays, one file and a run of it. Throws Error(usage)
/// if there are not so many details, Error(io | corrupt) naming the file that is missing or
/// damaged, Error(budget) if the arrays do not fit.
ReconstructReport reconstruct(storage::FileSystem& files, const std::filesystem::path& stream,
                              const ReconstructOptions& options, execution::Progress& progress,
                              const execution::CancelToken& cancel);

}  // namespace meshhier::progressive
