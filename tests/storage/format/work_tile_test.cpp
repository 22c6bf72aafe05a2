#include "storage/format/work_tile.h"

#include "base/error.h"

#include <bit>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

using Bytes = std::vector<std::byte>;

struct Shape {
  std::uint32_t own = 0, boundary = 0, foreign = 0, interior = 0, border = 0;
  int channels = 0;
};

std::vector<TileTriangle> random_triangles(std::mt19937& random, std::uint32_t count,
                                           std::uint32_t corners) {
  std::vector<TileTriangle> triangles(count);
  for (TileTriangle& t : triangles) {
    for (TileVertex& v : t)
      v = static_cast<TileVertex>(random() % corners);
  }
  // The last index there is, so that a number too narrow shows.
  if (!triangles.empty())
    triangles.back()[2] = static_cast<TileVertex>(corners - 1);
  return triangles;
}

SimplifiedTile make_tile(const Shape& shape) {
  std::mt19937 random(shape.own * 31 + shape.foreign);
  const auto number = [&] { return static_cast<float>(random() % 65536) / 65536 - 0.5F; };
  SimplifiedTile tile;
  tile.vertices.channels = shape.channels;
  tile.copies.vertices.channels = shape.channels;
  tile.boundary_count = shape.boundary;
  for (std::uint32_t i = 0; i < shape.own; ++i) {
    std::vector<float> attributes;
    for (int k = 0; k < shape.channels; ++k)
      attributes.push_back(number());
    tile.vertices.append({number(), number(), number()}, attributes);
    tile.history.weights.push_back(static_cast<float>(1 + random() % 1000));
  }
  for (std::uint32_t i = 0; i < shape.foreign; ++i)
    tile.foreign.push_back({{i / 3, static_cast<std::uint32_t>(random())}});
  tile.interior = random_triangles(random, shape.interior, shape.own);
  tile.border = random_triangles(random, shape.border, shape.own + shape.foreign);
  return tile;
}

void expect_same(const SimplifiedTile& a, const SimplifiedTile& b) {
  EXPECT_EQ(a.vertices.channels, b.vertices.channels);
  EXPECT_EQ(a.vertices.positions, b.vertices.positions);
  EXPECT_EQ(a.vertices.attributes, b.vertices.attributes);
  EXPECT_EQ(a.history.weights, b.history.weights);
  EXPECT_EQ(a.boundary_count, b.boundary_count);
  EXPECT_EQ(a.interior, b.interior);
  EXPECT_EQ(a.border, b.border);
  EXPECT_EQ(a.foreign, b.foreign);
  EXPECT_EQ(a.copies.vertices.channels, b.copies.vertices.channels);
  EXPECT_EQ(a.copies.vertices.positions, b.copies.vertices.positions);
  EXPECT_EQ(a.copies.vertices.attributes, b.copies.vertices.attributes);
  EXPECT_EQ(a.copies.places, b.copies.places);
  EXPECT_EQ(a.interior_wedges, b.interior_wedges);
  EXPECT_EQ(a.border_wedges, b.border_wedges);
}

/// Gives the tile's places `extra(place)` copies each, with attributes of their own, and the
/// triangles' corners any wedges that are there; foreign corners have `foreign_extra` beside the
/// first.
template <class Extra>
void add_copies(SimplifiedTile& tile, const Extra& extra, std::uint32_t foreign_extra) {
  std::mt19937 random(7);
  const auto own = static_cast<std::uint32_t>(tile.vertices.size());
  for (std::uint32_t place = 0; place < own; ++place) {
    for (std::uint32_t k = 0; k < extra(place); ++k) {
      std::vector<float> attributes(static_cast<std::size_t>(tile.vertices.channels));
      for (float& value : attributes)
        value = static_cast<float>(random() % 1000);
      tile.copies.vertices.append(tile.vertices.positions[place], attributes);
      tile.copies.places.push_back(place);
    }
  }
  const auto any_wedge = [&](TileVertex corner) {
    const std::uint32_t copies = raw(corner) < own ? extra(raw(corner)) : foreign_extra;
    return static_cast<std::uint32_t>(random() % (copies + 1));
  };
  for (const TileTriangle& t : tile.interior)
    tile.interior_wedges.push_back({any_wedge(t[0]), any_wedge(t[1]), any_wedge(t[2])});
  for (const TileTriangle& t : tile.border)
    tile.border_wedges.push_back({any_wedge(t[0]), any_wedge(t[1]), any_wedge(t[2])});
}

