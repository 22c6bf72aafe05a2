// Four floats at a time.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace meshhier {

/// Operations on them are those of single floats, bit for bit.
using FourFloats = float __attribute__((vector_size(16)));
/// Also what comparisons give: all bits of a lane, or none.
using FourInts = std::int32_t __attribute__((vector_size(16)));

template <class Four = FourFloats>
Four load_four(const void* from) {
  Four four;
  std::memcpy(&four, from, sizeof four);
  return four;
}

template <class Four>
void store_four(void* to, Four four) {
  std::memcpy(to, &four, sizeof four);
}

inline float sum_of(FourFloats four) {
  return (four[0] + four[1]) + (four[2] + four[3]);
}

inline FourFloats larger_of(FourFloats a, FourFloats b) {
  return a > b ? a : b;
}

inline float largest_of(FourFloats four) {
  const float low = four[0] > four[1] ? four[0] : four[1];
  const float high = four[2] > four[3] ? four[2] : four[3];
  return low > high ? low : high;
}

/// The square root of each lane, rounded as std::sqrt() is. Requires no lane below 0.
inline FourFloats roots_of(FourFloats four) {
#ifdef __SSE2__
  return __builtin_ia32_sqrtps(four);
#else
  return FourFloats{std::sqrt(four[0]), std::sqrt(four[1]), std::sqrt(four[2]), std::sqrt(four[3])};
#endif
}

inline bool any_of(FourInts lanes) {
  using Halves = std::uint64_t __attribute__((vector_size(16)));
  const auto halves = load_four<Halves>(&lanes);
  return (halves[0] | halves[1]) != 0;
}

/// Requires any_of().
inline std::uint32_t first_of(FourInts lanes) {
  return lanes[0] != 0 ? 0 : lanes[1] != 0 ? 1 : lanes[2] != 0 ? 2 : 3;
}

/// The lanes below `count`.
inline FourInts first_lanes(std::int32_t count) {
  return FourInts{0, 1, 2, 3} < count;
}

}  // namespace meshhier
