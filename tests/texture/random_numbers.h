#pragma once

#include <cstdint>
#include <random>

namespace meshhier::texture {

/// The same on each machine.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint32_t seed) : random_(seed) {}
  /// 0 ... count - 1.
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
  /// 0 ... 1.
  double part() { return static_cast<double>(random_()) / 4294967295.0; }

 private:
  std::mt19937 random_;
};

}  // namespace meshhier::texture
