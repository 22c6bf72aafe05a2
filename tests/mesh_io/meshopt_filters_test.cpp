#include "mesh_io/meshopt_filters.h"

#include "storage/io/hash.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <meshoptimizer.h>

namespace meshhier::mesh_io {
namespace {

/// Elements of all directions: points of the unfolded octahedron, and marks in the fourth numbers.
template <class Number>
std::vector<Number> octahedral_elements(int step) {
  constexpr int kFull = std::numeric_limits<Number>::max();
  std::vector<Number> elements;
  for (int x = -kFull; x <= kFull; x += step) {
    for (int y = -kFull; y <= kFull; y += step) {
      for (const int number : {x, y, kFull, (x ^ y) & 0x7f})
        elements.push_back(static_cast<Number>(number));
    }
  }
  return elements;
}

/// Three components of all sizes, for each component that is missing.
std::vector<std::int16_t> quaternion_elements() {
  std::vector<std::int16_t> elements;
  std::uint32_t state = 1;
  const auto next = [&] { return (state = state * 1664525 + 1013904223) >> 16; };
  for (int bits = 4; bits <= 16; ++bits) {
    const int full = (1 << (bits - 1)) - 1;
    for (int i = 0; i < 4000; ++i) {
      for (int c = 0; c < 3; ++c)
        elements.push_back(
            static_cast<std::int16_t>(static_cast<int>(next() % (2 * full + 1)) - full));
      elements.push_back(static_cast<std::int16_t>((full & ~3) | (i & 3)));
    }
  }
  return elements;
}

template <class Number>
std::span<std::byte> bytes_of(std::vector<Number>& elements) {
  return std::as_writable_bytes(std::span(elements));
}

template <class Number>
int largest_difference(const std::vector<Number>& a, const std::vector<Number>& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// On x86-64 meshoptimizer rounds these as we do on all machines.
void expect_theirs(const std::vector<std::int16_t>& undone,
                   const std::vector<std::int16_t>& theirs) {
#ifdef __x86_64__
  EXPECT_EQ(undone, theirs);
#else
  EXPECT_LE(largest_difference(undone, theirs), 1);
#endif
}

// The checksums are the same on all machines.

/// `undone` has the unit vectors of `elements`, rounded to the next whole number.
template <class Number>
void expect_directions(const std::vector<Number>& elements, const std::vector<Number>& undone) {
  constexpr double kFull = std::numeric_limits<Number>::max();
  for (std::size_t i = 0; i < elements.size(); i += 4) {
    double x = elements[i], y = elements[i + 1];
    const double z = kFull - std::abs(x) - std::abs(y);
    const double beyond = std::min(z, 0.0);
    x += x < 0 ? -beyond : beyond;
    y += y < 0 ? -beyond : beyond;
    const double size = std::hypot(x, y, z) / kFull;
    ASSERT_NEAR(undone[i], x / size, 0.51);
    ASSERT_NEAR(undone[i + 1], y / size, 0.51);
    ASSERT_NEAR(undone[i + 2], z / size, 0.51);
    ASSERT_EQ(undone[i + 3], elements[i + 3]);
  }
}

TEST(MeshoptFiltersTest, OctahedralBytesBecomeUnitVectors) {
  const auto elements = octahedral_elements<std::int8_t>(1);
  auto undone = elements, theirs = elements;
  undo_octahedral(bytes_of(undone), 4);
  expect_directions(elements, undone);
  meshopt_decodeFilterOct(theirs.data(), theirs.size() / 4, 4);
  EXPECT_LE(largest_difference(undone, theirs), 1);
  EXPECT_EQ(storage::checksum(bytes_of(undone)), 16924357482895419949U);
}

TEST(MeshoptFiltersTest, OctahedralShortsBecomeUnitVectors) {
  const auto elements = octahedral_elements<std::int16_t>(101);
  auto undone = elements, theirs = elements;
  undo_octahedral(bytes_of(undone), 8);
  expect_directions(elements, undone);
  meshopt_decodeFilterOct(theirs.data(), theirs.size() / 4, 8);
  expect_theirs(undone, theirs);
  EXPECT_EQ(storage::checksum(bytes_of(undone)), 13864178893017263819U);
}

TEST(MeshoptFiltersTest, QuaternionsGetTheirMissingComponent) {
  const auto elements = quaternion_elements();
  auto undone = elements, theirs = elements;
  undo_quaternion(bytes_of(undone));
  meshopt_decodeFilterQuat(theirs.data(), theirs.size() / 4, 8);
  expect_theirs(undone, theirs);
  EXPECT_EQ(storage::checksum(bytes_of(undone)), 18276529110121563259U);
}

TEST(MeshoptFiltersTest, DirectionsAndScalesThatAreNoneGiveNumbers) {
  std::vector<std::int16_t> none(4), filled(4, -1);
  undo_octahedral(bytes_of(none), 8);
  EXPECT_EQ(none, std::vector<std::int16_t>(4));
  undo_quaternion(bytes_of(none));
  EXPECT_EQ(none, (std::vector<std::int16_t>{32767, 0, 0, 0}));
  undo_quaternion(bytes_of(filled));  // the scale is -1: the components are 1 / sqrt(2)
  EXPECT_EQ(filled, (std::vector<std::int16_t>{23170, 23170, 23170, 0}));
}

}  // namespace
}  // namespace meshhier::mesh_io
