#include "pipeline/tiles/chunks.h"

#include "base/power_of_two.h"
#include "partition/top_tree.h"
#include "pipeline/tiles/spool_json.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace meshhier::pipeline {
namespace {

using partition::ChunkFinder;
using partition::RankTriangle;

constexpr std::uint64_t kBatch = 16384;  // records read at a time: nothing is held twice

/// Turns counts of items, entry i + 1 for item i, into the places where they start, and where the
/// next of each goes.
void counts_to_starts(std::vector<std::uint32_t>& counts, std::vector<std::uint32_t>& next) {
  for (std::size_t i = 1; i < counts.size(); ++i)
    counts[i] += counts[i - 1];
  next.assign(counts.begin(), counts.end() - 1);
}

/// Returns how many levels above these three nodes of one level their ancestors still are three.
int levels_apart(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return std::min({std::bit_width(a ^ b), std::bit_width(b ^ c), std::bit_width(a ^ c)}) - 1;
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
  shared.clear(map.count());
  wedged.clear(map.count());
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
    // Each chunk is split on its own, so it needs all triangles that touch it.
    chunk_of_[i] = kShared;
    shared.add(a, t);
    if (b != a)
      shared.add(b, t);
    if (c != a && c != b) {
      shared.add(c, t);
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

void ChunkedTriangles::sort_wedged(std::span<const WedgedTriangle> triangles,
                                   const partition::ChunkMap& map) {
  ChunkFinder finder(map);
  for (const WedgedTriangle& t : triangles) {
    const std::uint32_t a = finder.chunk_of(t.ranks[0]);
    const std::uint32_t b = finder.chunk_of(t.ranks[1]);
    const std::uint32_t c = finder.chunk_of(t.ranks[2]);
    wedged.add(a, t);
    if (b != a)
      wedged.add(b, t);
    if (c == a || c == b)
      continue;
    wedged.add(c, t);
    if (b != a)
      ++wide[levels_apart(a, b, c)];
  }
}

Chunks::Chunks(const Tree& tree, int channels, bool has_copies, storage::ScratchFile& scratch,
               std::size_t block_bytes)
    : level_(partition::chunk_level(tree)),
      map_(tree, level_),
      channels_(channels),
      locks_(map_.count()) {
  static_assert(partition::kChunkVertices <= std::uint64_t{1} << 21, "PackedTriangle");
  for (std::uint32_t i = 0; i < map_.count(); ++i) {
    vertices_.emplace_back(scratch, block_bytes, row_width());
    inner_.emplace_back(scratch, block_bytes);
    shared_.emplace_back(scratch, block_bytes);
  }
  for (std::uint32_t i = 0; i < (has_copies ? map_.count() : 0); ++i) {
    copies_.emplace_back(scratch, block_bytes);
    wedged_.emplace_back(scratch, block_bytes);
  }
}

void Chunks::append(const ChunkedVertices& block) {
  const std::size_t width = row_width();
  for (std::uint32_t c = 0; c < count(); ++c) {
    const std::size_t rows = block.starts[c + 1] - block.starts[c];
    if (rows == 0)
      continue;
    const std::lock_guard lock(locks_[c]);
    vertices_[c].append(block.first_ranks[c] - map_.first_rank(c),
                        std::span(block.rows).subspan(block.starts[c] * width, rows * width));
  }
}

void Chunks::append(const ChunkedTriangles& block) {
  for (std::uint32_t c = 0; c < count(); ++c) {
    const std::size_t triangles = block.starts[c + 1] - block.starts[c];
    if (triangles == 0 && !block.shared.has(c) && !block.wedged.has(c))
      continue;
    const std::lock_guard lock(locks_[c]);
    inner_[c].append(std::span(block.inner).subspan(block.starts[c], triangles));
    block.shared.for_each(c, [&](const RankTriangle& t) { shared_[c].append(t); });
    block.wedged.for_each(c, [&](const WedgedTriangle& t) { wedged_[c].append(t); });
  }
  add_wide(block.wide);
}

void Chunks::add_wide(const WideCounts& wide) {
  const std::lock_guard lock(wide_lock_);
  for (std::size_t k = 0; k < wide_.size(); ++k)
    wide_[k] += wide[k];
}

void Chunks::append_copy(std::uint32_t rank, std::span<const float> row) {
  const std::uint32_t chunk = map_.chunk_of(rank);
  JoinedSpool<float>& spool = copies_[chunk];
  spool.append(std::bit_cast<float>(rank - map_.first_rank(chunk)));
  spool.append(row);
}

std::uint64_t Chunks::wide_triangles(Level level) const {
  const auto above = wide_.begin() + (raw(level_) - raw(level));
  return std::accumulate(above, wide_.end(), std::uint64_t{0});
}

std::uint64_t Chunks::triangle_bytes(std::uint32_t chunk) const {
  return triangle_count(chunk) * sizeof(RankTriangle) +
         (has_copies() ? wedged_[chunk].size() * sizeof(CornerWedges) : 0);
}

std::uint64_t Chunks::copy_count(std::uint32_t chunk) const {
  return has_copies() ? copies_[chunk].size() / (1 + row_width()) : 0;
}

std::uint64_t Chunks::copy_bytes(std::uint32_t chunk) const {
  return copy_count(chunk) * (1 + row_width()) * sizeof(float);
}

partition::ChunkMesh Chunks::take(std::uint32_t chunk) {
  partition::ChunkMesh mesh;
  mesh.node = {level_, chunk};
  read_vertices(chunk, mesh.vertices);
  const std::uint64_t inner_count = inner_[chunk].size();
  mesh.triangles.reserve(triangle_count(chunk));
  mesh.triangles.resize(inner_count + shared_[chunk].size());
  std::vector<PackedTriangle> packed;
  for (std::uint64_t first = 0; first < inner_count; first += kBatch) {
    packed.resize(std::min(kBatch, inner_count - first));
    inner_[chunk].read(first, packed);
    for (std::size_t i = 0; i < packed.size(); ++i)
      mesh.triangles[first + i] = packed[i].ranks(map_.first_rank(chunk));
  }
  shared_[chunk].read(0, std::span(mesh.triangles).subspan(inner_count));
  if (has_copies()) {
    mesh.copies = read_copies(chunk);
    std::vector<WedgedTriangle> wedged(wedged_[chunk].size());
    wedged_[chunk].read(0, wedged);
    for (const WedgedTriangle& t : wedged) {
      mesh.triangles.push_back(t.ranks);
      mesh.wedges.push_back(t.wedges);
    }
  }
  drop(chunk);
  return mesh;
}

void Chunks::read_vertices(std::uint32_t chunk, VertexArray& vertices) const {
  vertices.channels = channels_;
  vertices.positions.resize(map_.size(chunk));
  vertices.attributes.resize(map_.size(chunk) * static_cast<std::size_t>(channels_));
  const std::size_t width = row_width();
  vertices_[chunk].for_each(kBatch, [&](std::uint64_t first, std::span<const float> rows) {
    Vec3f* position = vertices.positions.data() + first;
    float* attributes = vertices.attributes.data() + first * (width - 3);
    for (std::size_t at = 0; at < rows.size(); at += width) {
      *position++ = {rows[at], rows[at + 1], rows[at + 2]};
      attributes = std::copy_n(rows.data() + at + 3, width - 3, attributes);
    }
  });
}

Copies Chunks::read_copies(std::uint32_t chunk) const {
  const std::size_t width = 1 + row_width();
  const std::uint64_t count = copies_[chunk].size() / width;
  Copies copies;
  copies.vertices.channels = channels_;
  copies.vertices.reserve(count);
  copies.places.reserve(count);
  std::vector<float> rows;
  for (std::uint64_t first = 0; first < count; first += kBatch) {
    rows.resize(std::min(kBatch, count - first) * width);
    copies_[chunk].read(first * width, rows);
    for (std::size_t at = 0; at < rows.size(); at += width) {
      const std::span<const float> row = std::span(rows).subspan(at, width);
      copies.places.push_back(std::bit_cast<std::uint32_t>(row[0]));
      copies.vertices.append({row[1], row[2], row[3]}, row.subspan(4));
    }
  }
  return sorted_by_place(copies);
}

void Chunks::drop(std::uint32_t chunk) {
  vertices_[chunk].clear();
  inner_[chunk].clear();
  shared_[chunk].clear();
  if (has_copies()) {
    copies_[chunk].clear();
    wedged_[chunk].clear();
  }
}

nlohmann::json Chunks::store(std::uint32_t chunk) {
  nlohmann::json stored = {vertices_[chunk].store(), pipeline::store(inner_[chunk]),
                           pipeline::store(shared_[chunk])};
  if (has_copies()) {
    stored.push_back(pipeline::store(copies_[chunk]));
    stored.push_back(pipeline::store(wedged_[chunk]));
  }
  return stored;
}

bool Chunks::restore(std::uint32_t chunk, const nlohmann::json& stored) {
  return vertices_[chunk].restore(stored.at(0)) && pipeline::restore(inner_[chunk], stored.at(1)) &&
         pipeline::restore(shared_[chunk], stored.at(2)) &&
         (!has_copies() || (pipeline::restore(copies_[chunk], stored.at(3)) &&
                            pipeline::restore(wedged_[chunk], stored.at(4))));
}

bool Chunks::restore_copies(std::uint32_t chunk, const nlohmann::json& stored) {
  return !has_copies() || pipeline::restore(copies_[chunk], stored.at(3));
}

bool Chunks::has(std::uint32_t chunk) const {
  return place_count(chunk) > 0 || triangle_count(chunk) > 0 || copy_count(chunk) > 0;
}

bool Chunks::is_as_stored(std::uint32_t chunk) const {
  return is_whole(chunk) && !find_change(chunk);
}

std::optional<Error> Chunks::find_change(std::uint32_t chunk) const {
  std::optional<Error> change;
  const auto is_as_stored = [&](const auto& spool) {
    change = spool.find_change();
    return !change;
  };
  if (is_as_stored(vertices_[chunk]) && is_as_stored(inner_[chunk]) &&
      is_as_stored(shared_[chunk]) && has_copies() && is_as_stored(copies_[chunk]))
    is_as_stored(wedged_[chunk]);
  return change;
}

double Chunks::expected_triangle_bytes(std::uint64_t place_count, std::uint64_t face_count,
                                       std::uint64_t wedged, double boundary_share) {
  const auto places = static_cast<double>(place_count);
  const double chunks = std::max(1.0, power_of_two_from(places / partition::kChunkVertices));
  const double share = chunks > 1 ? boundary_share / std::sqrt(places / chunks) : 0;
  const double bytes = static_cast<double>(face_count) * sizeof(RankTriangle) +
                       static_cast<double>(wedged) * sizeof(CornerWedges);
  return bytes * (1 + std::min(1.0, share));
}

std::uint64_t most_chunks(std::uint64_t place_count) {
  return place_count * 2 / partition::kChunkVertices + 1;
}

ChunkSpools ChunkSpools::of(std::uint64_t place_count, std::uint64_t copy_count,
                            std::uint32_t vertex_bytes, std::uint64_t face_count,
                            std::uint64_t wedged) {
  constexpr std::uint64_t kTriangleBytes = 13;  // 12, and those that chunks share
  constexpr std::uint64_t kWedgedBytes = 26;    // likewise
  const std::uint64_t spools = Chunks::kSpools + (copy_count > 0 ? Chunks::kCopySpools : 0);
  return {spools * most_chunks(place_count),
          (place_count + copy_count) * vertex_bytes + copy_count * sizeof(float) +
              face_count * kTriangleBytes + wedged * kWedgedBytes};
}

std::size_t ChunkSpools::block_bytes(std::uint64_t work_bytes) const {
  return std::clamp(work_bytes / kWorkParts / count, kLeastBlock, kMostBlock);
}

std::uint64_t ChunkSpools::index_bytes(std::uint64_t block) const {
  // A block takes 8 bytes, in vectors that may be half empty, and that are there twice while they
  // grow.
  constexpr std::uint64_t kEntryBytes = 24;
  return spooled_bytes / block * kEntryBytes;
}

}  // namespace meshhier::pipeline