SimplifiedTile make_tile_with_copies(const Shape& shape, std::uint32_t foreign_extra) {
  SimplifiedTile tile = make_tile(shape);
  tile.copies.vertices.channels = shape.channels;
  add_copies(
      tile, [](std::uint32_t place) { return place % 3 == 1 ? place % 5 : 0; }, foreign_extra);
  return tile;
}

TEST(WorkTileBytes, HoldCopiesAndTheWedgesOfTriangles) {
  for (const int channels : {0, 3, kMaxChannels}) {
    for (const std::uint32_t foreign_extra : {0U, 2U, 70000U}) {
      const SimplifiedTile tile =
          make_tile_with_copies({100, 30, 25, 150, 60, channels}, foreign_extra);
      expect_same(decode_work_tile<FinerGhost>(encode_work_tile(tile), channels), tile);
    }
  }
}

TEST(WorkTileBytes, HoldWedgesOfForeignCornersAlone) {
  SimplifiedTile tile = make_tile({100, 30, 25, 150, 60, 2});
  tile.copies.vertices.channels = 2;
  add_copies(
      tile, [](std::uint32_t) { return 0U; }, 4);
  expect_same(decode_work_tile<FinerGhost>(encode_work_tile(tile), 2), tile);
}

TEST(WorkTileBytes, TakeNothingForWedgesThatAreAllTheFirst) {
  const SimplifiedTile plain = make_tile({100, 30, 25, 150, 60, 2});
  SimplifiedTile tile = plain;
  add_copies(
      tile, [](std::uint32_t) { return 0U; }, 0);
  ASSERT_FALSE(tile.border_wedges.empty());
  EXPECT_EQ(encode_work_tile(tile), encode_work_tile(plain));
}

TEST(WorkTileBytes, KeepIndicesOfCopiesOnBothSidesOf16Bits) {
  for (const std::uint32_t copies : {535U, 536U, 537U, 40000U}) {
    SimplifiedTile tile = make_tile({65000, 40000, 0, 1000, 1000, 0});
    add_copies(
        tile, [=](std::uint32_t place) { return place < copies ? 1U : 0U; }, 0);
    tile.interior[0][1] = static_cast<TileVertex>(copies - 1);  // the last copy of all
    tile.interior_wedges[0][1] = 1;
    expect_same(decode_work_tile<FinerGhost>(encode_work_tile(tile), 0), tile);
  }
}

TEST(WorkTileBytes, SayWhatTheirWedgesTakeOnceDecoded) {
  const Bytes plain = encode_work_tile(make_tile({100, 30, 25, 150, 60, 2}));
  const Bytes wedged = encode_work_tile(make_tile_with_copies({100, 30, 25, 150, 60, 2}, 3));
  const auto head = [](const Bytes& bytes) { return std::span(bytes).first(kWorkTileHeadBytes); };
  EXPECT_EQ(work_triangle_bytes(head(plain)), 210 * sizeof(TileTriangle) + 25 * sizeof(GhostRef));
  EXPECT_EQ(work_triangle_bytes(head(wedged)),
            work_triangle_bytes(head(plain)) + 210 * sizeof(CornerWedges));
  EXPECT_EQ(work_copy_bytes(head(plain), 2), 0U);
  const std::size_t copies = make_tile_with_copies({100, 30, 25, 150, 60, 2}, 3).copies.size();
  ASSERT_GT(copies, 0U);
  EXPECT_EQ(work_copy_bytes(head(wedged), 2), copies * (12 + 8 + 4));
}

TEST(WorkTileBytes, AddTheirCopiesToTheSums) {
  const SimplifiedTile tile = make_tile_with_copies({100, 30, 25, 150, 60, 2}, 3);
  const Bytes bytes = encode_work_tile(tile);
  TileSums sums;
  add_work_tile(std::span(bytes).first(kWorkTileHeadBytes), sums);
  add_work_tile(std::span(bytes).first(kWorkTileHeadBytes), sums);
  EXPECT_EQ(sums.copies, 2.0 * static_cast<double>(tile.copies.size()));
  TileSums plain = sums;
  plain.copies = 0;
  EXPECT_GE(expected_work_tile_bytes(sums, 20),
            expected_work_tile_bytes(plain, 20) + sums.copies * 20);
}

