// Two doubles at a time.
#pragma once

#include <cstring>

namespace meshhier {

/// Operations on them are those of single doubles, bit for bit.
using TwoDoubles = double __attribute__((vector_size(16)));

inline TwoDoubles load_two(const double* from) {
  TwoDoubles two;
  std::memcpy(&two, from, sizeof two);
  return two;
}

inline TwoDoubles smaller_of(TwoDoubles a, TwoDoubles b) {
  return a < b ? a : b;
}
inline TwoDoubles larger_of(TwoDoubles a, TwoDoubles b) {
  return a > b ? a : b;
}

}  // namespace meshhier
