#include "storage/format/meshopt_codec.h"

#include "storage/format/glb.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <meshoptimizer.h>

namespace meshhier::storage {
namespace {

constexpr int kExponentLimit = 100;             // as the extension's specification has it
constexpr std::int32_t kMantissaEnd = 1 << 23;  // 24 bits, signed

// The most steps_by_score() a corner. Scans have 6; with 128 a million triangles still take 2 s. A
// few vertices with many triangles, or with copies of a few, would take the square of their number.
constexpr std::uint64_t kMostSteps = 128;
constexpr unsigned kCachedVertices = 16;

/// The library's versions of the streams are global; the extension knows these alone. Called before
/// each encoding: the first caller sets them, the others wait.
void use_extension_versions() {
  static const bool done = [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
    return true;
  }();
  static_cast<void>(done);
}

unsigned char* bytes_of(std::span<std::byte> bytes) {
  return reinterpret_cast<unsigned char*>(bytes.data());
}
const unsigned char* bytes_of(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

/// Returns the exponent of the lowest bit that is set; nothing for 0.
std::optional<int> lowest_bit(float value) {
  if (value == 0)
    return std::nullopt;
  int exponent = 0;
  const auto mantissa = static_cast<std::uint32_t>(
      std::ldexp(std::abs(std::frexp(value, &exponent)), std::numeric_limits<float>::digits));
  return exponent - std::numeric_limits<float>::digits + std::countr_zero(mantissa);
}

/// Returns an exponent that all coordinates of an axis are whole multiples of, by mantissas that
/// fit.
std::optional<int> common_exponent(std::span<const std::byte> positions, std::size_t axis) {
  int least = kExponentLimit;
  float largest = 0;
  for (std::size_t at = 4 * axis; at < positions.size(); at += 12) {
    const auto value = load_little<float>(positions.data() + at);
    if (!std::isfinite(value) || (std::signbit(value) && value == 0))
      return std::nullopt;  // would come back as another number, or as +0
    least = std::min(least, lowest_bit(value).value_or(kExponentLimit));
    largest = std::max(largest, std::abs(value));
  }
  const bool fits = least >= -kExponentLimit && std::ldexp(largest, -least) < kMantissaEnd;
  return fits ? std::optional(least) : std::nullopt;
}

/// Returns triangles in the order of the vertices that complete them. Vertices behind the boundary
/// come in the order of their numbers, a vertex of the boundary with the first triangle that has
/// another beside it. Among the triangles that a vertex completes, those at the youngest others
/// come first: 1.64 bytes a triangle of the dragon's partitions; oldest first, 2.01.
std::vector<std::uint32_t> completion_order(std::span<const std::uint32_t> corners,
                                            const VertexCounts& counts) {
  const auto youngest = [&](std::size_t t, const auto& age_of) {
    return std::max({age_of(corners[t]), age_of(corners[t + 1]), age_of(corners[t + 2])});
  };
  // Vertices behind the boundary are numbered as they are first used, so the number is the age. A
  // vertex of the boundary has the age of the oldest triangle that joins it to one of those.
  const auto inner_age = [&](std::uint32_t v) { return v < counts.boundary ? 0 : v; };
  std::vector<std::uint32_t> age(counts.all, UINT32_MAX);
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const std::uint32_t met = youngest(t, inner_age);
    for (std::size_t c = t; met > 0 && c < t + 3; ++c)
      age[corners[c]] = std::min(age[corners[c]], corners[c] < counts.boundary ? met : corners[c]);
  }
  const auto known_age = [&](std::uint32_t v) { return age[v] == UINT32_MAX ? 0 : age[v]; };

  using Key = std::array<std::uint32_t, 5>;  // age, corners from the last, first corner's place
  std::vector<Key> keys;
  keys.reserve(corners.size() / 3);
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    std::array<std::uint32_t, 3> last{~corners[t], ~corners[t + 1], ~corners[t + 2]};
    std::sort(last.begin(), last.end());
    keys.push_back(
        {youngest(t, known_age), last[0], last[1], last[2], static_cast<std::uint32_t>(t)});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> ordered;
  ordered.reserve(corners.size());
  for (const Key& key : keys)
    ordered.insert(ordered.end(), {corners[key[4]], corners[key[4] + 1], corners[key[4] + 2]});
  return ordered;
}

/// Returns the sum of squares of the vertices' triangle counts. For every triangle the order by
/// scores looks at all triangles around each vertex in its cache: its steps are about a multiple of
/// this.
std::uint64_t steps_by_score(std::span<const std::uint32_t> corners, std::size_t vertex_count) {
  std::vector<std::uint64_t> valences(vertex_count);
  for (const std::uint32_t v : corners)
    ++valences[v];
  return std::inner_product(valences.begin(), valences.end(), valences.begin(), std::uint64_t{0});
}

/// Returns the order by scores. It packs best of all and takes ten times as long as
/// vertex_cache_order(), or quadratic time where vertices have many triangles: then that order is
/// taken.
std::vector<std::uint32_t> order_by_score(std::span<const std::uint32_t> corners,
                                          std::size_t vertex_count) {
  if (steps_by_score(corners, vertex_count) > kMostSteps * corners.size())
    return vertex_cache_order(corners, vertex_count);
  std::vector<std::uint32_t> ordered(corners.size());
  meshopt_optimizeVertexCache(ordered.data(), corners.data(), corners.size(), vertex_count);
  return ordered;
}

std::vector<std::byte> encode_in_order(std::span<const std::uint32_t> corners,
                                       const VertexCounts& counts) {
  use_extension_versions();
  std::vector<std::byte> packed(meshopt_encodeIndexBufferBound(corners.size(), counts.all));
  packed.resize(meshopt_encodeIndexBuffer(bytes_of(std::span(packed)), packed.size(),
                                          corners.data(), corners.size()));
  return packed;
}

}  // namespace

std::vector<std::byte> encode_attributes(std::span<const std::byte> plain, std::size_t stride) {
  assert(!plain.empty() && stride % 4 == 0 && stride <= 256 && plain.size() % stride == 0);
  use_extension_versions();
  const std::size_t count = plain.size() / stride;
  std::vector<std::byte> packed(meshopt_encodeVertexBufferBound(count, stride));
  packed.resize(meshopt_encodeVertexBuffer(bytes_of(std::span(packed)), packed.size(), plain.data(),
                                           count, stride));
  return packed;
}

bool decode_attributes(std::span<const std::byte> packed, std::size_t stride,
                       std::span<std::byte> plain) {
  return meshopt_decodeVertexBuffer(plain.data(), plain.size() / stride, stride, bytes_of(packed),
                                    packed.size()) == 0;
}

std::vector<std::byte> encode_triangles(std::span<const std::uint32_t> corners,
                                        const VertexCounts& counts) {
  std::vector<std::byte> packed = encode_in_order(order_by_score(corners, counts.all), counts);
  std::vector<std::byte> other = encode_in_order(completion_order(corners, counts), counts);
  return other.size() < packed.size() ? other : packed;
}

bool decode_triangles(std::span<const std::byte> packed, std::span<std::uint32_t> corners) {
  return meshopt_decodeIndexBuffer(corners.data(), corners.size(), sizeof(std::uint32_t),
                                   bytes_of(packed), packed.size()) == 0;
}

std::vector<std::uint32_t> vertex_cache_order(std::span<const std::uint32_t> corners,
                                              std::size_t vertex_count) {
  std::vector<std::uint32_t> ordered(corners.size());
  if (!ordered.empty())
    meshopt_optimizeVertexCacheFifo(ordered.data(), corners.data(), corners.size(), vertex_count,
                                    kCachedVertices);
  return ordered;
}

std::vector<std::byte> encode_indices(std::span<const std::uint32_t> numbers) {
  use_extension_versions();
  // The bound depends on the count of vertices: any numbers of 32 bits are allowed here.
  std::vector<std::byte> packed(meshopt_encodeIndexSequenceBound(numbers.size(), UINT32_MAX));
  packed.resize(meshopt_encodeIndexSequence(bytes_of(std::span(packed)), packed.size(),
                                            numbers.data(), numbers.size()));
  return packed;
}

bool decode_indices(std::span<const std::byte> packed, std::span<std::uint32_t> numbers) {
  return meshopt_decodeIndexSequence(numbers.data(), numbers.size(), sizeof(std::uint32_t),
                                     bytes_of(packed), packed.size()) == 0;
}

bool try_filter_positions(std::span<std::byte> positions) {
  std::array<int, 3> exponents{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto exponent = common_exponent(positions, axis);
    if (!exponent)
      return false;
    exponents[axis] = *exponent;
  }
  for (std::size_t at = 0; at < positions.size(); at += 4) {
    const int exponent = exponents[at / 4 % 3];
    const auto mantissa =
        static_cast<std::int32_t>(std::ldexp(load_little<float>(positions.data() + at), -exponent));
    const auto word = static_cast<std::uint32_t>(exponent) << 24 |
                      (static_cast<std::uint32_t>(mantissa) & 0xffffffU);
    store_little(word, positions.data() + at);
  }
  return true;
}

bool unfilter_positions(std::span<std::byte> positions) {
  for (std::size_t at = 0; at < positions.size(); at += 4) {
    const auto word = load_little<std::uint32_t>(positions.data() + at);
    const int exponent = static_cast<std::int32_t>(word) >> 24;
    const std::int32_t mantissa = static_cast<std::int32_t>(word << 8) >> 8;
    if (exponent < -kExponentLimit || exponent > kExponentLimit)
      return false;
    store_little(std::ldexp(static_cast<float>(mantissa), exponent), positions.data() + at);
  }
  return true;
}

}  // namespace meshhier::storage
