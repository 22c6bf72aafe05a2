// Lines through the colours of a block: the endpoints and weights that UASTC stores.
//
// Problem. Which two colours, of those that a mode can store, and which weights come nearest to
// sixteen texels?
//
// Idea. The line of most variance, then one step of least squares:
//
//            . high           1. the principal axis through the mean (power iteration), as long
//          o/ o                  as the texels reach along it; its ends, rounded to the mode's
//         o/                  2. weights: each texel's nearest place on the line
//        /o o                 3. for these weights the best ends, in closed form; weights again
//     low
//
// The better one of both tries is kept.
//
// Invariant. Sums have one order, and nothing is contracted: the same bytes on every processor.
//
// Cost. About 0.2 us for a line in three channels.
#pragma once

#include "images/sixteen_floats.h"
#include "images/uastc_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace meshhier::images {

template <std::size_t kChannels>
using Channels = std::array<Sixteen, kChannels>;

/// The texels that a line is for.
struct TexelShare {
  Sixteen part = Sixteen::all(1);  ///< 1 or 0
  float count = kBlockTexels;
};

template <std::size_t kChannels>
struct Line {
  std::array<float, kChannels> low{}, high{};
};

template <std::size_t kChannels>
struct FittedLine {
  std::array<std::uint8_t, 2 * kChannels> endpoints{};  ///< stored ones: low, high of each channel
  Sixteen weights;
  Sixteen parts;    ///< the same from 0 to 1, as the format has them
  float error = 0;  ///< the sum of squares, about: a decoder rounds
};

/// Returns the parts of weights, which are whole numbers.
inline Sixteen parts_of(const Sixteen& weights, std::uint32_t bits) {
  constexpr float kWhole = 64;
  Sixteen parts;
  for (std::size_t r = 0; r < 4; ++r) {
    const FourInts w = __builtin_convertvector(weights.rows[r], FourInts);
    FourInts six;  // weight_part() of four
    switch (bits) {
      case 1:
        six = (w << 6) - w;
        break;
      case 2:
        six = (w << 4) + (w << 2) + w;
        break;
      case 3:
        six = (w << 3) + w;
        break;
      case 4:
        six = (w << 2) + (w >> 2);
        break;
      default:
        six = (w << 1) + (w >> 4);
    }
    six -= six > 32;  // true is -1
    parts.rows[r] = __builtin_convertvector(six, FourFloats) * (1 / kWhole);
  }
  return parts;
}

template <std::size_t kChannels>
Line<kChannels> principal_line(const Channels<kChannels>& texels, const TexelShare& share) {
  constexpr int kIterations = 4;
  using Vector = std::array<float, kChannels>;
  Vector mean;
  Channels<kChannels> apart;
  for (std::size_t c = 0; c < kChannels; ++c) {
    mean[c] = sum_of(texels[c] * share.part) / share.count;
    apart[c] = (texels[c] - Sixteen::all(mean[c])) * share.part;
  }
  std::array<Vector, kChannels> covariance;
  std::size_t widest = 0;
  for (std::size_t i = 0; i < kChannels; ++i) {
    for (std::size_t j = i; j < kChannels; ++j)
      covariance[i][j] = covariance[j][i] = sum_of(apart[i] * apart[j]);
    if (covariance[i][i] > covariance[widest][widest])
      widest = i;
  }
  if (!(covariance[widest][widest] > 0))
    return {mean, mean};
  Vector axis = covariance[widest];
  for (int k = 0; k < kIterations; ++k) {
    Vector next{};
    float largest = 0;
    for (std::size_t i = 0; i < kChannels; ++i) {
      for (std::size_t j = 0; j < kChannels; ++j)
        next[i] += covariance[i][j] * axis[j];
      largest = std::max(largest, std::abs(next[i]));
    }
    for (std::size_t i = 0; i < kChannels; ++i)
      axis[i] = next[i] / largest;
  }
  Sixteen along = apart[0] * Sixteen::all(axis[0]);
  float square = axis[0] * axis[0];
  for (std::size_t c = 1; c < kChannels; ++c) {
    along += apart[c] * Sixteen::all(axis[c]);
    square += axis[c] * axis[c];
  }
  const float high = largest_of(along) / square;
  const float low = -largest_of(Sixteen{} - along) / square;
  Line<kChannels> line;
  for (std::size_t c = 0; c < kChannels; ++c) {
    line.low[c] = mean[c] + axis[c] * low;
    line.high[c] = mean[c] + axis[c] * high;
  }
  return line;
}

