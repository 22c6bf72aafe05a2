#include "storage/format/work_tile.h"

#include "base/error.h"
#include "hierarchy/vertex_numbers.h"
#include "storage/format/work_bytes.h"

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
//   copies        if there are any: positions and attributes as above, places as numbers
//   wedges        of foreign corners, if there are any: their places, then wedges, as numbers
//   interior      interior * 3 corners   u16 if all vertices <= 65536, else u32
//   border        border * 3 corners     likewise
// Numbers: a byte says how many each of them takes. Corners: VertexNumbers, of own places, foreign
// corners, copies, and wedges of foreign corners.
struct WorkTileCounts {
  std::uint32_t own = 0;
  std::uint32_t boundary = 0;
  std::uint32_t foreign = 0;
  std::uint32_t interior = 0;
  std::uint32_t border = 0;
  std::uint32_t copies = 0;
  std::uint32_t foreign_wedges = 0;  // beside the first of each place

  std::uint64_t vertices() const { return std::uint64_t{own} + foreign + copies + foreign_wedges; }
  bool has_wedges() const { return copies > 0 || foreign_wedges > 0; }
};

// A seam strip takes so much per vertex of the boundary: 76 to 89 bytes were measured, with 1.8
// foreign corners; up to 130 after clustering where it leaves long boundaries.
constexpr double kStripBytes = 90;
constexpr double kStripForeign = 1.8;

bool narrow(const WorkTileCounts& counts) {
  return counts.vertices() <= 65536;
}

template <class T>
void put_as(Packer& packer, std::span<const std::uint32_t> numbers) {
  const std::vector<T> narrowed(numbers.begin(), numbers.end());
  packer.put(std::span<const T>(narrowed));
}

template <class T>
std::vector<std::uint32_t> get_as(Unpacker& unpacker, std::size_t count) {
  const std::vector<T> narrowed = unpacker.get<T>(count);
  return {narrowed.begin(), narrowed.end()};
}

/// Puts numbers in as few bytes each as the largest needs.
void put_numbers(Packer& packer, std::span<const std::uint32_t> numbers) {
  const std::uint32_t largest = numbers.empty() ? 0 : *std::ranges::max_element(numbers);
  const std::uint8_t width = largest <= UINT8_MAX ? 1 : largest <= UINT16_MAX ? 2 : 4;
  packer.put(std::span(&width, 1));
  width == 1   ? put_as<std::uint8_t>(packer, numbers)
  : width == 2 ? put_as<std::uint16_t>(packer, numbers)
               : put_as<std::uint32_t>(packer, numbers);
}

std::vector<std::uint32_t> get_numbers(Unpacker& unpacker, std::size_t count) {
  const std::uint8_t width = unpacker.get<std::uint8_t>(1)[0];
  return width == 1   ? get_as<std::uint8_t>(unpacker, count)
         : width == 2 ? get_as<std::uint16_t>(unpacker, count)
                      : get_as<std::uint32_t>(unpacker, count);
}

void put_vertices(Packer& packer, const VertexArray& vertices, std::size_t count) {
  packer.put(std::span<const Vec3f>(vertices.positions).first(count));
  packer.put(std::span<const float>(vertices.attributes)
                 .first(count * static_cast<std::size_t>(vertices.channels)));
}

VertexArray get_vertices(Unpacker& unpacker, std::size_t count, int channels) {
  VertexArray vertices;
  vertices.channels = channels;
  vertices.positions = unpacker.get<Vec3f>(count);
  vertices.attributes = unpacker.get<float>(count * static_cast<std::size_t>(channels));
  return vertices;
}

/// Puts the first `count` copies.
void put_copies(Packer& packer, const Copies& copies, std::size_t count) {
  if (count == 0)
    return;
  put_vertices(packer, copies.vertices, count);
  put_numbers(packer, std::span(copies.places).first(count));
}

Copies get_copies(Unpacker& unpacker, std::size_t count, int channels) {
  Copies copies;
  copies.vertices.channels = channels;
  if (count == 0)
    return copies;
  copies.vertices = get_vertices(unpacker, count, channels);
  copies.places = get_numbers(unpacker, count);
  return copies;
}

void put_wedges(Packer& packer, std::span<const Wedge> wedges) {
  for (const auto member : {&Wedge::place, &Wedge::wedge}) {
    std::vector<std::uint32_t> numbers(wedges.size());
    std::ranges::transform(wedges, numbers.begin(), member);
    if (!wedges.empty())
      put_numbers(packer, numbers);
  }
}

