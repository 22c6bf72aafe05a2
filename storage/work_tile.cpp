#include "storage/work_tile.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <array>
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
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  std::vector<T> get(std::size_t count) {
    if (count > bytes_.size() / sizeof(T))
      throw Error(ErrorCode::internal, "a work tile is cut short");
    std::vector<T> values(count);
    if (count > 0)
      std::memcpy(values.data(), bytes_.data(), count * sizeof(T));
    bytes_ = bytes_.subspan(count * sizeof(T));
    return values;
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
void put_triangles(Packer& packer, const std::vector<Triangle>& triangles) {
  std::vector<Index> corners;
  corners.reserve(triangles.size() * 3);
  for (const Triangle& t : triangles) {
    for (const TileVertex v : t)
      corners.push_back(static_cast<Index>(raw(v)));
  }
  packer.put(std::span<const Index>(corners));
}

template <class Index>
std::vector<Triangle> get_triangles(Unpacker& unpacker, std::size_t count) {
  const std::vector<Index> corners = unpacker.get<Index>(count * 3);
  std::vector<Triangle> triangles(count);
  for (std::size_t i = 0; i < corners.size(); ++i)
    triangles[i / 3][i % 3] = static_cast<TileVertex>(corners[i]);
  return triangles;
}

}  // namespace

std::vector<std::byte> encode_work_tile(const WorkTile& tile) {
  const WorkTileCounts counts{static_cast<std::uint32_t>(tile.vertices.size()), tile.rim_count,
                              static_cast<std::uint32_t>(tile.foreign.size()),
                              static_cast<std::uint32_t>(tile.interior.size()),
                              static_cast<std::uint32_t>(tile.border.size())};
  Packer packer(sizeof counts +
                tile.vertices.size() * (16 + 4 * static_cast<std::size_t>(tile.vertices.channels)) +
                tile.foreign.size() * 8 +
                (tile.interior.size() + tile.border.size()) * (narrow(counts) ? 6 : 12));
  packer.put(std::span(&counts, 1));
  packer.put(std::span<const Vec3f>(tile.vertices.positions));
  packer.put(std::span<const float>(tile.vertices.attributes));
  packer.put(std::span<const float>(tile.history.weights));
  packer.put(std::span<const GhostRef>(tile.foreign));
  for (const auto* triangles : {&tile.interior, &tile.border}) {
    narrow(counts) ? put_triangles<std::uint16_t>(packer, *triangles)
                   : put_triangles<std::uint32_t>(packer, *triangles);
  }
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
  tile.interior = narrow(counts) ? get_triangles<std::uint16_t>(unpacker, counts.interior)
                                 : get_triangles<std::uint32_t>(unpacker, counts.interior);
  tile.border = narrow(counts) ? get_triangles<std::uint16_t>(unpacker, counts.border)
                               : get_triangles<std::uint32_t>(unpacker, counts.border);
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

namespace {

/// Puts the mark `reached` + 1 on all corners of triangles with a corner marked `reached` or less.
void grow(const std::vector<Triangle>& triangles, std::uint8_t reached,
          std::vector<std::uint8_t>& marks) {
  for (const Triangle& t : triangles) {
    if (std::none_of(t.begin(), t.end(), [&](TileVertex v) { return marks[raw(v)] <= reached; }))
      continue;
    for (const TileVertex v : t)
      marks[raw(v)] = std::min<std::uint8_t>(marks[raw(v)], reached + 1);
  }
}

}  // namespace

// A band: u32 vertices, u32 triangles, vertices * 2 u32, positions, triangles * 3 u32.
std::vector<std::byte> encode_band(const BuildTile& tile, std::uint32_t index) {
  constexpr std::uint8_t kFar = 255;
  const TileMesh& mesh = tile.mesh;
  std::vector<std::uint8_t> marks(mesh.vertices.size(), 0);  // ghosts are on the border
  std::fill(marks.begin() + mesh.rim_count, marks.begin() + mesh.own_count, kFar);
  grow(mesh.interior, 0, marks);
  grow(mesh.interior, 1, marks);
  Band band;
  std::vector<std::uint32_t> place(marks.size());
  for (std::uint32_t v = 0; v < marks.size(); ++v) {
    place[v] = static_cast<std::uint32_t>(band.vertices.size());
    if (marks[v] == kFar)
      continue;
    const TileVertex vertex{v};
    band.vertices.push_back(mesh.is_own(vertex) ? GhostRef{index, v} : mesh.ghost(vertex));
    band.positions.push_back(mesh.vertices.positions[v]);
  }
  const auto add = [&](const Triangle& t) {
    band.triangles.push_back(
        {TileVertex{place[raw(t[0])]}, TileVertex{place[raw(t[1])]}, TileVertex{place[raw(t[2])]}});
  };
  for (const Triangle& t : mesh.interior) {
    if (std::any_of(t.begin(), t.end(), [&](TileVertex v) { return marks[raw(v)] <= 1; }))
      add(t);
  }
  for (const Triangle& t : mesh.border)
    add(t);
  const std::array counts{static_cast<std::uint32_t>(band.vertices.size()),
                          static_cast<std::uint32_t>(band.triangles.size())};
  Packer packer(8 + band.vertices.size() * 20 + band.triangles.size() * 12);
  packer.put(std::span<const std::uint32_t>(counts));
  packer.put(std::span<const GhostRef>(band.vertices));
  packer.put(std::span<const Vec3f>(band.positions));
  put_triangles<std::uint32_t>(packer, band.triangles);
  return packer.take();
}

Band decode_band(std::span<const std::byte> bytes) {
  Unpacker unpacker(bytes);
  const std::vector<std::uint32_t> counts = unpacker.get<std::uint32_t>(2);
  Band band;
  band.vertices = unpacker.get<GhostRef>(counts[0]);
  band.positions = unpacker.get<Vec3f>(counts[0]);
  band.triangles = get_triangles<std::uint32_t>(unpacker, counts[1]);
  unpacker.finish();
  return band;
}

}  // namespace meshhier::storage
