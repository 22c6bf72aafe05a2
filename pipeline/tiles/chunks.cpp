#include "pipeline/tiles/chunks.h"

#include "hierarchy/power_of_two.h"
#include "partition/top_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace meshhier::pipeline {
namespace {

using partition::RankTriangle;

/// Counts of items, entry i + 1 for item i, become the places where they start, and where the next
/// of each goes.
void counts_to_starts(std::vector<std::uint32_t>& counts, std::vector<std::uint32_t>& next) {
  for (std::size_t i = 1; i < counts.size(); ++i)
    counts[i] += counts[i - 1];
  next.assign(counts.begin(), counts.end() - 1);
}

/// The chunk of a rank, mostly that of the rank before.
class ChunkFinder {
 public:
  explicit ChunkFinder(const partition::ChunkMap& map) : map_(map), size_(map.size(0)) {}

  std::uint32_t chunk_of(std::uint32_t rank) {
    if (rank - first_ >= size_) {
      chunk_ = map_.chunk_of(rank);
      first_ = map_.first_rank(chunk_);
      size_ = map_.size(chunk_);
    }
    return chunk_;
  }

 private:
  const partition::ChunkMap& map_;
  std::uint32_t chunk_ = 0, first_ = 0, size_;
};

/// How many levels above these three nodes of one level their ancestors still are three.
int levels_apart(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return std::min({std::bit_width(a ^ b), std::bit_width(b ^ c), std::bit_width(a ^ c)}) - 1;
}

template <class Record>
nlohmann::json store(storage::RecordSpool<Record>& spool) {
  const storage::StoredSpool stored = spool.store();
  return {stored.bytes, stored.checksum, stored.block_bytes, stored.blocks};
}

template <class Record>
bool restore(storage::RecordSpool<Record>& spool, const nlohmann::json& stored) {
  return spool.restore({stored.at(0), stored.at(1), stored.at(2), stored.at(3)});
}

}  // namespace

void ChunkedVertices::sort(std::uint32_t chunk_count, std::span<const Vec3f> positions,
                           std::span<const float> attributes) {
  const std::size_t count = positions.size();
  starts.assign(chunk_count + 1, 0);
  for (std::size_t i = 0; i < count; ++i)
    ++starts[chunk_of[i] + 1];
  counts_to_starts(starts, next_);
  const std::size_t channels = attributes.size() / std::max<std::size_t>(count, 1);
  const std::size_t width = 3 + channels;
  rows.resize(count * width);
  for (std::size_t i = 0; i < count; ++i) {
    float* row = rows.data() + next_[chunk_of[i]]++ * width;
    row[0] = positions[i].x;
    row[1] = positions[i].y;
    row[2] = positions[i].z;
    std::copy_n(attributes.data() + i * channels, channels, row + 3);
  }
}

void ChunkedTriangles::sort(std::span<const RankTriangle> triangles,
                            const partition::ChunkMap& map) {
  starts.assign(map.count() + 1, 0);
  shared.clear();
  wide.fill(0);
  chunk_of_.resize(triangles.size());
  ChunkFinder finder(map);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const RankTriangle& t = triangles[i];
    const std::uint32_t a = finder.chunk_of(t[0]);
    const std::uint32_t b = finder.chunk_of(t[1]);
    const std::uint32_t c = finder.chunk_of(t[2]);
    if (a == b && b == c) {
      chunk_of_[i] = a;
      ++starts[a + 1];
      continue;
    }
    chunk_of_[i] = kShared;
    shared.push_back({a, t});
    if (b != a)
      shared.push_back({b, t});
    if (c != a && c != b) {
      shared.push_back({c, t});
      if (b != a)
        ++wide[levels_apart(a, b, c)];
    }
  }
  counts_to_starts(starts, next_);
  inner.resize(starts.back());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t chunk = chunk_of_[i];
    if (chunk != kShared)
      inner[next_[chunk]++] = PackedTriangle(triangles[i], map.first_rank(chunk));
  }
}

Chunks::Chunks(const Tree& tree, int channels, storage::ScratchFile& scratch,
               std::size_t block_bytes)
    : level_(partition::chunk_level(tree)), map_(tree, level_), channels_(channels) {
  static_assert(partition::kChunkVertices <= std::uint64_t{1} << 21, "PackedTriangle");
  for (std::uint32_t i = 0; i < map_.count(); ++i) {
    vertices_.emplace_back(scratch, block_bytes);
    inner_.emplace_back(scratch, block_bytes);
    shared_.emplace_back(scratch, block_bytes);
  }
}

void Chunks::append(const ChunkedVertices& block) {
  const std::size_t width = 3 + static_cast<std::size_t>(channels_);
  for (std::uint32_t c = 0; c < count(); ++c) {
    const std::size_t rows = block.starts[c + 1] - block.starts[c];
    if (rows > 0)
      vertices_[c].append(std::span(block.rows).subspan(block.starts[c] * width, rows * width));
  }
}

