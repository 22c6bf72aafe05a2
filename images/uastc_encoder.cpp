#include "images/uastc_encoder.h"

#include "images/uastc_hints.h"
#include "images/uastc_subsets.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace meshhier::images {
namespace {

constexpr float kShortLine = 10;  ///< its widest channel; below it the finest endpoints count
constexpr float kLongLine = 40;   ///< from it on the finest weights count

/// The bytes that a block takes in a packed file, about: new ones, those with weights that were
/// before, those of one colour.
constexpr float kNewBytes = 15, kReusedBytes = 9, kSolidBytes = 7;

constexpr std::uint8_t kShortMode = 5, kLongMode = 18, kPlaneMode = 6, kFineSubsetMode = 2,
                       kAlphaMode = 10, kShortAlphaMode = 12, kAlphaPlaneMode = 11;

// A decoder cuts what is behind the point, after it has multiplied by 257 / 256: values are raised
// so that this rounds.
constexpr float kFactor = 255.0F / 256, kRounding = 0.5F;

/// Returns the texels of a block, each channel for itself.
template <std::size_t kChannels>
Channels<kChannels> channels_of(std::span<const Rgba, kBlockTexels> texels) {
  Channels<kChannels> channels;
  for (std::size_t i = 0; i < kBlockTexels; ++i) {
    for (std::size_t c = 0; c < kChannels; ++c)
      channels[c].rows[i / 4][i % 4] = static_cast<float>(texels[i][c]) * kFactor + kRounding;
  }
  return channels;
}

template <std::size_t kChannels>
void put_line(const FittedLine<kChannels>& line, std::size_t at, UastcBlock& block) {
  std::ranges::copy(line.endpoints, block.endpoints.begin() + static_cast<std::ptrdiff_t>(at));
}

void put_weights(const Sixteen& weights, std::size_t first, std::size_t step, UastcBlock& block) {
  for (std::size_t i = 0; i < kBlockTexels; ++i)
    block.weights[first + i * step] = static_cast<std::uint8_t>(weights[i]);
}

/// Keeps the better one.
void keep_better(const UastcCandidate& other, UastcCandidate& best) {
  if (other.error < best.error)
    best = other;
}

template <std::size_t kChannels>
UastcCandidate with_one_line(const Channels<kChannels>& texels, const Line<kChannels>& principal,
                             std::uint8_t mode) {
  const auto line = fit_line(texels, {}, principal, uastc_mode(mode));
  UastcCandidate made;
  made.error = line.error;
  made.block.mode = mode;
  put_line(line, 0, made.block);
  put_weights(line.weights, 0, 1, made.block);
  return made;
}

/// Returns the channel that a block of one line is farthest off in.
template <std::size_t kChannels>
std::size_t worst_channel(const Channels<kChannels>& texels, const UastcBlock& block) {
  const UastcMode& mode = uastc_mode(block.mode);
  const EndpointTable& table = endpoint_table(mode.range);
  Sixteen parts;
  for (std::size_t i = 0; i < kBlockTexels; ++i)
    parts.rows[i / 4][i % 4] = static_cast<float>(block.weights[i]);
  parts = parts_of(parts, mode.weight_bits);
  std::size_t worst = 0;
  float most = -1;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const float low = table.values[block.endpoints[2 * c]];
    const float way = table.values[block.endpoints[2 * c + 1]] - low;
    const Sixteen off = texels[c] - Sixteen::all(low) - parts * Sixteen::all(way);
    const float error = sum_of(off * off);
    if (error > most)
      most = error, worst = c;
  }
  return worst;
}

/// Fits a channel for itself, and a line through the others.
template <std::size_t kChannels>
UastcCandidate with_two_planes(const Channels<kChannels>& texels, std::size_t second,
                               std::uint8_t mode) {
  Channels<kChannels - 1> others;
  std::array<std::size_t, kChannels - 1> numbers{};
  for (std::size_t c = 0, at = 0; c < kChannels; ++c) {
    if (c != second)
      numbers[at] = c, others[at++] = texels[c];
  }
  const Channels<1> alone{texels[second]};
  const UastcMode& row = uastc_mode(mode);
  const auto line = fit_line(others, {}, principal_line(others, {}), row);
  const auto own = fit_line(alone, {}, principal_line(alone, {}), row);
  UastcCandidate made;
  made.error = line.error + own.error;
  made.block.mode = mode;
  made.block.plane_channel = static_cast<std::uint8_t>(second);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t end = 0; end < 2; ++end)
      made.block.endpoints[2 * numbers[i] + end] = line.endpoints[2 * i + end];
  }
  put_line(own, 2 * second, made.block);
  put_weights(line.weights, 0, 2, made.block);
  put_weights(own.weights, 1, 2, made.block);
  return made;
}

UastcCandidate with_two_lines(const Channels<3>& texels, const MaskedPattern& pattern) {
  const UastcMode& mode = uastc_mode(pattern.mode);
  UastcCandidate made;
  made.error = 0;
  made.block.mode = pattern.mode;
  made.block.pattern = pattern.number;
  for (std::size_t s = 0; s < 2; ++s) {
    const std::uint32_t mask = s == 1 ? pattern.mask : ~pattern.mask & 0xffffU;
    const TexelShare share = share_of(mask);
    const auto line = fit_line(texels, share, principal_line(texels, share), mode);
    made.error += line.error;
    put_line(line, 6 * s, made.block);
    for (std::size_t i = 0; i < kBlockTexels; ++i) {
      if ((mask >> i & 1) != 0)
        made.block.weights[i] = static_cast<std::uint8_t>(line.weights[i]);
    }
  }
  return made;
}

