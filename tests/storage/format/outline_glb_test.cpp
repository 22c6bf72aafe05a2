#include "storage/format/outline_glb.h"

#include "base/error.h"
#include "storage/format/glb.h"
#include "tests/support/error_message.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using storage::decode_outline;
using storage::encode_outline;
using storage::outline_bytes;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

const char* const kOutlineName = "some/outline.glb";

/// Polylines of 2 to 9 vertices; every third is closed.
Outline random_outline(std::size_t polylines, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-1000, 1000);
  Outline outline;
  for (std::size_t p = 0; p < polylines; ++p) {
    const std::size_t first = outline.vertices.size();
    const std::size_t count = 2 + random() % 7;
    for (std::size_t i = 0; i < count; ++i) {
      outline.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
    }
    if (p % 3 == 0)
      outline.vertices.push_back(Vec3f(outline.vertices[first]));
    outline.starts.push_back(static_cast<std::uint32_t>(outline.vertices.size()));
  }
  return outline;
}

std::size_t segment_count(const Outline& outline) {
  return outline.vertices.size() - outline.polyline_count();
}

void expect_round_trip(const Outline& outline, Vec3d origin) {
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    const Bytes bytes = encode_outline(outline, {origin, up});
    EXPECT_EQ(bytes.size(), outline_bytes(outline.vertices.size(), segment_count(outline)));
    const Outline back = decode_outline(bytes, kOutlineName);
    EXPECT_EQ(back.vertices, outline.vertices);
    EXPECT_EQ(back.starts, outline.starts);
    EXPECT_EQ(back.form_lines, outline.form_lines);
    EXPECT_EQ(back.first_view, outline.first_view);
  }
}

std::string outline_failure(const Bytes& bytes) {
  return tests::error_message(
      ErrorCode::corrupt, [&] { decode_outline(bytes, kOutlineName); }, kOutlineName);
}

TEST(OutlineGlb, GivesPolylinesBackInTheSizeForetold) {
  for (const std::size_t polylines : {0U, 1U, 2U, 3U, 40U, 1000U}) {
    expect_round_trip(random_outline(polylines, 1), {});
    expect_round_trip(random_outline(polylines, 2), {1e7, -0.1, 1.0 / 3});
  }
}

TEST(OutlineGlb, TellsWhichLinesDrawTheForm) {
  Outline outline = random_outline(40, 3);
  for (const std::size_t forms : {1U, 7U, 39U, 40U}) {
    outline.form_lines = forms;
    expect_round_trip(outline, {});
  }
}

TEST(OutlineGlb, PartsOfLinesAreNoLinesOfTheForm) {
  Outline outline;
  outline.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 3, 0}};
  outline.starts = {0, 4};
  outline.form_lines = 1;
  Bytes bytes = encode_outline(outline, {});
  const std::string key = "\"formSegmentCount\":";
  const auto found = std::search(bytes.begin(), bytes.end(), key.begin(), key.end(),
                                 [](std::byte a, char b) { return static_cast<char>(a) == b; });
  ASSERT_NE(found, bytes.end());
  for (const char count : {'0', '1', '2', '4'}) {
    found[static_cast<std::ptrdiff_t>(key.size())] = static_cast<std::byte>(count);
    EXPECT_NE(outline_failure(bytes), "") << count;
  }
}

TEST(OutlineGlb, TheSizeHoldsForTheLongestNumbers) {
  const float low = -std::numeric_limits<float>::max() / 3;
  const float tiny = -std::numeric_limits<float>::denorm_min();
  const double far = -2.2250738585072014e-308;
  Outline outline;
  outline.vertices = {{low, low, low}, {tiny, tiny, tiny}};
  outline.starts = {0, 2};
  outline.form_lines = 1;
  outline.first_view = Standpoint{-123.45678901234567, far};
  expect_round_trip(outline, {far, far, far});
}

TEST(OutlineGlb, SANITIZED_AFirstViewThatIsNoneIsRefused) {
  Outline outline = random_outline(1, 7);
  for (const Standpoint view : {Standpoint{361, 0}, Standpoint{0, -91}}) {
    outline.first_view = view;
    EXPECT_THAT(outline_failure(encode_outline(outline, {})),
                HasSubstr("is not two angles in degrees"));
  }
}

TEST(OutlineGlb, TakesWiderIndicesFrom65536VerticesOn) {
  for (const std::size_t vertices : {65535U, 65536U, 70001U}) {
    Outline outline;
    outline.vertices.assign(vertices, Vec3f{1, 2, 3});
    outline.starts = {0, 3, static_cast<std::uint32_t>(vertices)};
    expect_round_trip(outline, {});
  }
}

TEST(OutlineGlb, ABudgetOf32KilobytesHolds1900Segments) {
  EXPECT_LE(outline_bytes(2000, 1900), 32768U);
  EXPECT_GT(outline_bytes(2000, 1950), 32000U);
}

TEST(OutlineGlb, SANITIZED_TruncationAtEveryByteIsRefused) {
  const Bytes bytes = encode_outline(random_outline(5, 3), {});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(outline_failure(cut), "") << size;
    if (size < 12)
      continue;
    storage::store_little(static_cast<std::uint32_t>(size), cut.data() + 8);
    EXPECT_NE(outline_failure(cut), "") << size;
  }
}

TEST(OutlineGlb, SANITIZED_RandomFlipsAreRefusedOrHarmless) {
  const Outline outline = random_outline(20, 4);
  const Bytes good = encode_outline(outline, {5, 6, 7});
  std::mt19937 random(9);
  for (int round = 0; round < 5000; ++round) {
    Bytes bytes = good;
    bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
    try {
      const Outline back = decode_outline(bytes, kOutlineName);
      EXPECT_EQ(back.starts, outline.starts);
      EXPECT_EQ(back.vertices.size(), outline.vertices.size());
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::corrupt);
    }
  }
}

TEST(OutlineGlb, SANITIZED_SegmentsThatAreNoPolylinesAreRefused) {
  const Outline outline = random_outline(4, 5);
  const Bytes good = encode_outline(outline, {});
  const std::size_t indices = good.size() - 4 * segment_count(outline);
  for (const std::uint16_t value : {std::uint16_t{2}, std::uint16_t{9}, std::uint16_t{65535}}) {
    Bytes bytes = good;
    storage::store_little(value, bytes.data() + indices);
    EXPECT_THAT(outline_failure(bytes), HasSubstr("segment 0 is"));
    bytes = good;
    storage::store_little(value, bytes.data() + bytes.size() - 2);
    EXPECT_THAT(outline_failure(bytes), HasSubstr("segment"));
  }
}

TEST(OutlineGlb, SANITIZED_AVertexThatIsNotFiniteIsRefused) {
  Bytes bytes = encode_outline(random_outline(2, 6), {});
  const std::size_t json_bytes = storage::load_little<std::uint32_t>(bytes.data() + 12);
  storage::store_little(std::numeric_limits<float>::quiet_NaN(), bytes.data() + 28 + json_bytes);
  EXPECT_THAT(outline_failure(bytes), HasSubstr("vertex 0 is not finite"));
}

}  // namespace
}  // namespace meshhier::tests
