#include "texture/texel_fit.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace meshhier::texture {
namespace {

/// A viewer that filters gives a texel's light these weights in the mean around its own middle, and
/// around that of a texel beside it.
constexpr float kOwn = 4.0f / 6, kBeside = 1.0f / 6;

/// More iterations come nearer to least squares, but make noise of the finer pictures stronger from
/// level to level.
constexpr int kIterations = 2;

FourFloats weighted(FourFloats before, FourFloats own, FourFloats behind) {
  return kOwn * own + kBeside * (before + behind);
}

class Fitting {
 public:
  Fitting(TexelMeans& all, const TexelRange& range)
      : all_(all),
        range_(range),
        width_(range.right - range.left),
        height_(range.bottom - range.top),
        is_known_(width_ * height_),
        means_(width_ * height_) {
    for_each([&](std::size_t here, std::size_t in_all) {
      is_known_[here] = all_.is_known[in_all];
      means_[here] = load_four(&all_.lights[in_all]);
    });
    texels_ = across_ = means_;
  }

  /// Richardson's iteration.
  void operator()() {
    for (int i = 0; i < kIterations; ++i) {
      filter_rows();
      correct();
    }
    for_each([&](std::size_t here, std::size_t in_all) {
      store_four(&all_.lights[in_all], texels_[here]);
    });
  }

 private:
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t y = 0; y < height_; ++y) {
      const std::size_t in_all = (range_.top + y) * all_.width + range_.left;
      for (std::size_t x = 0; x < width_; ++x)
        visit(y * width_ + x, in_all + x);
    }
  }
  /// A texel beside a texel, or that one itself if there is none.
  std::size_t beside(std::size_t texel, bool is_inside, std::size_t other) const {
    return is_inside && is_known_[other] != 0 ? other : texel;
  }

  void filter_rows() {
    for (std::size_t y = 0, at = 0; y < height_; ++y) {
      for (std::size_t x = 0; x < width_; ++x, ++at) {
        if (is_known_[at] != 0)
          across_[at] = weighted(texels_[beside(at, x > 0, at - 1)], texels_[at],
                                 texels_[beside(at, x + 1 < width_, at + 1)]);
      }
    }
  }

  /// Adds to the texels what their filtered ones lack of the means.
  void correct() {
    for (std::size_t y = 0, at = 0; y < height_; ++y) {
      for (std::size_t x = 0; x < width_; ++x, ++at) {
        if (is_known_[at] == 0)
          continue;
        const FourFloats filtered = weighted(across_[beside(at, y > 0, at - width_)], across_[at],
                                             across_[beside(at, y + 1 < height_, at + width_)]);
        const FourFloats texel = texels_[at] + means_[at] - filtered;
        const FourFloats least{}, most = least + 1;
        texels_[at] = texel < least ? least : texel > most ? most : texel;
      }
    }
  }

  TexelMeans& all_;
  const TexelRange& range_;
  std::size_t width_, height_;
  std::vector<std::uint8_t> is_known_;
  std::vector<FourFloats> means_, texels_, across_;
};

}  // namespace

void fit_texels(TexelMeans& means, const TexelRange& range) {
  if (range.left < range.right && range.top < range.bottom)
    Fitting(means, range)();
}

}  // namespace meshhier::texture