/// Returns the length of the line's widest channel.
template <std::size_t kChannels>
float width_of(const Line<kChannels>& line) {
  float width = 0;
  for (std::size_t c = 0; c < kChannels; ++c)
    width = std::max(width, std::abs(line.high[c] - line.low[c]));
  return width;
}

/// Returns the best of new blocks.
UastcCandidate best_opaque(const Channels<3>& texels, const Line<3>& principal,
                           const UastcEffort& effort) {
  const float width = width_of(principal);
  UastcCandidate best = with_one_line(texels, principal, kReusedMode);
  if (width < kShortLine)
    keep_better(with_one_line(texels, principal, kShortMode), best);
  if (width > kLongLine)
    keep_better(with_one_line(texels, principal, kLongMode), best);
  if (best.error > effort.plane_error)
    keep_better(with_two_planes(texels, worst_channel(texels, best.block), kPlaneMode), best);
  if (best.error > effort.subset_error) {
    std::array<MaskedPattern, kMostPatternTries> all;
    const auto patterns = std::span(all).first(effort.pattern_tries);
    nearest_patterns(texels, principal, patterns);
    for (const MaskedPattern& pattern : patterns) {
      keep_better(with_two_lines(texels, pattern), best);
      if (effort.fine_weights && pattern.mode == kSubsetMode)
        keep_better(with_two_lines(texels, {kFineSubsetMode, pattern.number, pattern.mask}), best);
    }
  }
  return best;
}

UastcCandidate best_transparent(const Channels<4>& texels, const UastcEffort& effort) {
  const Line<4> principal = principal_line(texels, {});
  UastcCandidate best = with_one_line(texels, principal, kAlphaMode);
  if (width_of(principal) < kLongLine)
    keep_better(with_one_line(texels, principal, kShortAlphaMode), best);
  if (best.error > effort.plane_error)
    keep_better(with_two_planes(texels, worst_channel(texels, best.block), kAlphaPlaneMode), best);
  return best;
}

/// The texels' places along their line, less their mean.
struct Places {
  Sixteen along;
  float square;  ///< that of the line's length, by which the places are too large
};

Places places_along(const Channels<3>& texels, const Line<3>& line) {
  Places places{{}, 0};
  for (std::size_t c = 0; c < 3; ++c) {
    const float way = line.high[c] - line.low[c];
    places.along += texels[c] * Sixteen::all(way);
    places.square += way * way;
  }
  places.along -= Sixteen::all(sum_of(places.along) / kBlockTexels);
  return places;
}

/// Returns a block with these weights, and the endpoints that are best with them.
UastcCandidate with_weights(const Channels<3>& texels, const RecentWeights::Set& set) {
  UastcCandidate made;
  Line<3> line;
  if (!best_line(texels, {}, set.parts, line))
    return made;
  const auto ends = rounded_ends(line, uastc_mode(kReusedMode));
  made.error = error_of(texels, {}, ends, set.parts);
  made.block.mode = kReusedMode;
  std::ranges::copy(ends.stored, made.block.endpoints.begin());
  std::ranges::copy(set.weights, made.block.weights.begin());
  return made;
}

/// Returns a block of the mean colour.
UastcCandidate with_one_colour(const Channels<3>& texels) {
  constexpr float kRoundingError = 3 * kBlockTexels / 12.0F;
  UastcCandidate made;
  made.error = kRoundingError;
  made.block.solid[3] = 255;
  for (std::size_t c = 0; c < 3; ++c) {
    const float mean = sum_of(texels[c]) / kBlockTexels;
    const Sixteen off = texels[c] - Sixteen::all(mean);
    made.error += sum_of(off * off);
    made.block.solid[c] = static_cast<std::uint8_t>((mean - kRounding) / kFactor + 0.5F);
  }
  return made;
}

}  // namespace

void UastcEncoder::try_weights(const Channels<3>& texels, const Line<3>& principal,
                               UastcCandidate& best) const {
  const auto [along, square] = places_along(texels, principal);
  const auto [set, alike] = recent_.most_alike(along);
  // No endpoints make good what lies in no weight's way.
  const float bytes = kReusedBytes * effort_.byte_error;
  if (set == nullptr || sum_of(along * along) - alike * alike > (best.error - bytes) * square)
    return;
  UastcCandidate reused = with_weights(texels, *set);
  reused.error += bytes;
  keep_better(reused, best);
}

UastcBlock UastcEncoder::encode_opaque(std::span<const Rgba, kBlockTexels> texels) {
  const Channels<3> channels = channels_of<3>(texels);
  const Line<3> principal = principal_line(channels, {});
  UastcCandidate best = best_opaque(channels, principal, effort_);
  best.error += kNewBytes * effort_.byte_error;
  const float new_error = best.error;
  if (effort_.byte_error > 0) {
    try_weights(channels, principal, best);
    const float width = width_of(principal);
    if (width * width / 2 < best.error) {
      UastcCandidate solid = with_one_colour(channels);
      solid.error += kSolidBytes * effort_.byte_error;
      keep_better(solid, best);
    }
  }
  orient(best.block);
  if (best.error == new_error && best.block.mode == kReusedMode)
    recent_.add(best.block);
  return best.block;
}

UastcBlock UastcEncoder::encode(std::span<const Rgba, kBlockTexels> texels) {
  UastcBlock block;
  if (std::ranges::all_of(texels, [&](const Rgba& texel) { return texel == texels[0]; })) {
    block.solid = texels[0];
  } else if (std::ranges::all_of(texels, [](const Rgba& texel) { return texel[3] == 255; })) {
    block = encode_opaque(texels);
  } else {
    block = best_transparent(channels_of<4>(texels), effort_).block;
    orient(block);
  }
  set_hints(texels, block);
  return block;
}

}  // namespace meshhier::images
