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
  std::uint32_t rim = 0;
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

bool narrow(const WorkTileCounts& counts) {
  return counts.own + counts.foreign <= 65536;
}

template <class Index>
void put_corners(Packer& packer, const std::vector<Triangle>& triangles) {
  std::byte* to = packer.make_room<Index>(triangles.size() * 3);
  for (const Triangle& t : triangles) {
    for (const TileVertex v : t) {
      const auto corner = static_cast<Index>(raw(v));
      std::memcpy(to, &corner, sizeof corner);
      to += sizeof corner;
    }
  }
}

template <class Index>
std::vector<Triangle> get_corners(Unpacker& unpacker, std::size_t count) {
  const std::byte* from = unpacker.skip<Index>(count * 3);
  std::vector<Triangle> triangles(count);
  const auto next = [&from] {
    Index corner;
    std::memcpy(&corner, from, sizeof corner);
    from += sizeof corner;
    return TileVertex{corner};
  };
  for (Triangle& t : triangles)
    t = {next(), next(), next()};
  return triangles;
}

std::size_t triangle_bytes(const WorkTileCounts& counts) {
  return (std::size_t{counts.interior} + counts.border) * (narrow(counts) ? 6 : 12);
}

void put_triangles(Packer& packer, const WorkTileCounts& counts,
                   const std::vector<Triangle>& interior, const std::vector<Triangle>& border) {
  for (const auto* triangles : {&interior, &border}) {
    narrow(counts) ? put_corners<std::uint16_t>(packer, *triangles)
                   : put_corners<std::uint32_t>(packer, *triangles);
  }
}

void get_triangles(Unpacker& unpacker, const WorkTileCounts& counts,
                   std::vector<Triangle>& interior, std::vector<Triangle>& border) {
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
  return (std::uint64_t{counts.interior} + counts.border) * sizeof(Triangle) +
         counts.foreign * sizeof(GhostRef);
}

std::vector<std::byte> encode_work_tile(const WorkTile& tile) {
  const WorkTileCounts counts{static_cast<std::uint32_t>(tile.vertices.size()), tile.rim_count,
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
  packer.put(std::span<const GhostRef>(tile.foreign));
  put_triangles(packer, counts, tile.interior, tile.border);
  return packer.take();
}

WorkTile decode_work_tile(std::span<const std::byte> bytes, int channels) {
  Unpacker unpacker(bytes);
  const WorkTileCounts counts = unpacker.get<WorkTileCounts>(1)[0];
  WorkTile tile;
  tile.rim_count = counts.rim;
  tile.vertices.channels = channels;
  tile.vertices.positions = unpacker.get<Vec3f>(counts.own);
  tile.vertices.attributes = unpacker.get<float>(counts.own * static_cast<std::size_t>(channels));
  tile.history.weights = unpacker.get<float>(counts.own);
  tile.foreign = unpacker.get<GhostRef>(counts.foreign);
  get_triangles(unpacker, counts, tile.interior, tile.border);
  unpacker.finish();
  return tile;
}

// A rim: u32 count, positions, attributes.
std::vector<std::byte> encode_rim(const WorkTile& tile) {
  const std::size_t count = tile.rim_count;
  const auto channels = static_cast<std::size_t>(tile.vertices.channels);
  Packer packer(4 + count * (12 + 4 * channels));
  packer.put(std::span(&tile.rim_count, 1));
  packer.put(std::span<const Vec3f>(tile.vertices.positions).first(count));
  packer.put(std::span<const float>(tile.vertices.attributes).first(count * channels));
  return packer.take();
}

Rim decode_rim(std::span<const std::byte> bytes, int channels) {
  Unpacker unpacker(bytes);
  const std::uint32_t count = unpacker.get<std::uint32_t>(1)[0];
  Rim rim;
  rim.vertices.channels = channels;
  rim.vertices.positions = unpacker.get<Vec3f>(count);
  rim.vertices.attributes = unpacker.get<float>(count * static_cast<std::size_t>(channels));
  unpacker.finish();
  return rim;
}

// A band:
//   head        BandHead
//   positions   (own + foreign) * 3 float
//   drifts      own float
//   foreign     foreign * 2 u32
//   interior    interior * 3 corners   u16 if own + foreign <= 65536, else u32
//   border      border * 3 corners     likewise
namespace {

struct BandHead {
  WorkTileCounts counts;
  float interior_drift = 0;
  float lost = 0;
  std::uint32_t padding = 0;
  double squared_sum = 0;
  double weight_sum = 0;
};

}  // namespace

std::vector<std::byte> encode_band(const Band& band) {
  BandHead head;
  head.counts = {band.own_count, band.rim_count, static_cast<std::uint32_t>(band.foreign.size()),
                 static_cast<std::uint32_t>(band.interior.size()),
                 static_cast<std::uint32_t>(band.border.size())};
  head.interior_drift = band.interior_drift;
  head.lost = band.lost;
  head.squared_sum = band.squared_sum;
  head.weight_sum = band.weight_sum;
  Packer packer(sizeof head + band.positions.size() * 12 + band.drifts.size() * 4 +
                band.foreign.size() * 8 + triangle_bytes(head.counts));
  packer.put(std::span<const BandHead>(&head, 1));
  packer.put(std::span<const Vec3f>(band.positions));
  packer.put(std::span<const float>(band.drifts));
  packer.put(std::span<const GhostRef>(band.foreign));
  put_triangles(packer, head.counts, band.interior, band.border);
  return packer.take();
}

Band decode_band(std::span<const std::byte> bytes) {
  Unpacker unpacker(bytes);
  const BandHead head = unpacker.get<BandHead>(1)[0];
  const WorkTileCounts& counts = head.counts;
  Band band;
  band.rim_count = counts.rim;
  band.own_count = counts.own;
  band.positions = unpacker.get<Vec3f>(std::size_t{counts.own} + counts.foreign);
  band.drifts = unpacker.get<float>(counts.own);
  band.foreign = unpacker.get<GhostRef>(counts.foreign);
  get_triangles(unpacker, counts, band.interior, band.border);
  band.interior_drift = head.interior_drift;
  band.lost = head.lost;
  band.squared_sum = head.squared_sum;
  band.weight_sum = head.weight_sum;
  unpacker.finish();
  return band;
}

}  // namespace meshhier::storage
