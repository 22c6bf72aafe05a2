// progressive.json: the source of a progressive stream, and its files (docs/file_format.md).
#pragma once

#include "hierarchy/frame.h"
#include "hierarchy/published.h"
#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace meshhier::progressive {

/// One file; the base first.
struct ProgressiveFile {
  Level level{};                     ///< with this file the stream shows the hierarchy's mesh of it
  std::uint64_t vertices = 0;        ///< entries of list 1
  std::uint64_t triangles = 0;       ///< entries of list 2
  std::uint64_t merges = 0;          ///< entries of list 3
  std::uint64_t shown_vertices = 0;  ///< the mesh's with this file and all before
  std::uint64_t shown_triangles = 0;  ///< likewise
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64 of the file
};

struct ProgressiveIndex {
  std::string generator;           ///< "meshhier 0.1.0"
  SourceSummary source;            ///< the hierarchy's
  NodeId node;                     ///< the part of it that is streamed: the root, or a sector
  std::uint64_t vertices = 0;      ///< slots, 1 .. 2^32 - 1
  std::uint64_t own_vertices = 0;  ///< the node's; the others are its neighbours'
  std::uint64_t triangles = 0;
  Vec3d origin;  ///< add to every position
  UpAxis up = UpAxis::y;
  std::string licence;
  std::vector<ProgressiveFile> files;  ///< at least the base
};

/// Returns the file's text, which ends with a checksum of itself. Deterministic.
std::string to_json_text(const ProgressiveIndex& index);

/// Parses a text that nobody vouches for. Throws Error(corrupt) that starts with `name`.
ProgressiveIndex parse_progressive_index(const std::string& text, const std::string& name);

/// Reads the index of the stream in `directory`. Throws Error(io | corrupt).
ProgressiveIndex read_progressive_index(storage::FileSystem& files,
                                        const std::filesystem::path& directory);

/// Reads the file of `step`. Throws Error(io) if it is missing, Error(corrupt) if it is not the one
/// that the index tells of; the message names it.
std::vector<std::byte> read_detail_file(storage::FileSystem& files,
                                        const std::filesystem::path& directory,
                                        const ProgressiveIndex& index, std::uint32_t step);

}  // namespace meshhier::progressive