std::vector<Wedge> get_wedges(Unpacker& unpacker, std::size_t count) {
  if (count == 0)
    return {};
  const std::vector<std::uint32_t> places = get_numbers(unpacker, count);
  const std::vector<std::uint32_t> wedges = get_numbers(unpacker, count);
  std::vector<Wedge> result(count);
  for (std::size_t i = 0; i < count; ++i)
    result[i] = {places[i], wedges[i]};
  return result;
}

/// Returns the wedges of foreign corners that border triangles have, beside the first of each
/// place.
template <class Corner>
std::vector<Wedge> foreign_wedges(const WorkTile<Corner>& tile) {
  std::vector<Wedge> wedges;
  for (std::size_t t = 0; t < tile.border_wedges.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Wedge wedge{raw(tile.border[t][c]), tile.border_wedges[t][c]};
      if (wedge.place >= tile.vertices.size() && wedge.wedge > 0)
        wedges.push_back(wedge);
    }
  }
  std::sort(wedges.begin(), wedges.end());
  wedges.erase(std::unique(wedges.begin(), wedges.end()), wedges.end());
  return wedges;
}

/// Numbers the corners: the tile's own places, then its foreign corners, and the wedges of both.
VertexNumbers numbers_of(const WorkTileCounts& counts, const Copies& copies,
                         std::span<const Wedge> foreign) {
  std::vector<Wedge> wedges = wedges_of(copies.places);
  wedges.insert(wedges.end(), foreign.begin(), foreign.end());
  return {counts.own + counts.foreign, std::move(wedges)};
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
  const std::size_t triangle =
      sizeof(TileTriangle) + (counts.has_wedges() ? sizeof(CornerWedges) : 0);
  return (std::uint64_t{counts.interior} + counts.border) * triangle +
         counts.foreign * sizeof(GhostRef);
}

std::uint64_t work_copy_bytes(std::span<const std::byte> head, int channels) {
  WorkTileCounts counts;
  std::memcpy(&counts, head.data(), sizeof counts);
  return counts.copies * (sizeof(Vec3f) + 4 * static_cast<std::uint64_t>(channels) + 4);
}

void add_work_tile(std::span<const std::byte> head, TileSums& sums) {
  WorkTileCounts counts;
  std::memcpy(&counts, head.data(), sizeof counts);
  const double foreign = sums.foreign_per_boundary * sums.boundary + counts.foreign;
  const double triangles = static_cast<double>(counts.interior) + counts.border;
  sums.count += 1;
  sums.vertices += counts.own;
  sums.copies += counts.copies;
  sums.boundary += counts.boundary;
  sums.triangles += triangles;
  sums.wide_triangles += narrow(counts) ? 0 : triangles;
  sums.foreign_per_boundary = sums.boundary > 0 ? foreign / sums.boundary : 0;
  sums.ghosts_per_boundary = sums.foreign_per_boundary;
}

template <class Corner>
std::vector<std::byte> encode_work_tile(const WorkTile<Corner>& tile) {
  const std::vector<Wedge> foreign = foreign_wedges(tile);
  const WorkTileCounts counts{static_cast<std::uint32_t>(tile.vertices.size()),
                              tile.boundary_count,
                              static_cast<std::uint32_t>(tile.foreign.size()),
                              static_cast<std::uint32_t>(tile.interior.size()),
                              static_cast<std::uint32_t>(tile.border.size()),
                              static_cast<std::uint32_t>(tile.copies.size()),
                              static_cast<std::uint32_t>(foreign.size())};
  const std::size_t channels = static_cast<std::size_t>(tile.vertices.channels);
  Packer packer(sizeof counts + tile.vertices.size() * (16 + 4 * channels) +
                tile.foreign.size() * 8 + tile.copies.size() * (16 + 4 * channels) +
                foreign.size() * 8 + 3 + triangle_bytes(counts));
  packer.put(std::span(&counts, 1));
  put_vertices(packer, tile.vertices, tile.vertices.size());
  packer.put(std::span<const float>(tile.history.weights));
  packer.put(std::span<const Corner>(tile.foreign));
  put_copies(packer, tile.copies, tile.copies.size());
  put_wedges(packer, foreign);
  if (counts.has_wedges()) {
    const VertexNumbers numbers = numbers_of(counts, tile.copies, foreign);
    put_triangles(packer, counts, numbers.numbered(tile.interior, tile.interior_wedges),
                  numbers.numbered(tile.border, tile.border_wedges));
  } else {
    put_triangles(packer, counts, tile.interior, tile.border);
  }
  return packer.take();
}

