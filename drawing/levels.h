// Heights above the sheet at which a surface is cut.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::drawing {

struct CutLevel {
  double height = 0;
  bool is_index = false;  ///< of contours each fifth one: drawn bolder, and labelled
};

/// Levels [begin, end).
struct LevelRange {
  std::uint32_t begin = 0, end = 0;
  bool empty() const { return begin >= end; }
};

inline constexpr std::size_t kMostLevels = 100000;

/// Ascending heights.
class CutLevels {
 public:
  CutLevels() = default;
  /// Sorts them and drops repeated ones. Requires finite numbers.
  explicit CutLevels(std::vector<double> heights);
  /// Returns the multiples of an interval above `low` up to `high`. Throws Error(usage), which
  /// names an interval that would do, if these are more than kMostLevels. Requires interval > 0.
  static CutLevels contours(double interval, double low, double high);

  std::size_t size() const { return levels_.size(); }
  bool empty() const { return levels_.empty(); }
  const CutLevel& operator[](std::size_t i) const { return levels_[i]; }
  std::span<const CutLevel> all() const { return levels_; }

  /// Returns the levels that pass between two heights: above `low`, and at most at `high`. What is
  /// on a level counts as above it.
  LevelRange between(double low, double high) const;

 private:
  std::vector<CutLevel> levels_;
};

}  // namespace meshhier::drawing