TEST(WorkTileBytes, HoldEveryTileWithAndWithoutAttributes) {
  for (const int channels : {0, 3, kMaxChannels}) {
    for (const Shape& shape :
         {Shape{0, 0, 0, 0, 0, channels}, Shape{1, 0, 0, 0, 0, channels},
          Shape{100, 30, 25, 150, 60, channels}, Shape{50, 50, 0, 90, 0, channels},
          Shape{7, 7, 80, 0, 90, channels}}) {
      const SimplifiedTile tile = make_tile(shape);
      expect_same(decode_work_tile<FinerGhost>(encode_work_tile(tile), channels), tile);
    }
  }
}

TEST(WorkTileBytes, KeepIndicesOnBothSidesOf16Bits) {
  for (const std::uint32_t foreign : {535U, 536U, 537U, 40000U}) {  // 65535, 65536, 65537, ...
    const SimplifiedTile tile = make_tile({65000, 40000, foreign, 1000, 1000, 0});
    ASSERT_EQ(raw(tile.border.back()[2]), 64999 + foreign);
    expect_same(decode_work_tile<FinerGhost>(encode_work_tile(tile), 0), tile);
  }
}

TEST(WorkTileBytes, TakeSixBytesATriangleWhereThatIsEnough) {
  const auto bytes_a_triangle = [](std::uint32_t foreign) {
    const std::size_t few = encode_work_tile(make_tile({65000, 10, foreign, 100, 0, 0})).size();
    const std::size_t more = encode_work_tile(make_tile({65000, 10, foreign, 200, 0, 0})).size();
    return (more - few) / 100;
  };
  EXPECT_EQ(bytes_a_triangle(536), 6U);
  EXPECT_EQ(bytes_a_triangle(537), 12U);
}

TEST(WorkTileBytes, KeepEveryBitOfEveryFloat) {
  SimplifiedTile tile = make_tile({2, 1, 0, 0, 0, 2});
  const std::uint32_t signalling = 0x7f800001, negative_zero = 0x80000000, denormal = 1;
  tile.vertices.positions[0] = {std::bit_cast<float>(negative_zero), std::bit_cast<float>(denormal),
                                std::numeric_limits<float>::max()};
  tile.vertices.attributes = {std::bit_cast<float>(signalling),
                              std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN(), -0.0F};
  const SimplifiedTile found = decode_work_tile<FinerGhost>(encode_work_tile(tile), 2);
  const auto expect_bits = [](const std::vector<float>& a, const std::vector<float>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i]));
  };
  expect_bits(found.vertices.attributes, tile.vertices.attributes);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(found.vertices.positions[0].x), negative_zero);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(found.vertices.positions[0].y), denormal);
}

TEST(WorkTileBytes, AreTheSameForTheSameTile) {
  const Shape shape{100, 30, 25, 150, 60, 3};
  EXPECT_EQ(encode_work_tile(make_tile(shape)), encode_work_tile(make_tile(shape)));
}

/// `decode` finds something wrong and says that it is a defect.
template <class Decode>
void expect_refused(const Decode& decode, const std::string& what) {
  try {
    (void)decode();
    ADD_FAILURE() << what << ": nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal) << what;
  }
}

TEST(WorkTileBytes, CutShortAnywhereAreRefused) {
  const Bytes bytes = encode_work_tile(make_tile({10, 5, 4, 7, 6, 2}));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    expect_refused([&] { return decode_work_tile<FinerGhost>(std::span(bytes).first(size), 2); },
                   "cut to " + std::to_string(size));
  }
}

TEST(WorkTileBytes, WithCopiesCutShortAnywhereAreRefused) {
  const Bytes bytes = encode_work_tile(make_tile_with_copies({10, 5, 4, 7, 6, 2}, 1));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    expect_refused([&] { return decode_work_tile<FinerGhost>(std::span(bytes).first(size), 2); },
                   "cut to " + std::to_string(size));
  }
}

