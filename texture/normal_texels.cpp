#include "texture/normal_texels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace meshhier::texture {
namespace {

constexpr float kStepsOfUnit = 32767;
constexpr std::size_t kWordBits = 64, kByteBits = 8;

/// The number of bits in each value of a byte.
constexpr std::array<std::uint8_t, 256> kBits = [] {
  std::array<std::uint8_t, 256> bits{};
  for (std::size_t i = 1; i < bits.size(); ++i)
    bits[i] = static_cast<std::uint8_t>(bits[i / 2] + i % 2);
  return bits;
}();

using FourTexelParts = std::int16_t __attribute__((vector_size(8)));

FourFloats four_parts(const std::int16_t* from) {
  return __builtin_convertvector(load_four<FourTexelParts>(from), FourFloats);
}

}  // namespace

/// Along one axis: the first of four texels around a place, and what each counts.
struct NormalTexels::CubicTaps {
  std::int64_t first = 0;
  std::array<float, 4> cubic{};
  std::array<float, 2> linear{};  ///< of the second and the third

  /// Requires at >= 0.
  explicit CubicTaps(double at) {
    const auto second = static_cast<std::int64_t>(at + 0.5) - 1;
    const auto t = static_cast<float>(at - 0.5 - static_cast<double>(second));
    first = second - 1;
    cubic = {((-0.5f * t + 1) * t - 0.5f) * t, (1.5f * t - 2.5f) * t * t + 1,
             ((-1.5f * t + 2) * t + 0.5f) * t, (0.5f * t - 0.5f) * t * t};
    linear = {1 - t, t};
  }
};

NormalTexels::NormalTexels(std::uint32_t width, std::uint32_t height,
                           std::span<const NormalTexel> all)
    : width_(width), height_(height), words_(word_count(width, height)) {
  known_.reserve(static_cast<std::size_t>(std::ranges::count_if(all, shows)));
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
  before_.reserve(words_.size() * (kWordBits / kByteBits));
  std::uint32_t sum = 0;
  for (const std::uint64_t word : words_) {
    for (std::size_t bit = 0; bit < kWordBits; bit += kByteBits) {
      before_.push_back(sum);
      sum += kBits[(word >> bit) & 255];
    }
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
  const std::size_t bit = texel % kByteBits;
  const std::uint64_t byte = words_[texel / kWordBits] >> (texel % kWordBits - bit);
  const std::uint64_t below = byte & ((std::uint64_t{1} << bit) - 1);
  return before_[texel / kByteBits] + kBits[below];
}

const NormalTexel* NormalTexels::four_at(std::size_t texel) const {
  constexpr std::uint64_t kFour = 15;
  const std::size_t bit = texel % kWordBits;
  std::uint64_t bits = words_[texel / kWordBits] >> bit;
  if (bit > kWordBits - 4)
    bits |= words_[texel / kWordBits + 1] << (kWordBits - bit);
  return (bits & kFour) == kFour ? known_.data() + rank(texel) : nullptr;
}

/// Mixes rows first, twelve numbers at once: four texels of three.
bool NormalTexels::mix_cubic(const CubicTaps& columns, const CubicTaps& rows,
                             FourFloats& mix) const {
  if (columns.first < 0 || columns.first + 4 > width_ || rows.first < 0 || rows.first + 4 > height_)
    return false;
  FourFloats head{}, middle{}, tail{};
  std::size_t texel =
      static_cast<std::size_t>(rows.first) * width_ + static_cast<std::size_t>(columns.first);
  for (std::size_t j = 0; j < 4; ++j, texel += width_) {
    const NormalTexel* four = four_at(texel);
    if (four == nullptr)
      return false;
    const std::int16_t* parts = four->data();
    head += four_parts(parts) * rows.cubic[j];
    middle += four_parts(parts + 4) * rows.cubic[j];
    tail += four_parts(parts + 8) * rows.cubic[j];
  }
  const auto& [a, b, c, d] = columns.cubic;
  mix = FourFloats{head[0], head[1], head[2], 0} * a +
        FourFloats{head[3], middle[0], middle[1], 0} * b +
        FourFloats{middle[2], middle[3], tail[0], 0} * c +
        FourFloats{tail[1], tail[2], tail[3], 0} * d;
  return true;
}

FourFloats NormalTexels::direction_at(const TexelPoint& at) const {
  const CubicTaps columns(std::clamp(at.x, 0.0, double(width_)));
  const CubicTaps rows(std::clamp(at.y, 0.0, double(height_)));
  FourFloats mix{};
  if (mix_cubic(columns, rows, mix))
    return mix;
  const auto texel = [&](std::int64_t column, std::int64_t row) {
    const auto x = std::clamp<std::int64_t>(columns.first + column, 0, width_ - 1);
    const auto y = std::clamp<std::int64_t>(rows.first + row, 0, height_ - 1);
    return direction_of_texel(
        this->at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
  };
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < 2; ++i)
      mix += texel(static_cast<std::int64_t>(i) + 1, static_cast<std::int64_t>(j) + 1) *
             (columns.linear[i] * rows.linear[j]);
  }
  return mix;
}

NormalTexel normal_texel(FourFloats direction) {
  const auto rounded = [](float value) {
    // Above 0, where numbers are cut downwards.
    const float steps = std::clamp(value, -1.0f, 1.0f) * kStepsOfUnit + (kStepsOfUnit + 1.5f);
    return static_cast<std::int16_t>(static_cast<std::int32_t>(steps) - 32768);
  };
  return {rounded(direction[0]), rounded(direction[1]), rounded(direction[2])};
}

FourFloats direction_of_texel(const NormalTexel& texel) {
  return FourFloats{static_cast<float>(texel[0]), static_cast<float>(texel[1]),
                    static_cast<float>(texel[2]), 0};
}

}  // namespace meshhier::texture
