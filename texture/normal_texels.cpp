#include "texture/normal_texels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace meshhier::texture {
namespace {

constexpr double kStepsOfUnit = 32767;
constexpr std::size_t kWordBits = 64;

bool shows(const NormalTexel& texel) {
  return (texel[0] | texel[1] | texel[2]) != 0;
}

Vec3d wide_of(const NormalTexel& texel) {
  return {static_cast<double>(texel[0]), static_cast<double>(texel[1]),
          static_cast<double>(texel[2])};
}

}  // namespace

/// Along one axis: the first of four texels around a place, and what each counts.
struct NormalTexels::CubicTaps {
  std::int64_t first = 0;
  std::array<double, 4> cubic{};
  std::array<double, 2> linear{};  ///< of the second and the third

  explicit CubicTaps(double at) {
    const double before = std::floor(at - 0.5);
    const double t = at - 0.5 - before;
    first = static_cast<std::int64_t>(before) - 1;
    cubic = {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1,
             ((-1.5 * t + 2) * t + 0.5) * t, (0.5 * t - 0.5) * t * t};
    linear = {1 - t, t};
  }
};

NormalTexels::NormalTexels(std::uint32_t width, std::uint32_t height,
                           std::span<const NormalTexel> all)
    : width_(width), height_(height), words_(word_count(width, height)) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!shows(all[i]))
      continue;
    words_[i / kWordBits] |= std::uint64_t{1} << i % kWordBits;
    known_.push_back(all[i]);
  }
  count();
}

NormalTexels::NormalTexels(std::uint32_t width, std::uint32_t height,
                           std::vector<std::uint64_t> words, std::vector<NormalTexel> known)
    : width_(width), height_(height), words_(std::move(words)), known_(std::move(known)) {
  count();
}

void NormalTexels::count() {
  std::uint32_t sum = 0;
  for (const std::uint64_t word : words_) {
    before_.push_back(sum);
    sum += static_cast<std::uint32_t>(std::popcount(word));
  }
}

NormalTexels NormalTexels::around(std::span<const CornerTexcoords> triangles) const {
  constexpr double kTaps = 2;  // of a lookup on each side
  std::vector<std::uint64_t> words(words_.size());
  const auto first = [](double at) {
    return static_cast<std::uint32_t>(std::max(at - kTaps, 0.0));
  };
  for (const CornerTexcoords& corners : triangles) {
    const auto [left, right] = std::minmax({corners[0].u, corners[1].u, corners[2].u});
    const auto [top, bottom] = std::minmax({corners[0].v, corners[1].v, corners[2].v});
    const double end_x = std::min(double{right} * width_ + kTaps + 1, double(width_));
    const double end_y = std::min(double{bottom} * height_ + kTaps + 1, double(height_));
    for (std::uint32_t y = first(double{top} * height_); y < end_y; ++y) {
      for (std::uint32_t x = first(double{left} * width_); x < end_x; ++x) {
        const std::size_t i = std::size_t{y} * width_ + x;
        words[i / kWordBits] |= words_[i / kWordBits] & std::uint64_t{1} << i % kWordBits;
      }
    }
  }
  std::vector<NormalTexel> known;
  for (std::size_t w = 0; w < words.size(); ++w) {
    for (std::uint64_t left = words[w]; left != 0; left &= left - 1)
      known.push_back(
          known_[rank(w * kWordBits + static_cast<std::size_t>(std::countr_zero(left)))]);
  }
  return {width_, height_, std::move(words), std::move(known)};
}

NormalTexel NormalTexels::at(std::uint32_t x, std::uint32_t y) const {
  const std::size_t i = std::size_t{y} * width_ + x;
  const std::uint64_t word = words_[i / kWordBits];
  const std::uint64_t bit = std::uint64_t{1} << i % kWordBits;
  if ((word & bit) == 0)
    return {};
  return known_[rank(i)];
}

/// The number of the texel among the known ones, if it is one of them.
std::size_t NormalTexels::rank(std::size_t texel) const {
  const std::uint64_t below =
      words_[texel / kWordBits] & ((std::uint64_t{1} << texel % kWordBits) - 1);
  return before_[texel / kWordBits] + static_cast<std::size_t>(std::popcount(below));
}

const NormalTexel* NormalTexels::four_at(std::size_t texel) const {
  constexpr std::uint64_t kFour = 15;
  const std::size_t bit = texel % kWordBits;
  std::uint64_t bits = words_[texel / kWordBits] >> bit;
  if (bit > kWordBits - 4)
    bits |= words_[texel / kWordBits + 1] << (kWordBits - bit);
  return (bits & kFour) == kFour ? known_.data() + rank(texel) : nullptr;
}

bool NormalTexels::add_cubic(const CubicTaps& columns, const CubicTaps& rows, Vec3d& sum) const {
  if (columns.first < 0 || columns.first + 4 > width_ || rows.first < 0 || rows.first + 4 > height_)
    return false;
  for (std::size_t j = 0; j < 4; ++j) {
    const NormalTexel* four = four_at((static_cast<std::size_t>(rows.first) + j) * width_ +
                                      static_cast<std::size_t>(columns.first));
    if (four == nullptr)
      return false;
    Vec3d row;
    for (std::size_t i = 0; i < 4; ++i)
      row = row + wide_of(four[i]) * columns.cubic[i];
    sum = sum + row * rows.cubic[j];
  }
  return true;
}

Vec3d NormalTexels::direction_at(const TexelPoint& at) const {
  const CubicTaps columns(std::clamp(at.x, 0.0, double(width_)));
  const CubicTaps rows(std::clamp(at.y, 0.0, double(height_)));
  if (Vec3d sum; add_cubic(columns, rows, sum))
    return sum;
  const auto texel = [&](std::int64_t column, std::int64_t row) {
    const auto x = std::clamp<std::int64_t>(columns.first + column, 0, width_ - 1);
    const auto y = std::clamp<std::int64_t>(rows.first + row, 0, height_ - 1);
    return this->at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  };
  Vec3d sum;
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < 2; ++i)
      sum =
          sum + wide_of(texel(static_cast<std::int64_t>(i) + 1, static_cast<std::int64_t>(j) + 1)) *
                    (columns.linear[i] * rows.linear[j]);
  }
  return sum;
}

NormalTexel normal_texel(const Vec3d& direction) {
  const auto rounded = [](double value) {
    return static_cast<std::int16_t>(std::floor(std::clamp(value, -1.0, 1.0) * kStepsOfUnit + 0.5));
  };
  return {rounded(direction.x), rounded(direction.y), rounded(direction.z)};
}

}  // namespace meshhier::texture
