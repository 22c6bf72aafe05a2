// The ways to pack tiles, a row each. None loses anything.
#pragma once

#include "base/named_value.h"
#include "storage/format/gzip.h"

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

enum class Compression { none, zlib, meshopt, meshopt_zlib };

struct CompressionRow {
  Compression value;
  std::string_view name;  ///< in configs and manifests
  bool packs_sections;    ///< the file uses EXT_meshopt_compression
  /// Packs the file as a whole; null: it stays as it is.
  std::vector<std::byte> (*pack_file)(std::span<const std::byte> glb);
  /// Unpacks bytes that nobody vouches for. Throws Error(corrupt) that starts with `name`.
  std::vector<std::byte> (*unpack_file)(std::span<const std::byte> bytes, const std::string& name);
  /// Bytes of tiles as a part of those of plain ones: the most that was seen with exact scans of
  /// more than 20,000 vertices (docs/performance.md). Quantized ones take less.
  double expected_ratio;
};

/// Packs a GLB; gunzip_glb() unpacks it.
inline std::vector<std::byte> gzip_glb(std::span<const std::byte> glb) {
  return gzip(glb);
}

inline constexpr auto kCompressions = std::to_array<CompressionRow>({
    {Compression::none, "none", false, nullptr, nullptr, 1},
    {Compression::zlib, "zlib", false, gzip_glb, gunzip_glb, 0.79},
    {Compression::meshopt, "meshopt", true, nullptr, nullptr, 0.66},
    {Compression::meshopt_zlib, "meshopt_zlib", true, gzip_glb, gunzip_glb, 0.56},
});
static_assert(are_in_order(kCompressions, &CompressionRow::value));

constexpr const CompressionRow& row_of(Compression compression) {
  return kCompressions[static_cast<std::size_t>(compression)];
}

}  // namespace meshhier::storage