TEST(WorkTileBytes, WithImpossibleCountsAreRefusedBeforeAnythingIsAllocated) {
  const Bytes bytes = encode_work_tile(make_tile({10, 5, 4, 7, 6, 2}));
  for (const std::size_t field :
       {0U, 2U, 3U, 4U, 5U, 6U}) {  // all but the boundary sizes something
    Bytes broken = bytes;
    std::fill_n(broken.begin() + static_cast<std::ptrdiff_t>(4 * field), 4, std::byte{0xff});
    expect_refused([&] { return decode_work_tile<FinerGhost>(broken, 2); },
                   "field " + std::to_string(field));
  }
}

TEST(WorkTileBytes, OfOtherChannelsAreRefused) {
  const Bytes bytes = encode_work_tile(make_tile({10, 5, 4, 7, 6, 2}));
  for (const int channels : {0, 1, 3, 9}) {
    expect_refused([&] { return decode_work_tile<FinerGhost>(bytes, channels); },
                   "channels " + std::to_string(channels));
  }
}

TEST(WorkTileBytes, WithMoreBehindThemAreRefused) {
  Bytes bytes = encode_work_tile(make_tile({10, 5, 4, 7, 6, 2}));
  bytes.push_back(std::byte{0});
  expect_refused([&] { return decode_work_tile<FinerGhost>(bytes, 2); }, "one byte more");
}

TEST(BoundaryBytes, HoldTheFirstVerticesOfTheTile) {
  for (const int channels : {0, 3, kMaxChannels}) {
    for (const std::uint32_t boundary_count : {0U, 1U, 30U, 100U}) {
      const SimplifiedTile tile = make_tile({100, boundary_count, 25, 150, 60, channels});
      const Boundary boundary = decode_boundary(encode_boundary(tile), channels);
      ASSERT_EQ(boundary.vertices.size(), boundary_count);
      EXPECT_EQ(boundary.vertices.channels, channels);
      EXPECT_TRUE(std::equal(boundary.vertices.positions.begin(), boundary.vertices.positions.end(),
                             tile.vertices.positions.begin()));
      ASSERT_EQ(boundary.vertices.attributes.size(),
                boundary_count * static_cast<std::size_t>(channels));
      EXPECT_TRUE(std::equal(boundary.vertices.attributes.begin(),
                             boundary.vertices.attributes.end(), tile.vertices.attributes.begin()));
    }
  }
}

TEST(BoundaryBytes, CutShortOrOfOtherChannelsAreRefused) {
  const Bytes bytes = encode_boundary(make_tile({10, 5, 4, 7, 6, 2}));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    expect_refused([&] { return decode_boundary(std::span(bytes).first(size), 2); },
                   "cut to " + std::to_string(size));
  }
  for (const int channels : {0, 1, 3, 9}) {
    expect_refused([&] { return decode_boundary(bytes, channels); },
                   "channels " + std::to_string(channels));
  }
}

TEST(BoundaryBytes, HoldTheCopiesOfItsPlaces) {
  const SimplifiedTile tile = make_tile_with_copies({100, 50, 25, 150, 60, 3}, 1);
  const Boundary boundary = decode_boundary(encode_boundary(tile), 3);
  const std::size_t copies = tile.copies.first_of(50);
  ASSERT_LT(0U, copies);
  ASSERT_LT(copies, tile.copies.size());
  ASSERT_EQ(boundary.copies.size(), copies);
  ASSERT_EQ(boundary.copies.vertices.size(), copies);
  EXPECT_EQ(boundary.copies.vertices.channels, 3);
  EXPECT_TRUE(std::equal(boundary.copies.places.begin(), boundary.copies.places.end(),
                         tile.copies.places.begin()));
  EXPECT_TRUE(std::equal(boundary.copies.vertices.attributes.begin(),
                         boundary.copies.vertices.attributes.end(),
                         tile.copies.vertices.attributes.begin()));
}

TEST(BoundaryBytes, WithCopiesCutShortAreRefused) {
  const Bytes bytes = encode_boundary(make_tile_with_copies({10, 9, 4, 7, 6, 2}, 1));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    expect_refused([&] { return decode_boundary(std::span(bytes).first(size), 2); },
                   "cut to " + std::to_string(size));
  }
}

TEST(WedgeMapBytes, HoldEveryMap) {
  const WedgeMap map{{0, 3, 70000, 0}, {1, 2, 300}, {1, 1, 3}};
  const WedgeMap found = decode_wedge_map(encode_wedge_map(map));
  EXPECT_EQ(found.firsts, map.firsts);
  EXPECT_EQ(found.copies, map.copies);
  EXPECT_EQ(found.places, map.places);
  EXPECT_EQ(found(1, 2), 2U);
  EXPECT_EQ(found(2, 0), 70000U);
}

