// Asks a hierarchy about many points and rays: what is nearest, what is hit first.
//
// Problem. Neither the hierarchy nor the points need fit into memory, and come in any order.
//
// Idea. Rows are sorted along a curve through space, looked up batch by batch, and their answers
// are sorted back. Both sorts are external. A batch is a small place, so that it asks few tiles,
// and mostly those of the batch before:
//
//      rows  -->  by place  -->  batch: compare/surface_distance, surface_rays  -->  by row  -->
//      file
//
// Invariant. An answer depends on its row and the surface alone, to the bit: ties are decided by
// the order of tiles and triangles.
//
// Cost. O(log n) a row and tile asked; 32 to 56 bytes of scratch for each row, and 96 for each
// answer, where they exceed the memory.
#pragma once

#include "compare/selected_surface.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "query/answers.h"
#include "query/row_source.h"
#include "storage/io/file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace meshhier::querying {

struct QueryOptions {
  RowKind kind{};
  std::filesystem::path rows{};  ///< read_rows() reads it
  comparing::SurfaceSelection selection{};
  exporting::RegionRequest piece{};  ///< only triangles that touch it; files of it as of `rows`
  bool has_sides = false;            ///< of points: distances are below 0 inside
  std::filesystem::path output{};
  AnswerFormat format{};
  bool replace = false;                    ///< an output that is there
  std::uint64_t memory_budget = 1U << 30;  ///< bytes
};

/// What is told of all answers together.
struct QuerySummary {
  RowKind kind{};
  std::string name;            ///< the hierarchy's
  std::string index_checksum;  ///< names the tiles that were asked, 16 hexadecimal digits
  std::uint64_t rows = 0;
  std::uint64_t not_asked = 0;           ///< rows that are no point, or no ray
  std::uint64_t hits = 0;                ///< of rays
  std::uint64_t unknown_sides = 0;       ///< points whose side was asked for and cannot be told
  std::optional<double> least, largest;  ///< distances, of rays those to hits; none: there is none
  double error_bound = 0;  ///< the original surface is nowhere farther from the asked one,
                           ///< nor this one from that
  std::uint64_t tiles = 0, tiles_read = 0;  ///< those with a part of the asked surface
};

/// Asks the hierarchy at `path` in `place`, and writes the answers to options.output, in the order
/// of the rows; the output and its scratch lie in `files`. Throws Error(usage) for a level that is
/// not there, a surface or a piece without triangles, an output that would replace what is read;
/// Error(exists); Error(input) as read_rows() and region_of(); Error(io | corrupt | interrupted).
QuerySummary run_query(storage::FileSystem& place, const std::filesystem::path& path,
                       storage::FileSystem& files, const QueryOptions& options,
                       execution::Progress& progress, const execution::CancelToken& cancel);

/// Tell it in words, and for programs.
std::string query_text(const QuerySummary& summary);
nlohmann::ordered_json query_json(const QuerySummary& summary);

}  // namespace meshhier::querying
