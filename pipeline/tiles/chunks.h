// The chunks of a mesh while it is distributed to them, and until they are taken.
#pragma once

#include "base/error.h"
#include "hierarchy/tree.h"
#include "partition/bucketed.h"
#include "partition/chunk.h"
#include "pipeline/tiles/joined_spool.h"
#include "pipeline/tiles/row_spool.h"
#include "storage/io/spool.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// A triangle with all corners in one chunk: their places in it, 21 bits each, the first corner's
/// lowest.
class PackedTriangle {
 public:
  PackedTriangle() = default;
  PackedTriangle(const partition::RankTriangle& t, std::uint32_t first_rank)
      : bits_((t[0] - first_rank) | std::uint64_t{t[1] - first_rank} << kBits |
              std::uint64_t{t[2] - first_rank} << 2 * kBits) {}

  partition::RankTriangle ranks(std::uint32_t first_rank) const {
    const auto corner = [&](int i) {
      return first_rank + static_cast<std::uint32_t>(bits_ >> i * kBits & kMask);
    };
    return {corner(0), corner(1), corner(2)};
  }

 private:
  static constexpr int kBits = 21;
  static constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
  std::uint64_t bits_ = 0;
};

/// The first vertices of places, a block of them, sorted by chunk; keeps its memory from block to
/// block.
struct ChunkedVertices {
  std::vector<std::uint32_t> chunk_of;  ///< per vertex; filled before sort()
  std::vector<std::uint32_t> starts;    ///< per chunk: its first row; one entry more than chunks
  std::vector<float> rows;              ///< per vertex its position and attributes
  /// Per chunk: the rank of its first row; by Ranker.
  std::vector<std::uint32_t> first_ranks;

  void sort(std::uint32_t chunk_count, std::span<const Vec3f> positions,
            std::span<const float> attributes);

 private:
  std::vector<std::uint32_t> next_;
};

/// A triangle with a corner that is not the first vertex of its place.
struct WedgedTriangle {
  partition::RankTriangle ranks;
  CornerWedges wedges;
};
static_assert(sizeof(WedgedTriangle) == 24);

/// Counts triangles with corners in three chunks: [k] of them have their corners in three nodes up
/// to k levels above.
using WideCounts = std::array<std::uint64_t, 32>;

/// A block of triangles sorted by chunk; keeps its memory from block to block.
struct ChunkedTriangles {
  std::vector<std::uint32_t> starts;  ///< per chunk: its first in `inner`; one entry more
  std::vector<PackedTriangle> inner;  ///< all corners in one chunk
  /// The others, once for each chunk they touch.
  partition::Bucketed<partition::RankTriangle> shared;
  partition::Bucketed<WedgedTriangle> wedged;  ///< likewise, by sort_wedged()
  WideCounts wide{};

  void sort(std::span<const partition::RankTriangle> triangles, const partition::ChunkMap& map);
  /// Sorts triangles that name copies; to be called after sort().
  void sort_wedged(std::span<const WedgedTriangle> triangles, const partition::ChunkMap& map);

 private:
  static constexpr std::uint32_t kShared = ~0u;
  std::vector<std::uint32_t> chunk_of_;  ///< per triangle
  std::vector<std::uint32_t> next_;
};

/// Returns the most chunks of a mesh with so many places: each has more than half of
/// partition::kChunkVertices.
std::uint64_t most_chunks(std::uint64_t place_count);

/// Memory that the spools of all chunks take while they are written: their open blocks, and the
/// index of all blocks.
struct ChunkSpools {
  // Open blocks weigh against the index, and both are least together at about 4 KiB, whatever the
  // size of the mesh.
  static constexpr std::uint64_t kLeastBlock = 4096;
  static constexpr std::uint64_t kMostBlock = 262144;
  /// One part in so many of a stage's memory is for the open blocks.
  static constexpr std::uint64_t kWorkParts = 8;

  std::uint64_t count = 0;  ///< spools
  std::uint64_t spooled_bytes = 0;

  /// Returns the spools for a mesh. `vertex_bytes`: a position and its attributes. `wedged`: the
  /// number of faces that name copies.
  static ChunkSpools of(std::uint64_t place_count, std::uint64_t copy_count,
                        std::uint32_t vertex_bytes, std::uint64_t face_count, std::uint64_t wedged);

  /// Returns the size of a block for a stage that may hold `work_bytes`.
  std::size_t block_bytes(std::uint64_t work_bytes) const;
  std::uint64_t index_bytes(std::uint64_t block) const;
  std::uint64_t bytes(std::uint64_t block) const { return count * block + index_bytes(block); }
};

/// All chunks of a mesh, spooled. Failures of the scratch file throw Error(io). `scratch` must
/// outlive it.
class Chunks {
 public:
  /// The number of spools that a chunk has: vertices, inner and shared triangles; with copies,
  /// these and the triangles that name them.
  static constexpr int kSpools = 3, kCopySpools = 2;

  /// Returns the bytes of the spooled triangles; chunks share those along their borders.
  /// `boundary_share`: the part of a chunk's vertices that is its boundary, times the root of their
  /// number.
  static double expected_triangle_bytes(std::uint64_t place_count, std::uint64_t face_count,
                                        std::uint64_t wedged, double boundary_share);