TEST(WedgeMapBytes, TakeNothingIfAllWedgesKeepTheirNumbers) {
  EXPECT_TRUE(encode_wedge_map({}).empty());
  EXPECT_TRUE(decode_wedge_map({}).empty());
}

TEST(WedgeMapBytes, CutShortLongerOrImpossibleAreRefused) {
  Bytes bytes = encode_wedge_map({{0, 3, 70000, 0}, {1, 2, 300}, {1, 1, 3}});
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    expect_refused([&] { return decode_wedge_map(std::span(bytes).first(size)); },
                   "cut to " + std::to_string(size));
  }
  Bytes broken = bytes;
  std::fill_n(broken.begin(), 8, std::byte{0xff});
  expect_refused([&] { return decode_wedge_map(broken); }, "counts");
  bytes.push_back(std::byte{0});
  expect_refused([&] { return decode_wedge_map(bytes); }, "one byte more");
}

SeamStrip make_seam_strip(const Shape& shape) {
  std::mt19937 random(shape.own * 17 + shape.foreign);
  const auto number = [&] { return static_cast<float>(random() % 65536) / 65536 - 0.5F; };
  SeamStrip seam_strip;
  seam_strip.boundary_count = shape.boundary;
  seam_strip.own_count = shape.own;
  for (std::uint32_t i = 0; i < shape.own + shape.foreign; ++i)
    seam_strip.positions.push_back({number(), number(), number()});
  for (std::uint32_t i = 0; i < shape.own; ++i)
    seam_strip.deviations.push_back(number());
  for (std::uint32_t i = 0; i < shape.foreign; ++i)
    seam_strip.foreign.push_back({{i / 3, static_cast<std::uint32_t>(random())}});
  seam_strip.interior = random_triangles(random, shape.interior, shape.own);
  seam_strip.border = random_triangles(random, shape.border, shape.own + shape.foreign);
  seam_strip.interior_deviation = 0.125F;
  seam_strip.lost = std::numeric_limits<float>::infinity();
  seam_strip.mean_square = 1e-300;
  return seam_strip;
}

void expect_same(const SeamStrip& a, const SeamStrip& b) {
  EXPECT_EQ(a.boundary_count, b.boundary_count);
  EXPECT_EQ(a.own_count, b.own_count);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.deviations, b.deviations);
  EXPECT_EQ(a.foreign, b.foreign);
  EXPECT_EQ(a.interior, b.interior);
  EXPECT_EQ(a.border, b.border);
  EXPECT_EQ(a.interior_deviation, b.interior_deviation);
  EXPECT_EQ(a.lost, b.lost);
  EXPECT_EQ(a.mean_square, b.mean_square);
}

TEST(SeamStripBytes, HoldEverySeamStrip) {
  for (const Shape& shape :
       {Shape{}, Shape{1, 0, 0, 0, 0}, Shape{100, 30, 25, 150, 60}, Shape{7, 7, 80, 0, 90},
        Shape{65000, 40000, 535, 100, 100}, Shape{65000, 40000, 536, 100, 100},
        Shape{65000, 40000, 537, 100, 100}}) {
    const SeamStrip seam_strip = make_seam_strip(shape);
    expect_same(decode_seam_strip(encode_seam_strip(seam_strip)), seam_strip);
  }
}

TEST(SeamStripBytes, CutShortLongerOrImpossibleAreRefused) {
  Bytes bytes = encode_seam_strip(make_seam_strip({10, 5, 4, 7, 6}));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    expect_refused([&] { return decode_seam_strip(std::span(bytes).first(size)); },
                   "cut to " + std::to_string(size));
  }
  for (const std::size_t field : {0U, 2U, 3U, 4U}) {  // all but the boundary sizes something
    Bytes broken = bytes;
    std::fill_n(broken.begin() + static_cast<std::ptrdiff_t>(4 * field), 4, std::byte{0xff});
    expect_refused([&] { return decode_seam_strip(broken); }, "field " + std::to_string(field));
  }
  bytes.push_back(std::byte{0});
  expect_refused([&] { return decode_seam_strip(bytes); }, "one byte more");
}

}  // namespace
}  // namespace meshhier::storage
