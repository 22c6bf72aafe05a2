#include "texture/reduction.h"

#include "texture/bake.h"
#include "texture/fill.h"
#include "texture/texel_light.h"
#include "texture/texel_segment.h"

#include <algorithm>
#include <array>
#include <utility>

namespace meshhier::texture {
namespace {

constexpr float kUnknown = 1e9f;

}  // namespace

Reduction::Reduction(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                     std::span<const CornerTexcoords> corners, std::uint32_t factor)
    : width_(width),
      height_(height),
      factor_(factor),
      is_shown_(width, height, corners),
      result_(width / factor, height / factor, channels),
      distance_(std::size_t{result_.width} * result_.height, kUnknown) {
  find_means();
  find_copies(corners);
}

/// Texels of which a part is shown are means of it.
void Reduction::find_means() {
  std::size_t texel = 0;
  for (std::uint32_t y = 0; y < result_.height; ++y) {
    for (std::uint32_t x = 0; x < result_.width; ++x, ++texel) {
      for (std::uint32_t i = 0; i < factor_ * factor_ && distance_[texel] > 0; ++i) {
        if (is_shown_(x * factor_ + i % factor_, y * factor_ + i / factor_))
          distance_[texel] = 0;
      }
    }
  }
}

/// Texels beside a triangle, which filters see, have the colour of its nearest texel, although one
/// of another chart may be nearer.
void Reduction::find_copies(std::span<const CornerTexcoords> corners) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> from(distance_.size(), kNone);
  const TexelRange all{0, 0, result_.width, result_.height};
  const auto is_open = [&](std::uint32_t x, std::uint32_t y) {
    return distance_[std::size_t{y} * result_.width + x] > 0;
  };
  for (const CornerTexcoords& triangle : corners) {
    const std::array<TexelPoint, 3> at = in_texels(triangle, result_.width, result_.height);
    for (std::size_t k = 0; k < 3; ++k) {
      TexelSegment(at[k], at[(k + 1) % 3])
          .for_each_near(
              all, is_open, [&](std::uint32_t x, std::uint32_t y, const TexelSegment::Foot& foot) {
                const std::size_t to = std::size_t{y} * result_.width + x;
                if (foot.distance >= distance_[to])
                  return;
                distance_[to] = static_cast<float>(foot.distance);
                const TexelPoint nearest{(x + 0.5 - foot.off_x) * factor_,
                                         (y + 0.5 - foot.off_y) * factor_};
                from[to] = static_cast<std::uint32_t>(texel_at(nearest, width_, height_));
              });
    }
  }
  for (std::uint32_t to = 0; to < from.size(); ++to) {
    if (from[to] != kNone)
      copies_.push_back({from[to], to});
  }
  std::ranges::sort(copies_, {}, &Copy::from);
}

void Reduction::add(const images::Image& band) {
  for (std::uint32_t y = row_ / factor_; y < (row_ + band.height) / factor_; ++y) {
    for (std::uint32_t x = 0; x < result_.width; ++x) {
      if (distance_[std::size_t{y} * result_.width + x] == 0)
        average(band, x, y);
    }
  }
  const std::size_t first = std::size_t{row_} * width_;
  row_ += band.height;
  for (; copied_ < copies_.size() && copies_[copied_].from < std::size_t{row_} * width_; ++copied_)
    images::copy_texel(band.texels.data() + (copies_[copied_].from - first) * band.channels,
                       result_.texels.data() + std::size_t{copies_[copied_].to} * band.channels,
                       band.channels);
}

void Reduction::average(const images::Image& band, std::uint32_t x, std::uint32_t y) {
  TexelLight sum{};
  float count = 0;
  for (std::uint32_t j = y * factor_; j < (y + 1) * factor_; ++j) {
    for (std::uint32_t i = x * factor_; i < (x + 1) * factor_; ++i) {
      if (!is_shown_(i, j))
        continue;
      add_texel(sum, band.at(i, j - row_), band.channels, 1);
      ++count;
    }
  }
  for (float& channel : sum)
    channel /= count;
  store_texel(sum, result_.at(x, y), band.channels);
}

images::Image Reduction::operator()() && {
  std::vector<std::uint8_t> is_known(distance_.size());
  std::ranges::transform(distance_, is_known.begin(), [](float d) { return d < kUnknown; });
  fill_unknown(result_, is_known);
  return std::move(result_);
}

std::uint64_t Reduction::bytes(std::uint64_t texels, std::uint64_t reduced_texels) {
  constexpr std::uint64_t kReducedTexel = 4 + sizeof(float) + sizeof(std::uint32_t) + sizeof(Copy);
  constexpr std::uint64_t kFilledTexel = 4 + sizeof(float) + sizeof(Copy) + 1 + 8;
  return texels / 8 + reduced_texels * std::max(kReducedTexel, kFilledTexel);
}

images::Image reduced(const images::Image& image, std::span<const CornerTexcoords> corners,
                      std::uint32_t factor) {
  Reduction reduction(image.width, image.height, image.channels, corners, factor);
  reduction.add(image);
  return std::move(reduction)();
}

}  // namespace meshhier::texture
