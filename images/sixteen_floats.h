// A number for each of sixteen texels. Sums have one order on every processor.
#pragma once

#include "base/four_floats.h"

#include <array>
#include <cstddef>

namespace meshhier::images {

struct Sixteen {
  std::array<FourFloats, 4> rows{};

  static Sixteen all(float value) {
    const FourFloats row{value, value, value, value};
    return {{row, row, row, row}};
  }
  float operator[](std::size_t i) const { return rows[i / 4][i % 4]; }

  Sixteen& operator+=(const Sixteen& b) {
    for (std::size_t i = 0; i < 4; ++i)
      rows[i] += b.rows[i];
    return *this;
  }
  Sixteen& operator-=(const Sixteen& b) {
    for (std::size_t i = 0; i < 4; ++i)
      rows[i] -= b.rows[i];
    return *this;
  }
  Sixteen& operator*=(const Sixteen& b) {
    for (std::size_t i = 0; i < 4; ++i)
      rows[i] *= b.rows[i];
    return *this;
  }
  friend Sixteen operator+(Sixteen a, const Sixteen& b) { return a += b; }
  friend Sixteen operator-(Sixteen a, const Sixteen& b) { return a -= b; }
  friend Sixteen operator*(Sixteen a, const Sixteen& b) { return a *= b; }
};

inline Sixteen larger_of(Sixteen a, const Sixteen& b) {
  for (std::size_t i = 0; i < 4; ++i)
    a.rows[i] = meshhier::larger_of(a.rows[i], b.rows[i]);
  return a;
}

inline Sixteen smaller_of(Sixteen a, const Sixteen& b) {
  for (std::size_t i = 0; i < 4; ++i)
    a.rows[i] = a.rows[i] < b.rows[i] ? a.rows[i] : b.rows[i];
  return a;
}

/// Cuts what is behind the point. Requires numbers from 0 to 2^31 - 1.
inline Sixteen whole_of(Sixteen a) {
  for (FourFloats& row : a.rows)
    row = __builtin_convertvector(__builtin_convertvector(row, FourInts), FourFloats);
  return a;
}

inline float sum_of(const Sixteen& a) {
  return meshhier::sum_of((a.rows[0] + a.rows[1]) + (a.rows[2] + a.rows[3]));
}

inline float largest_of(const Sixteen& a) {
  FourFloats largest = a.rows[0];
  for (std::size_t i = 1; i < 4; ++i)
    largest = meshhier::larger_of(largest, a.rows[i]);
  return meshhier::largest_of(largest);
}

}  // namespace meshhier::images