void Chunks::append(const ChunkedTriangles& block) {
  for (std::uint32_t c = 0; c < count(); ++c) {
    const std::size_t triangles = block.starts[c + 1] - block.starts[c];
    if (triangles > 0)
      inner_[c].append(std::span(block.inner).subspan(block.starts[c], triangles));
  }
  for (const auto& [chunk, triangle] : block.shared)
    shared_[chunk].append(triangle);
  for (std::size_t k = 0; k < wide_.size(); ++k)
    wide_[k] += block.wide[k];
}

std::uint64_t Chunks::wide_triangles(Level level) const {
  const auto above = wide_.begin() + (raw(level_) - raw(level));
  return std::accumulate(above, wide_.end(), std::uint64_t{0});
}

std::uint64_t Chunks::triangle_bytes(std::uint32_t chunk) const {
  return (inner_[chunk].size() + shared_[chunk].size()) * sizeof(RankTriangle);
}

partition::ChunkMesh Chunks::take(std::uint32_t chunk) {
  partition::ChunkMesh mesh;
  mesh.node = {level_, chunk};
  mesh.vertices.channels = channels_;
  mesh.vertices.positions.resize(map_.size(chunk));
  mesh.vertices.attributes.resize(map_.size(chunk) * static_cast<std::size_t>(channels_));
  constexpr std::uint64_t kBatch = 16384;  // records at a time: nothing is held twice
  const std::size_t width = 3 + static_cast<std::size_t>(channels_);
  std::vector<float> rows;
  for (std::uint64_t first = 0; first < map_.size(chunk); first += kBatch) {
    rows.resize(std::min<std::uint64_t>(kBatch, map_.size(chunk) - first) * width);
    vertices_[chunk].read(first * width, rows);
    Vec3f* position = mesh.vertices.positions.data() + first;
    float* attributes = mesh.vertices.attributes.data() + first * (width - 3);
    for (std::size_t at = 0; at < rows.size(); at += width) {
      *position++ = {rows[at], rows[at + 1], rows[at + 2]};
      attributes = std::copy_n(rows.data() + at + 3, width - 3, attributes);
    }
  }

  const std::uint64_t inner_count = inner_[chunk].size();
  mesh.triangles.resize(inner_count + shared_[chunk].size());
  std::vector<PackedTriangle> packed;
  for (std::uint64_t first = 0; first < inner_count; first += kBatch) {
    packed.resize(std::min(kBatch, inner_count - first));
    inner_[chunk].read(first, packed);
    for (std::size_t i = 0; i < packed.size(); ++i)
      mesh.triangles[first + i] = packed[i].ranks(map_.first_rank(chunk));
  }
  shared_[chunk].read(0, std::span(mesh.triangles).subspan(inner_count));
  drop(chunk);
  return mesh;
}

void Chunks::drop(std::uint32_t chunk) {
  vertices_[chunk].clear();
  inner_[chunk].clear();
  shared_[chunk].clear();
}

nlohmann::json Chunks::store(std::uint32_t chunk) {
  return {pipeline::store(vertices_[chunk]), pipeline::store(inner_[chunk]),
          pipeline::store(shared_[chunk])};
}

bool Chunks::restore(std::uint32_t chunk, const nlohmann::json& stored) {
  return pipeline::restore(vertices_[chunk], stored.at(0)) &&
         pipeline::restore(inner_[chunk], stored.at(1)) &&
         pipeline::restore(shared_[chunk], stored.at(2));
}

bool Chunks::is_as_stored(std::uint32_t chunk) const {
  return vertices_[chunk].is_as_stored() && inner_[chunk].is_as_stored() &&
         shared_[chunk].is_as_stored();
}

double Chunks::expected_triangle_bytes(std::uint64_t vertex_count, std::uint64_t face_count,
                                       double boundary_share) {
  const auto vertices = static_cast<double>(vertex_count);
  const double chunks = std::max(1.0, power_of_two_from(vertices / partition::kChunkVertices));
  const double share = chunks > 1 ? boundary_share / std::sqrt(vertices / chunks) : 0;
  return static_cast<double>(face_count) * sizeof(RankTriangle) * (1 + std::min(1.0, share));
}

std::uint64_t most_chunks(std::uint64_t vertex_count) {
  return vertex_count * 2 / partition::kChunkVertices + 1;
}

ChunkSpools ChunkSpools::of(std::uint64_t vertex_count, std::uint32_t vertex_bytes,
                            std::uint64_t face_count) {
  constexpr std::uint64_t kTriangleBytes = 13;  // 12, and those that chunks share
  return {Chunks::kSpools * most_chunks(vertex_count),
          vertex_count * vertex_bytes + face_count * kTriangleBytes};
}

std::size_t ChunkSpools::block_bytes(std::uint64_t work_bytes) const {
  return std::clamp(work_bytes / kWorkParts / count, kLeastBlock, kMostBlock);
}

std::uint64_t ChunkSpools::index_bytes(std::uint64_t block) const {
  // 8 bytes for every block, in vectors that may be half empty, and both halves held while they
  // grow.
  constexpr std::uint64_t kEntryBytes = 24;
  return spooled_bytes / block * kEntryBytes;
}

}  // namespace meshhier::pipeline