/// A line's ends as a mode stores them.
template <std::size_t kChannels>
struct RoundedEnds {
  std::array<std::uint8_t, 2 * kChannels> stored{};  ///< low, high of each channel
  std::array<float, kChannels> low{}, way{};         ///< their values, and from low to high
};

template <std::size_t kChannels>
RoundedEnds<kChannels> rounded_ends(const Line<kChannels>& line, const UastcMode& mode) {
  const EndpointTable& table = endpoint_table(mode.range);
  const auto stored = [&](float value) {
    return table.nearest[static_cast<std::size_t>(std::clamp(value, 0.0F, 255.0F) + 0.5F)];
  };
  RoundedEnds<kChannels> ends;
  for (std::size_t c = 0; c < kChannels; ++c) {
    ends.stored[2 * c] = stored(line.low[c]);
    ends.stored[2 * c + 1] = stored(line.high[c]);
    ends.low[c] = table.values[ends.stored[2 * c]];
    ends.way[c] = table.values[ends.stored[2 * c + 1]] - ends.low[c];
  }
  return ends;
}

/// Returns the sum of squares, about: a decoder rounds.
template <std::size_t kChannels>
float error_of(const Channels<kChannels>& texels, const TexelShare& share,
               const RoundedEnds<kChannels>& ends, const Sixteen& parts) {
  Sixteen errors;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const Sixteen off = texels[c] - Sixteen::all(ends.low[c]) - parts * Sixteen::all(ends.way[c]);
    errors += off * off;
  }
  return sum_of(errors * share.part);
}

/// Rounds a line to what a mode stores, and gives each texel its weight.
template <std::size_t kChannels>
FittedLine<kChannels> rounded_line(const Channels<kChannels>& texels, const TexelShare& share,
                                   const Line<kChannels>& line, const UastcMode& mode) {
  const RoundedEnds<kChannels> ends = rounded_ends(line, mode);
  const auto top = static_cast<float>((1U << mode.weight_bits) - 1);
  float square = 0;
  for (const float way : ends.way)
    square += way * way;
  const float scale = square > 0 ? top / square : 0;
  Sixteen place = Sixteen::all(0.5F);  // truncation rounds
  for (std::size_t c = 0; c < kChannels; ++c)
    place += (texels[c] - Sixteen::all(ends.low[c])) * Sixteen::all(ends.way[c] * scale);
  FittedLine<kChannels> fitted;
  fitted.endpoints = ends.stored;
  fitted.weights = whole_of(smaller_of(larger_of(place, Sixteen{}), Sixteen::all(top + 0.5F)));
  fitted.parts = parts_of(fitted.weights, mode.weight_bits);
  fitted.error = error_of(texels, share, ends, fitted.parts);
  return fitted;
}

/// Returns the line that is nearest to the texels with these parts; false: any line is.
template <std::size_t kChannels>
bool best_line(const Channels<kChannels>& texels, const TexelShare& share, const Sixteen& parts,
               Line<kChannels>& line) {
  constexpr float kLeastDeterminant = 1e-3F;
  const Sixteen shared = parts * share.part;
  const float sum = sum_of(shared), high = sum_of(shared * shared);
  const float low = share.count - 2 * sum + high, both = sum - high;
  const float determinant = low * high - both * both;
  if (determinant < kLeastDeterminant)
    return false;
  const float inverse = 1 / determinant;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const float to_high = sum_of(shared * texels[c]);
    const float to_low = sum_of(texels[c] * share.part) - to_high;
    line.low[c] = (high * to_low - both * to_high) * inverse;
    line.high[c] = (low * to_high - both * to_low) * inverse;
  }
  return true;
}

/// Fits a line as this file's head says.
template <std::size_t kChannels>
FittedLine<kChannels> fit_line(const Channels<kChannels>& texels, const TexelShare& share,
                               const Line<kChannels>& principal, const UastcMode& mode) {
  constexpr float kFineError = 0.4F;  // a texel's; 57 dB
  FittedLine<kChannels> fitted = rounded_line(texels, share, principal, mode);
  Line<kChannels> line;
  if (fitted.error > kFineError * share.count && best_line(texels, share, fitted.parts, line)) {
    const FittedLine<kChannels> again = rounded_line(texels, share, line, mode);
    if (again.error < fitted.error)
      return again;
  }
  return fitted;
}

}  // namespace meshhier::images
