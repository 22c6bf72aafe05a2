#include "storage/format/work_tile.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace meshhier::storage {
namespace {

// A work tile:
//   counts        WorkTileCounts
//   positions     own * 3 float
//   attributes    own * channels float
//   weights       own float
//   foreign       foreign * 2 u32
//   interior      interior * 3 corners   u16 if own + foreign <= 65536, else u32
//   border        border * 3 corners     likewise
struct WorkTileCounts {
  std::uint32_t own = 0;
  std::uint32_t boundary = 0;
  std::uint32_t foreign = 0;
  std::uint32_t interior = 0;
  std::uint32_t border = 0;
};

class Packer {
 public:
  explicit Packer(std::size_t size) { bytes_.reserve(size); }
  template <class T>
  void put(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto raw_bytes = std::as_bytes(values);
    bytes_.insert(bytes_.end(), raw_bytes.begin(), raw_bytes.end());
  }
  /// Appends room for `count` values, one after another.
  template <class T>
  std::byte* make_room(std::size_t count) {
    const std::size_t size = bytes_.size();
    bytes_.resize(size + count * sizeof(T));
    return bytes_.data() + size;
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  std::vector<T> get(std::size_t count) {
    const std::byte* const from = skip<T>(count);
    std::vector<T> values(count);
    if (count > 0)
      std::memcpy(values.data(), from, count * sizeof(T));
    return values;
  }
  /// Where the next `count` values lie, whatever their alignment.
  template <class T>
  const std::byte* skip(std::size_t count) {
    if (count > bytes_.size() / sizeof(T))
      throw Error(ErrorCode::internal, "a work tile is cut short");
    const std::byte* const from = bytes_.data();
    bytes_ = bytes_.subspan(count * sizeof(T));
    return from;
  }
  void finish() const {
    if (!bytes_.empty())
      throw Error(ErrorCode::internal, "a work tile has bytes too many");
  }

 private:
  std::span<const std::byte> bytes_;
};

// Of a seam strip, per vertex of the boundary: 76 to 89 bytes were measured, with 1.8 foreign
// corners; up to 130 after clustering where it leaves long boundaries.
constexpr double kStripBytes = 90;
constexpr double kStripForeign = 1.8;

bool narrow(const WorkTileCounts& counts) {
  return counts.own + counts.foreign <= 65536;
}

template <class Index>
void put_corners(Packer& packer, const std::vector<TileTriangle>& triangles) {
  std::byte* to = packer.make_room<Index>(triangles.size() * 3);
  for (const TileTriangle& t : triangles) {
    for (const TileVertex v : t) {
      const auto corner = static_cast<Index>(raw(v));
      std::memcpy(to, &corner, sizeof corner);
      to += sizeof corner;
    }
  }
}

template <class Index>
std::vector<TileTriangle> get_corners(Unpacker& unpacker, std::size_t count) {
  const std::byte* from = unpacker.skip<Index>(count * 3);
  std::vector<TileTriangle> triangles(count);
  const auto next = [&from] {
    Index corner;
    std::memcpy(&corner, from, sizeof corner);
    from += sizeof corner;
    return TileVertex{corner};
  };
  for (TileTriangle& t : triangles)
    t = {next(), next(), next()};
  return triangles;
}

std::size_t triangle_bytes(const WorkTileCounts& counts) {
  return (std::size_t{counts.interior} + counts.border) * (narrow(counts) ? 6 : 12);
}

void put_triangles(Packer& packer, const WorkTileCounts& counts,
                   const std::vector<TileTriangle>& interior,
                   const std::vector<TileTriangle>& border) {
  for (const auto* triangles : {&interior, &border}) {
    narrow(counts) ? put_corners<std::uint16_t>(packer, *triangles)
                   : put_corners<std::uint32_t>(packer, *triangles);
  }
}

void get_triangles(Unpacker& unpacker, const WorkTileCounts& counts,
                   std::vector<TileTriangle>& interior, std::vector<TileTriangle>& border) {
  const auto get = [&](std::size_t count) {
    return narrow(counts) ? get_corners<std::uint16_t>(unpacker, count)
                          : get_corners<std::uint32_t>(unpacker, count);
  };
  interior = get(counts.interior);
  border = get(counts.border);
}

}  // namespace

static_assert(sizeof(WorkTileCounts) == kWorkTileHeadBytes);

std::uint64_t work_triangle_bytes(std::span<const std::byte> head) {
  WorkTileCounts counts;
  std::memcpy(&counts, head.data(), sizeof counts);
  return (std::uint64_t{counts.interior} + counts.border) * sizeof(TileTriangle) +
         counts.foreign * sizeof(GhostRef);
}

void add_work_tile(std::span<const std::byte> head, TileSums& sums) {
  WorkTileCounts counts;
  std::memcpy(&counts, head.data(), sizeof counts);
  const double foreign = sums.foreign_per_boundary * sums.boundary + counts.foreign;
  const double triangles = static_cast<double>(counts.interior) + counts.border;
  sums.count += 1;
  sums.vertices += counts.own;
  sums.boundary += counts.boundary;
  sums.triangles += triangles;
  sums.wide_triangles += narrow(counts) ? 0 : triangles;
  sums.foreign_per_boundary = sums.boundary > 0 ? foreign / sums.boundary : 0;
  sums.ghosts_per_boundary = sums.foreign_per_boundary;
}

template <class Corner>
std::vector<std::byte> encode_work_tile(const WorkTile<Corner>& tile) {
  const WorkTileCounts counts{static_cast<std::uint32_t>(tile.vertices.size()), tile.boundary_count,
                              static_cast<std::uint32_t>(tile.foreign.size()),
                              static_cast<std::uint32_t>(tile.interior.size()),
                              static_cast<std::uint32_t>(tile.border.size())};
  const std::size_t channels = static_cast<std::size_t>(tile.vertices.channels);
  Packer packer(sizeof counts + tile.vertices.size() * (16 + 4 * channels) +
                tile.foreign.size() * 8 + triangle_bytes(counts));
  packer.put(std::span(&counts, 1));
  packer.put(std::span<const Vec3f>(tile.vertices.positions));
  packer.put(std::span<const float>(tile.vertices.attributes));
  packer.put(std::span<const float>(tile.history.weights));
  packer.put(std::span<const Corner>(tile.foreign));
  put_triangles(packer, counts, tile.interior, tile.border);
  return packer.take();
}

template <class Corner>
WorkTile<Corner> decode_work_tile(std::span<const std::byte> bytes, int channels) {
  Unpacker unpacker(bytes);
  const WorkTileCounts counts = unpacker.get<WorkTileCounts>(1)[0];
  WorkTile<Corner> tile;
  tile.boundary_count = counts.boundary;
  tile.vertices.channels = channels;
  tile.vertices.positions = unpacker.get<Vec3f>(counts.own);
  tile.vertices.attributes = unpacker.get<float>(counts.own * static_cast<std::size_t>(channels));
  tile.history.weights = unpacker.get<float>(counts.own);
  tile.foreign = unpacker.get<Corner>(counts.foreign);
  get_triangles(unpacker, counts, tile.interior, tile.border);
  unpacker.finish();
  return tile;
}

// A boundary: u32 count, positions, attributes.
template <class Corner>
std::vector<std::byte> encode_boundary(const WorkTile<Corner>& tile) {
  const std::size_t count = tile.boundary_count;
  const auto channels = static_cast<std::size_t>(tile.vertices.channels);
  Packer packer(4 + count * (12 + 4 * channels));
  packer.put(std::span(&tile.boundary_count, 1));
  packer.put(std::span<const Vec3f>(tile.vertices.positions).first(count));
  packer.put(std::span<const float>(tile.vertices.attributes).first(count * channels));
  return packer.take();
}

Boundary decode_boundary(std::span<const std::byte> bytes, int channels) {
  Unpacker unpacker(bytes);
  const std::uint32_t count = unpacker.get<std::uint32_t>(1)[0];
  Boundary boundary;
  boundary.vertices.channels = channels;
  boundary.vertices.positions = unpacker.get<Vec3f>(count);
  boundary.vertices.attributes = unpacker.get<float>(count * static_cast<std::size_t>(channels));
  unpacker.finish();
  return boundary;
}

// A seam strip:
//   head        SeamStripHead
//   positions   (own + foreign) * 3 float
//   deviations      own float
//   foreign     foreign * 2 u32
//   interior    interior * 3 corners   u16 if own + foreign <= 65536, else u32
//   border      border * 3 corners     likewise
namespace {

struct SeamStripHead {
  WorkTileCounts counts;
  float interior_deviation = 0;
  float lost = 0;
  std::uint32_t padding = 0;
  double squared_sum = 0;
  double weight_sum = 0;
};

}  // namespace

std::vector<std::byte> encode_seam_strip(const SeamStrip& seam_strip) {
  SeamStripHead head;
  head.counts = {seam_strip.own_count, seam_strip.boundary_count,
                 static_cast<std::uint32_t>(seam_strip.foreign.size()),
                 static_cast<std::uint32_t>(seam_strip.interior.size()),
                 static_cast<std::uint32_t>(seam_strip.border.size())};
  head.interior_deviation = seam_strip.interior_deviation;
  head.lost = seam_strip.lost;
  head.squared_sum = seam_strip.squared_sum;
  head.weight_sum = seam_strip.weight_sum;
  Packer packer(sizeof head + seam_strip.positions.size() * 12 + seam_strip.deviations.size() * 4 +
                seam_strip.foreign.size() * 8 + triangle_bytes(head.counts));
  packer.put(std::span<const SeamStripHead>(&head, 1));
  packer.put(std::span<const Vec3f>(seam_strip.positions));
  packer.put(std::span<const float>(seam_strip.deviations));
  packer.put(std::span<const FinerGhost>(seam_strip.foreign));
  put_triangles(packer, head.counts, seam_strip.interior, seam_strip.border);
  return packer.take();
}

SeamStrip decode_seam_strip(std::span<const std::byte> bytes) {
  Unpacker unpacker(bytes);
  const SeamStripHead head = unpacker.get<SeamStripHead>(1)[0];
  const WorkTileCounts& counts = head.counts;
  SeamStrip seam_strip;
  seam_strip.boundary_count = counts.boundary;
  seam_strip.own_count = counts.own;
  seam_strip.positions = unpacker.get<Vec3f>(std::size_t{counts.own} + counts.foreign);
  seam_strip.deviations = unpacker.get<float>(counts.own);
  seam_strip.foreign = unpacker.get<FinerGhost>(counts.foreign);
  get_triangles(unpacker, counts, seam_strip.interior, seam_strip.border);
  seam_strip.interior_deviation = head.interior_deviation;
  seam_strip.lost = head.lost;
  seam_strip.squared_sum = head.squared_sum;
  seam_strip.weight_sum = head.weight_sum;
  unpacker.finish();
  return seam_strip;
}

double expected_work_tile_bytes(const TileSums& tiles, std::uint32_t vertex_bytes) {
  constexpr double kCounts = 24;
  constexpr double kWeight = sizeof(float);
  constexpr double kForeign = sizeof(FinerGhost);
  constexpr double kTriangle = 3 * sizeof(std::uint16_t);
  return tiles.count * kCounts + tiles.vertices * (vertex_bytes + kWeight) +
         tiles.boundary * (tiles.foreign_per_boundary * kForeign + vertex_bytes) +
         (tiles.triangles + tiles.wide_triangles) * kTriangle;
}

double expected_seam_strip_bytes(const TileSums& tiles) {
  // No more than the whole tile.
  constexpr double kVertex = 20, kTriangle = 12;
  return std::min(tiles.boundary * kStripBytes,
                  tiles.vertices * kVertex + tiles.triangles * kTriangle);
}

double long_seam_strip_bytes(const TileSums& tiles) {
  return tiles.boundary * kStripBytes * std::max(1.0, tiles.foreign_per_boundary / kStripForeign);
}

template std::vector<std::byte> encode_work_tile(const LeafTile&);
template std::vector<std::byte> encode_work_tile(const SimplifiedTile&);
template LeafTile decode_work_tile(std::span<const std::byte>, int);
template SimplifiedTile decode_work_tile(std::span<const std::byte>, int);
template std::vector<std::byte> encode_boundary(const LeafTile&);
template std::vector<std::byte> encode_boundary(const SimplifiedTile&);

}  // namespace meshhier::storage