template <class Corner>
WorkTile<Corner> decode_work_tile(std::span<const std::byte> bytes, int channels) {
  Unpacker unpacker(bytes);
  const WorkTileCounts counts = unpacker.get<WorkTileCounts>(1)[0];
  WorkTile<Corner> tile;
  tile.boundary_count = counts.boundary;
  tile.vertices = get_vertices(unpacker, counts.own, channels);
  tile.history.weights = unpacker.get<float>(counts.own);
  tile.foreign = unpacker.get<Corner>(counts.foreign);
  tile.copies = get_copies(unpacker, counts.copies, channels);
  const std::vector<Wedge> foreign = get_wedges(unpacker, counts.foreign_wedges);
  get_triangles(unpacker, counts, tile.interior, tile.border);
  unpacker.finish();
  if (counts.has_wedges()) {
    const VertexNumbers numbers = numbers_of(counts, tile.copies, foreign);
    tile.interior_wedges = numbers.split(tile.interior);
    tile.border_wedges = numbers.split(tile.border);
  }
  return tile;
}

// A boundary: u32 places, u32 copies, positions and attributes of the places, copies as above.
template <class Corner>
std::vector<std::byte> encode_boundary(const WorkTile<Corner>& tile) {
  const std::size_t copies = tile.copies.first_of(tile.boundary_count);
  const std::array<std::uint32_t, 2> counts{tile.boundary_count,
                                            static_cast<std::uint32_t>(copies)};
  const std::size_t channels = static_cast<std::size_t>(tile.vertices.channels);
  Packer packer(sizeof counts + (tile.boundary_count + copies) * (16 + 4 * channels) + 1);
  packer.put(std::span<const std::uint32_t>(counts));
  put_vertices(packer, tile.vertices, tile.boundary_count);
  put_copies(packer, tile.copies, copies);
  return packer.take();
}

Boundary decode_boundary(std::span<const std::byte> bytes, int channels) {
  Unpacker unpacker(bytes);
  const std::vector<std::uint32_t> counts = unpacker.get<std::uint32_t>(2);
  Boundary boundary;
  boundary.vertices = get_vertices(unpacker, counts[0], channels);
  boundary.copies = get_copies(unpacker, counts[1], channels);
  unpacker.finish();
  return boundary;
}

// A shading: u32 normals, u32 splits, the normals, the splits' vertices as numbers.
namespace {

void put_shading(Packer& packer, const OwnShading& shading) {
  const std::array<std::uint32_t, 2> counts{static_cast<std::uint32_t>(shading.normals.size()),
                                            static_cast<std::uint32_t>(shading.split_of.size())};
  packer.put(std::span<const std::uint32_t>(counts));
  packer.put(std::span<const NormalCode>(shading.normals));
  if (!shading.split_of.empty())
    put_numbers(packer, shading.split_of);
}

OwnShading get_shading(Unpacker& unpacker) {
  const std::vector<std::uint32_t> counts = unpacker.get<std::uint32_t>(2);
  OwnShading shading;
  shading.normals = unpacker.get<NormalCode>(counts[0]);
  if (counts[1] > 0)
    shading.split_of = get_numbers(unpacker, counts[1]);
  return shading;
}

std::size_t most_bytes(const OwnShading& shading) {
  return kShadingHeadBytes + sizeof(NormalCode) * shading.normals.size() +
         sizeof(std::uint32_t) * shading.split_of.size() + 1;
}

}  // namespace

std::vector<std::byte> encode_own_shading(const OwnShading& shading) {
  Packer packer(most_bytes(shading));
  put_shading(packer, shading);
  return packer.take();
}

OwnShading decode_own_shading(std::span<const std::byte> bytes) {
  Unpacker unpacker(bytes);
  OwnShading shading = get_shading(unpacker);
  unpacker.finish();
  return shading;
}

std::uint32_t encoded_split_count(std::span<const std::byte> head) {
  std::array<std::uint32_t, 2> counts;
  static_assert(sizeof counts == kShadingHeadBytes);
  std::memcpy(counts.data(), head.data(), sizeof counts);
  return counts[1];
}

