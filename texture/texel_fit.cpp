#include "texture/texel_fit.h"

#include <algorithm>
#include <cstddef>

namespace meshhier::texture {
namespace {

/// A viewer that filters gives a texel's light these weights in the mean around its own middle, and
/// around that of a texel beside it.
constexpr float kOwn = 4.0f / 6, kBeside = 1.0f / 6;

/// Those of Richardson's iteration. More of them come nearer to least squares, but make noise of
/// the finer pictures stronger from level to level.
constexpr std::size_t kIterations = 2;

FourFloats weighted(FourFloats before, FourFloats own, FourFloats behind) {
  return kOwn * own + kBeside * (before + behind);
}

/// Rows of a chart pass through all iterations one after the other:
///
///     row y       comes in, is filtered along itself for the first iteration
///     row y - 1   is corrected by it and those above and below: comes in for the second
///     row y - 2   is corrected by the second, and is done
///
/// So a few rows are held, and none of the picture twice.
class Fitting {
 public:
  Fitting(TexelMeans& means, const TexelRange& range)
      : means_(means),
        range_(range),
        width_(range.right - range.left),
        height_(range.bottom - range.top),
        rows_(width_ * kIterations * (kTexelRows + kAcrossRows)) {}

  void operator()() {
    for (std::size_t come = 0; come < height_ + kIterations; ++come) {
      for (std::size_t step = 0; step < std::min(come + 1, kIterations); ++step) {
        const std::size_t y = come - step;
        if (y < height_)
          filter(step, y);
        if (y > 0 && y <= height_)
          correct(step, y - 1);
      }
    }
  }

 private:
  static constexpr std::size_t kTexelRows = 2, kAcrossRows = 3;

  std::size_t begin_of(std::size_t y) const {
    return (range_.top + y) * means_.width + range_.left;
  }
  const std::uint8_t* known(std::size_t y) const { return &means_.is_known[begin_of(y)]; }
  /// A row before a step, or after all of them: the first and the last one are in place.
  TexelLight* texels(std::size_t step, std::size_t y) {
    return step % kIterations == 0 ? &means_.lights[begin_of(y)]
                                   : kept(step * kTexelRows + y % kTexelRows);
  }
  /// A row that a step has filtered along itself.
  TexelLight* across(std::size_t step, std::size_t y) {
    return kept(kIterations * kTexelRows + step * kAcrossRows + y % kAcrossRows);
  }
  TexelLight* kept(std::size_t row) { return &rows_[row * width_]; }

  void filter(std::size_t step, std::size_t y) {
    const std::uint8_t* is_known = known(y);
    const TexelLight* from = texels(step, y);
    TexelLight* to = across(step, y);
    for (std::size_t x = 0; x < width_; ++x) {
      if (is_known[x] == 0)
        continue;
      const std::size_t before = x > 0 && is_known[x - 1] != 0 ? x - 1 : x;
      const std::size_t behind = x + 1 < width_ && is_known[x + 1] != 0 ? x + 1 : x;
      store_four(&to[x],
                 weighted(load_four(&from[before]), load_four(&from[x]), load_four(&from[behind])));
    }
  }

  /// Adds to the texels what their filtered ones lack of the means.
  void correct(std::size_t step, std::size_t y) {
    const std::size_t above = y > 0 ? y - 1 : y, below = y + 1 < height_ ? y + 1 : y;
    const std::uint8_t *is_known = known(y), *is_above = known(above), *is_below = known(below);
    const TexelLight *own = across(step, y), *over = across(step, above),
                     *under = across(step, below);
    const TexelLight *from = texels(step, y), *means = texels(0, y);
    TexelLight* to = texels(step + 1, y);
    for (std::size_t x = 0; x < width_; ++x) {
      if (is_known[x] == 0)
        continue;
      const FourFloats filtered =
          weighted(load_four(is_above[x] != 0 ? &over[x] : &own[x]), load_four(&own[x]),
                   load_four(is_below[x] != 0 ? &under[x] : &own[x]));
      const FourFloats texel = load_four(&from[x]) + load_four(&means[x]) - filtered;
      const FourFloats least{}, most = least + 1;
      store_four(&to[x], texel < least ? least : texel > most ? most : texel);
    }
  }

  TexelMeans& means_;
  const TexelRange& range_;
  std::size_t width_, height_;
  std::vector<TexelLight> rows_;
};

}  // namespace

void fit_texels(TexelMeans& means, const TexelRange& range) {
  if (range.left < range.right && range.top < range.bottom)
    Fitting(means, range)();
}

}  // namespace meshhier::texture