  Chunks(const Tree& tree, int channels, bool has_copies, storage::ScratchFile& scratch,
         std::size_t block_bytes);

  Level level() const { return level_; }
  const partition::ChunkMap& map() const { return map_; }
  std::uint32_t count() const { return map_.count(); }
  bool has_copies() const { return !copies_.empty(); }
  /// The count of numbers that a vertex has: its position and attributes.
  std::size_t row_width() const { return 3 + static_cast<std::size_t>(channels_); }

  /// These append blocks, in any order, once they are ranked. Thread-safe. As threads append in any
  /// order, nothing may depend on the order of triangles in take().
  void append(const ChunkedVertices& block);
  void append(const ChunkedTriangles& block);
  /// Appends a copy of the place that has this provisional rank, after all copies before it. `row`:
  /// its position and attributes, row_width() numbers.
  void append_copy(std::uint32_t rank, std::span<const float> row);

  /// Reads a chunk and forgets it. Thread-safe for different chunks.
  partition::ChunkMesh take(std::uint32_t chunk);
  /// Whether something of the chunk is there.
  bool has(std::uint32_t chunk) const;
  /// Whether all vertices of the chunk are there.
  bool is_whole(std::uint32_t chunk) const { return place_count(chunk) == map_.size(chunk); }
  /// Puts on disk what was appended here of a chunk, and returns where it is, for the journal.
  /// Nothing can be appended any more. Thread-safe for different chunks.
  nlohmann::json store(std::uint32_t chunk);
  /// Takes that, behind what is there of the chunk. Returns false if it contradicts itself. Throws
  /// nlohmann::json::exception if `stored` is nothing of the kind.
  bool restore(std::uint32_t chunk, const nlohmann::json& stored);
  /// Does the same, but takes the copies alone.
  bool restore_copies(std::uint32_t chunk, const nlohmann::json& stored);
  /// Whether all vertices of a restored chunk are there, and the scratch file holds it as it was;
  /// reads it all.
  bool is_as_stored(std::uint32_t chunk) const;
  /// Returns ScratchFile::changed() for a file that does not hold a restored chunk as it was
  /// stored; nothing if all is as it was. Reads it all.
  std::optional<Error> find_change(std::uint32_t chunk) const;
  /// Forgets a chunk that is not needed.
  void drop(std::uint32_t chunk);

  std::uint64_t triangle_count(std::uint32_t chunk) const {
    return inner_[chunk].size() + shared_[chunk].size() +
           (has_copies() ? wedged_[chunk].size() : 0);
  }
  /// Returns the bytes that a chunk's triangles take in memory.
  std::uint64_t triangle_bytes(std::uint32_t chunk) const;

  std::uint64_t copy_count(std::uint32_t chunk) const;
  /// Returns the bytes that a chunk's copies take in memory.
  std::uint64_t copy_bytes(std::uint32_t chunk) const;

  /// Returns the number of the chunk's places whose first vertices are there.
  std::uint64_t place_count(std::uint32_t chunk) const { return vertices_[chunk].size(); }

  /// Counts all triangles that were appended; add_wide() takes those of other processes.
  const WideCounts& wide() const { return wide_; }
  void add_wide(const WideCounts& wide);
  /// Returns the number of appended triangles whose corners are in three nodes of `level`, not
  /// below the chunks'. As vertices join within nodes only, none of them degenerates on that level
  /// or below.
  std::uint64_t wide_triangles(Level level) const;

 private:
  void read_vertices(std::uint32_t chunk, VertexArray& vertices) const;
  Copies read_copies(std::uint32_t chunk) const;

  Level level_;
  partition::ChunkMap map_;
  int channels_;
  std::vector<RowSpool> vertices_;
  std::vector<JoinedSpool<PackedTriangle>> inner_;
  std::vector<JoinedSpool<partition::RankTriangle>> shared_;
  std::vector<JoinedSpool<float>> copies_;  ///< rank in the chunk as bits, then as vertices
  std::vector<JoinedSpool<WedgedTriangle>> wedged_;
  WideCounts wide_{};
  std::vector<std::mutex> locks_;  ///< per chunk, for those who append
  std::mutex wide_lock_;
};

/// Gives the places' first vertices their ranks, block by block in the order of ids.
class Ranker {
 public:
  explicit Ranker(const partition::ChunkMap& map) : next_(map.count()) {
    for (std::uint32_t c = 0; c < map.count(); ++c)
      next_[c] = map.first_rank(c);
  }

  /// Returns the ranks of a block's vertices in `ranks`, and says in the block where its rows go.
  template <class Rank>
  void rank(ChunkedVertices& block, std::vector<Rank>& ranks) {
    block.first_ranks = next_;
    ranks.clear();
    for (const std::uint32_t chunk : block.chunk_of) {
      const std::uint32_t rank = next_[chunk]++;
      if constexpr (std::is_integral_v<Rank>)
        ranks.push_back(rank);
      else
        ranks.push_back({rank, 0});
    }
  }

 private:
  std::vector<std::uint32_t> next_;
};

}  // namespace meshhier::pipeline
