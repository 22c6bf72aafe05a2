#include "images/uastc_hints.h"

#include "base/four_floats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace meshhier::images {
namespace {

// ETC1 has two halves, each with a colour. A texel is brighter or darker than that by one of two
// steps, which the half's table says: ETC1's `intensity`.
constexpr std::array<std::array<int, 2>, 8> kSteps{
    {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}}};
constexpr std::array<float, 3> kLuma{54.0F / 256, 183.0F / 256, 19.0F / 256};
constexpr std::uint32_t kFineColours = 31, kCoarseColours = 15;

using Sum = std::array<int, 3>;

/// The sums over the quarters of a block, row by row.
std::array<Sum, 4> quarter_sums(std::span<const Rgba, kBlockTexels> texels) {
  std::array<Sum, 4> sums{};
  for (std::size_t i = 0; i < kBlockTexels; ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      sums[i / 8 * 2 + i % 4 / 2][c] += texels[i][c];
  }
  return sums;
}

Sum operator+(const Sum& a, const Sum& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

int square_distance(const Sum& a, const Sum& b) {
  int sum = 0;
  for (std::size_t c = 0; c < 3; ++c)
    sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

/// Says whether the second colour is near enough to be stored by its difference.
bool is_near(const Sum& first, const Sum& second) {
  constexpr int kLeastStep = -4, kMostStep = 3, kHalf = 8 * 255;
  const auto fine = [](int sum) {
    return (sum * static_cast<int>(kFineColours) + kHalf / 2) / kHalf;
  };
  return std::ranges::all_of(std::array{0, 1, 2}, [&](std::size_t c) {
    const int step = fine(second[c]) - fine(first[c]);
    return step >= kLeastStep && step <= kMostStep;
  });
}

/// Returns the table whose steps are nearest to how far the eight texels are from their mean.
std::uint8_t best_table(const std::array<float, 8>& apart) {
  static_assert(kSteps.size() == 8);
  constexpr auto kRows = [] {
    std::array<std::array<float, 8>, 2> rows{};
    for (std::size_t t = 0; t < 8; ++t)
      rows[0][t] = static_cast<float>(kSteps[t][0]), rows[1][t] = static_cast<float>(kSteps[t][1]);
    return rows;
  }();
  std::array<float, 8> errors{};
  for (std::size_t half = 0; half < 8; half += 4) {
    const auto small = load_four(&kRows[0][half]), large = load_four(&kRows[1][half]);
    FourFloats sum{};
    for (const float far : apart) {
      const FourFloats a = far - small, b = far - large;
      const FourFloats near = a * a, wide = b * b;
      sum += near < wide ? near : wide;
    }
    store_four(&errors[half], sum);
  }
  return static_cast<std::uint8_t>(std::ranges::min_element(errors) - errors.begin());
}

using Lumas = std::array<float, kBlockTexels>;

Lumas lumas_of(std::span<const Rgba, kBlockTexels> texels) {
  Lumas lumas;
  for (std::size_t i = 0; i < kBlockTexels; ++i)
    lumas[i] = kLuma[0] * texels[i][0] + kLuma[1] * texels[i][1] + kLuma[2] * texels[i][2];
  return lumas;
}

/// Returns the table of a half: of two rows if they are flipped, else of two columns.
std::uint8_t intensity(const Lumas& lumas, bool flip, std::size_t half) {
  std::array<float, 8> apart{};
  float sum = 0;
  for (std::size_t i = 0; i < apart.size(); ++i) {
    apart[i] = lumas[flip ? 8 * half + i : i / 2 * 4 + 2 * half + i % 2];
    sum += apart[i];
  }
  for (float& value : apart)
    value = std::abs(value - sum / 8);
  return best_table(apart);
}

/// ETC2's alpha (EAC) has steps of a table, times a factor.
std::uint8_t alpha_hint(std::span<const Rgba, kBlockTexels> texels) {
  constexpr int kTable = 0, kReach = 29;  // from -15 to 14
  constexpr int kFactorPlace = 16, kMostFactor = 15;
  int least = 255, most = 0;
  for (const Rgba& texel : texels)
    least = std::min<int>(least, texel[3]), most = std::max<int>(most, texel[3]);
  const int factor = std::clamp((most - least + kReach - 1) / kReach, 1, kMostFactor);
  return static_cast<std::uint8_t>(kFactorPlace * factor + kTable);
}

/// The best of ETC1's blocks of one colour: a step of a table above or below 5 bits a channel.
void set_solid_hints(const Rgba& colour, UastcHints& hints) {
  const auto value = [](int bits) { return bits << 3 | bits >> 2; };
  hints.difference = true;
  int least = 1 << 30;
  for (std::uint8_t table = 0; table < kSteps.size() && least > 0; ++table) {
    const auto& [small, large] = kSteps[table];
    const std::array steps{-large, -small, small, large};
    for (std::uint8_t selector = 0; selector < steps.size(); ++selector) {
      std::array<std::uint8_t, 3> bits{};
      int error = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const int wanted = std::clamp(colour[c] - steps[selector], 0, 255);
        int best = wanted * static_cast<int>(kFineColours) / 255;
        if (best < static_cast<int>(kFineColours) &&
            value(best + 1) - wanted < wanted - value(best))
          ++best;
        bits[c] = static_cast<std::uint8_t>(best);
        const int off = std::clamp(value(best) + steps[selector], 0, 255) - colour[c];
        error += off * off;
      }
      if (error < least) {
        least = error;
        hints.intensities[0] = table;
        hints.selector = selector;
        hints.colour = bits;
      }
    }
  }
}

}  // namespace

void set_hints(std::span<const Rgba, kBlockTexels> texels, UastcBlock& block) {
  UastcHints& hints = block.hints;
  if (block.mode == kSolidMode) {
    set_solid_hints(block.solid, hints);
    return;
  }
  const UastcMode& mode = uastc_mode(block.mode);
  hints.bc1_weights = mode.has_second_bc1_hint && mode.subsets == 1 && mode.planes == 1;
  const auto [a, b, c, d] = quarter_sums(texels);
  const Sum left = a + c, right = b + d, top = a + b, bottom = c + d;
  hints.flip = square_distance(top, bottom) > square_distance(left, right);
  hints.difference = hints.flip ? is_near(top, bottom) : is_near(left, right);
  const Lumas lumas = lumas_of(texels);
  for (std::size_t half = 0; half < 2; ++half)
    hints.intensities[half] = intensity(lumas, hints.flip, half);
  if (mode.has_alpha())
    hints.alpha = alpha_hint(texels);
}

}  // namespace meshhier::images