// A boundary's: the shading, then u32 places, u32 copies, the copies' places as numbers.
std::vector<std::byte> encode_boundary_shading(const BoundaryShading& boundary) {
  const std::array<std::uint32_t, 2> counts{
      boundary.boundary_count, static_cast<std::uint32_t>(boundary.copy_places.size())};
  Packer packer(most_bytes(boundary.shading) + sizeof counts + 4 * counts[1] + 1);
  put_shading(packer, boundary.shading);
  packer.put(std::span<const std::uint32_t>(counts));
  if (counts[1] > 0)
    put_numbers(packer, boundary.copy_places);
  return packer.take();
}

BoundaryShading decode_boundary_shading(std::span<const std::byte> bytes) {
  Unpacker unpacker(bytes);
  BoundaryShading boundary;
  boundary.shading = get_shading(unpacker);
  const std::vector<std::uint32_t> counts = unpacker.get<std::uint32_t>(2);
  boundary.boundary_count = counts[0];
  if (counts[1] > 0)
    boundary.copy_places = get_numbers(unpacker, counts[1]);
  unpacker.finish();
  return boundary;
}

// A wedge map: u32 places, u32 copies, then wedges of the places, of the copies, and the copies'
// places, as numbers. Nothing if it is empty.
std::vector<std::byte> encode_wedge_map(const WedgeMap& map) {
  if (map.empty())
    return {};
  const std::array<std::uint32_t, 2> counts{static_cast<std::uint32_t>(map.firsts.size()),
                                            static_cast<std::uint32_t>(map.copies.size())};
  Packer packer(sizeof counts + map.firsts.size() + 4 * map.copies.size());
  packer.put(std::span<const std::uint32_t>(counts));
  put_numbers(packer, map.firsts);
  put_numbers(packer, map.copies);
  put_numbers(packer, map.places);
  return packer.take();
}

WedgeMap decode_wedge_map(std::span<const std::byte> bytes) {
  if (bytes.empty())
    return {};
  Unpacker unpacker(bytes);
  const std::vector<std::uint32_t> counts = unpacker.get<std::uint32_t>(2);
  WedgeMap map;
  map.firsts = get_numbers(unpacker, counts[0]);
  map.copies = get_numbers(unpacker, counts[1]);
  map.places = get_numbers(unpacker, counts[1]);
  unpacker.finish();
  return map;
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
  double mean_square = 0;
};

}  // namespace

std::vector<std::byte> encode_seam_strip(const SeamStrip& seam_strip) {
  SeamStripHead head;
  head.counts = {seam_strip.own_count,
                 seam_strip.boundary_count,
                 static_cast<std::uint32_t>(seam_strip.foreign.size()),
                 static_cast<std::uint32_t>(seam_strip.interior.size()),
                 static_cast<std::uint32_t>(seam_strip.border.size()),
                 0,
                 0};
  head.interior_deviation = seam_strip.interior_deviation;
  head.lost = seam_strip.lost;
  head.mean_square = seam_strip.mean_square;
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
  seam_strip.mean_square = head.mean_square;
  unpacker.finish();
  return seam_strip;
}

double expected_work_tile_bytes(const TileSums& tiles, std::uint32_t vertex_bytes) {
  constexpr double kCounts = 36;
  constexpr double kWeight = sizeof(float);
  constexpr double kForeign = sizeof(FinerGhost);
  constexpr double kTriangle = 3 * sizeof(std::uint16_t);
  constexpr double kCopyPlace = sizeof(std::uint16_t);
  constexpr double kForeignWedge = 2 * sizeof(std::uint16_t);
  // The boundary has its part of the copies, and foreign corners as many wedges.
  const double boundary_copies = tiles.boundary * tiles.copies_per_vertex();
  return tiles.count * kCounts + tiles.vertices * (vertex_bytes + kWeight) +
         tiles.boundary * (tiles.foreign_per_boundary * kForeign + vertex_bytes) +
         (tiles.copies + boundary_copies) * (vertex_bytes + kCopyPlace) +
         boundary_copies * tiles.foreign_per_boundary * kForeignWedge +
         (tiles.triangles + tiles.wide_triangles) * kTriangle;
}

double expected_shading_bytes(const TileSums& tiles) {
  constexpr double kHeads = 24;
  constexpr double kSplits = 1.05;  // with those of surfaces that are not too rough
  const double vertices = tiles.vertices + tiles.copies;
  const double boundary = tiles.boundary * (1 + tiles.copies_per_vertex());
  return tiles.count * kHeads + (vertices + boundary) * sizeof(NormalCode) * kSplits;
}

double expected_seam_strip_bytes(const TileSums& tiles) {
  // A strip has no more than the whole tile.
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
