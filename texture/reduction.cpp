#include "texture/reduction.h"

#include "texture/bake.h"
#include "texture/fill.h"
#include "texture/shown_texels.h"
#include "texture/texel_light.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <utility>

namespace meshhier::texture {
namespace {

constexpr std::uint32_t kNothing = ~std::uint32_t{0};
constexpr float kUnknown = 1e9f;

TexelBits any_of_squares(TexelBits bits, std::uint32_t side) {
  for (; side > 1; side /= 2)
    bits = bits.any_of_four();
  return bits;
}

TexelBits all_of_squares(TexelBits bits, std::uint32_t side) {
  for (; side > 1; side /= 2)
    bits = bits.all_of_four();
  return bits;
}

}  // namespace

Reduction::Reduction(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                     std::span<const CornerTexcoords> corners, std::uint32_t factor)
    : width_(width),
      height_(height),
      factor_(factor),
      is_shown_(shown_texels(width, height, corners)),
      is_mean_(any_of_squares(is_shown_, factor)),
      is_full_(all_of_squares(is_shown_, factor)),
      result_(width / factor, height / factor, channels) {
  take_copies(nearest_texels(corners));
}

/// Returns for texels beside a triangle, which filters see, its nearest texel, although one of
/// another chart may be nearer; kNothing for all others.
std::vector<std::uint32_t> Reduction::nearest_texels(
    std::span<const CornerTexcoords> corners) const {
  const std::size_t texels = std::size_t{result_.width} * result_.height;
  std::vector<std::uint32_t> nearest(texels, kNothing);
  std::vector<float> distance(texels, kUnknown);
  const TexelRange all{0, 0, result_.width, result_.height};
  const auto is_open = [&](std::uint32_t x, std::uint32_t y) { return !is_mean_(x, y); };
  const auto look = [&](std::uint32_t x, std::uint32_t y, const TexelSegment::Foot& foot) {
    const std::size_t to = std::size_t{y} * result_.width + x;
    if (foot.distance >= distance[to])
      return;
    distance[to] = static_cast<float>(foot.distance);
    const TexelPoint at{(x + 0.5 - foot.off_x) * factor_, (y + 0.5 - foot.off_y) * factor_};
    nearest[to] = static_cast<std::uint32_t>(texel_at(at, width_, height_));
  };
  for (const CornerTexcoords& triangle : corners) {
    const std::array<TexelPoint, 3> at = in_texels(triangle, result_.width, result_.height);
    if (is_mean_.is_full(near_texels(at, all)))
      continue;
    for (std::size_t k = 0; k < 3; ++k)
      TexelSegment(at[k], at[(k + 1) % 3]).for_each_near(all, is_open, look);
  }
  return nearest;
}

/// Sorts what is copied by the rows that it comes from.
void Reduction::take_copies(const std::vector<std::uint32_t>& nearest) {
  std::vector<std::size_t> begins(std::size_t{height_} + 1);
  for (const std::uint32_t from : nearest) {
    if (from != kNothing)
      ++begins[from / width_ + 1];
  }
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  copies_.resize(begins.back());
  for (std::uint32_t to = 0; to < nearest.size(); ++to) {
    if (nearest[to] != kNothing)
      copies_[begins[nearest[to] / width_]++] = {nearest[to], to};
  }
}

void Reduction::add(const images::Image& band) {
  for (std::uint32_t y = row_ / factor_; y < (row_ + band.height) / factor_; ++y) {
    if (band.channels == 4)
      is_mean_.for_each_in(y, [&](std::uint32_t x) { average<4>(band, x, y); });
    else
      is_mean_.for_each_in(y, [&](std::uint32_t x) { average<3>(band, x, y); });
  }
  const std::size_t first = std::size_t{row_} * width_;
  row_ += band.height;
  for (; copied_ < copies_.size() && copies_[copied_].from < std::size_t{row_} * width_; ++copied_)
    images::copy_texel(band.texels.data() + (copies_[copied_].from - first) * band.channels,
                       result_.texels.data() + std::size_t{copies_[copied_].to} * band.channels,
                       band.channels);
}

/// Takes the mean of what is shown of a square of texels.
template <std::uint32_t kChannels>
void Reduction::average(const images::Image& band, std::uint32_t x, std::uint32_t y) {
  FourFloats sum{};
  std::uint32_t count = factor_ * factor_;
  const auto for_each = [&](const auto& visit) {
    for (std::uint32_t j = 0; j < factor_; ++j) {
      const std::uint8_t* texel = band.at(x * factor_, y * factor_ + j - row_);
      for (std::uint32_t i = 0; i < factor_; ++i, texel += kChannels)
        visit(texel);
    }
  };
  if (is_full_(x, y)) {
    for_each([&](const std::uint8_t* texel) { sum += weighted_light(texel, kChannels, 1); });
  } else {
    TexelBits::Word shown = is_shown_.square(x * factor_, y * factor_, factor_);
    count = static_cast<std::uint32_t>(std::popcount(shown));
    for_each([&](const std::uint8_t* texel) {
      if ((shown & 1) != 0)
        sum += weighted_light(texel, kChannels, 1);
      shown >>= 1;
    });
  }
  store_texel(sum / static_cast<float>(count), result_.at(x, y), kChannels);
}

images::Image Reduction::operator()() && {
  std::vector<std::uint8_t> is_known(std::size_t{result_.width} * result_.height);
  for (std::uint32_t y = 0; y < result_.height; ++y)
    is_mean_.for_each_in(
        y, [&](std::uint32_t x) { is_known[std::size_t{y} * result_.width + x] = 1; });
  for (const Copy& copy : copies_)
    is_known[copy.to] = 1;
  fill_unknown(result_, is_known);
  return std::move(result_);
}

std::uint64_t Reduction::bytes(std::uint64_t texels, std::uint64_t reduced_texels) {
  constexpr std::uint64_t kReducedTexel = 5 + sizeof(float) + sizeof(std::uint32_t) + sizeof(Copy);
  constexpr std::uint64_t kFilledTexel = 5 + sizeof(Copy) + 1 + 8;
  return texels / 8 + reduced_texels * std::max(kReducedTexel, kFilledTexel);
}

images::Image reduced(const images::Image& image, std::span<const CornerTexcoords> corners,
                      std::uint32_t factor) {
  Reduction reduction(image.width, image.height, image.channels, corners, factor);
  reduction.add(image);
  return std::move(reduction)();
}

}  // namespace meshhier::texture
