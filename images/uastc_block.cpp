#include "images/uastc_block.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::images {
namespace {

constexpr EndpointRange k12{2, 3}, k16{4, 1}, k32{5, 1}, k40{3, 5}, k48{4, 3}, k160{5, 5},
    k192{6, 3}, k256{8, 1};

// clang-format off
constexpr std::array<UastcMode, kUastcModes> kModes{{
  //  code      weights  range  subsets, planes, channels
    {0x01, 4,   4,       k192,  1, 1, 3, Patterns::none,         true,  true},
    {0x35, 6,   2,       k256,  1, 1, 3, Patterns::none,         true,  true},
    {0x1d, 5,   3,       k16,   2, 1, 3, Patterns::two,          true,  true},
    {0x03, 5,   2,       k12,   3, 1, 3, Patterns::three,        true,  true},
    {0x13, 5,   2,       k40,   2, 1, 3, Patterns::two,          true,  true},
    {0x0b, 5,   3,       k256,  1, 1, 3, Patterns::none,         true,  true},
    {0x1b, 5,   2,       k160,  1, 2, 3, Patterns::none,         true,  true},
    {0x07, 5,   2,       k40,   2, 1, 3, Patterns::two_of_three, true,  true},
    {0x17, 5,   0,       k256,  1, 1, 4, Patterns::none,         false, false},
    {0x0f, 5,   2,       k16,   2, 1, 4, Patterns::two,          true,  true},
    {0x02, 3,   4,       k48,   1, 1, 4, Patterns::none,         false, false},
    {0x00, 2,   2,       k48,   1, 2, 4, Patterns::none,         false, false},
    {0x06, 3,   3,       k192,  1, 1, 4, Patterns::none,         false, false},
    {0x1f, 5,   1,       k256,  1, 2, 4, Patterns::none,         true,  true},
    {0x0d, 5,   2,       k256,  1, 1, 4, Patterns::none,         true,  true},
    {0x05, 7,   4,       k256,  1, 1, 2, Patterns::none,         true,  true},
    {0x15, 6,   2,       k256,  2, 1, 2, Patterns::two,          true,  true},
    {0x25, 6,   2,       k256,  1, 2, 2, Patterns::none,         true,  true},
    {0x09, 4,   5,       k32,   1, 1, 3, Patterns::none,         true,  true},
}};
// clang-format on

constexpr std::uint32_t kMostCodeBits = 7;
constexpr std::uint8_t kGreyAndAlphaPlane = 3;

/// The mode of each first seven bits; kUastcModes where there is none.
constexpr auto kModeOfBits = [] {
  std::array<std::uint8_t, 1U << kMostCodeBits> modes{};
  modes.fill(kUastcModes);
  for (std::size_t bits = 0; bits < modes.size(); ++bits) {
    for (std::uint8_t mode = 0; mode < kUastcModes; ++mode) {
      if ((bits & ((1U << kModes[mode].code_bits) - 1)) == kModes[mode].code)
        modes[bits] = mode;
    }
  }
  return modes;
}();

// Patterns are named by ASTC's seeds: those that BC7 has too. Those of `two_of_three` are patterns
// of three subsets of BC7's in which two are one.
constexpr auto kSeedsOfTwo = std::to_array<std::uint16_t>(
    {28, 20,  16,  29, 91,  9,   107, 72,  149, 204, 50,  114, 496, 17,  78,
     39, 252, 828, 43, 156, 116, 210, 476, 273, 684, 359, 246, 195, 694, 524});
constexpr auto kSeedsOfThree =
    std::to_array<std::uint16_t>({260, 74, 32, 156, 183, 15, 745, 0, 335, 902, 254});
constexpr auto kSeedsOfTwoOfThree = std::to_array<std::uint16_t>(
    {36, 48, 61, 137, 161, 183, 226, 281, 302, 307, 479, 495, 593, 594, 605, 799, 812, 988, 993});

constexpr std::uint32_t hash52(std::uint32_t p) {
  p ^= p >> 15;
  p -= p << 17;
  p += p << 7;
  p += p << 4;
  p ^= p >> 5;
  p += p << 16;
  p ^= p >> 7;
  p ^= p >> 3;
  p ^= p << 6;
  p ^= p >> 17;
  return p;
}

/// Returns ASTC's pattern: each subset has a plane over the block, which a hash of the seed
/// inclines; a texel belongs to the highest one.
Pattern astc_pattern(std::uint32_t seed, std::uint32_t subsets) {
  const std::uint32_t hash = hash52(seed + (subsets - 1) * 1024);
  const std::uint32_t by_second_bit = (seed & 2) != 0 ? 4 : 5, by_count = subsets == 3 ? 6 : 5;
  const bool is_odd = (seed & 1) != 0;
  const std::array shifts{is_odd ? by_second_bit : by_count, is_odd ? by_count : by_second_bit};
  const auto slope = [&](std::uint32_t i) {
    const std::uint32_t four = hash >> (4 * i) & 15;
    return four * four >> shifts[i % 2];
  };
  Pattern pattern{};
  for (std::uint32_t i = 0; i < kBlockTexels; ++i) {
    const std::uint32_t x = 2 * (i % kBlockSide), y = 2 * (i / kBlockSide);
    std::uint32_t highest = 0;
    for (std::uint32_t s = 0; s < subsets; ++s) {
      const std::uint32_t height =
          (slope(2 * s) * x + slope(2 * s + 1) * y + (hash >> (14 - 4 * s))) & 63;
      if (s > 0 && height <= highest)
        continue;
      highest = height;
      pattern[i] = static_cast<std::uint8_t>(s);
    }
  }
  return pattern;
}

template <std::size_t kCount>
std::vector<Pattern> patterns_of_seeds(const std::array<std::uint16_t, kCount>& seeds,
                                       std::uint32_t subsets) {
  std::vector<Pattern> patterns;
  for (const std::uint16_t seed : seeds)
    patterns.push_back(astc_pattern(seed, subsets));
  return patterns;
}

/// How a stored endpoint with a digit becomes a value (ASTC, 23.12): the letters are its bits from
/// the second on, and the digit counts `step`.
struct DigitRule {
  EndpointRange range;
  std::string_view bits;
  std::uint32_t step;
};
constexpr auto kDigitRules = std::to_array<DigitRule>({{k12, "b000b0bb0", 93},
                                                       {k40, "cb0000cbc", 26},
                                                       {k48, "dcb000dcb", 22},
                                                       {k160, "edcb0000e", 6},
                                                       {k192, "fedcb000f", 5}});

std::uint8_t value_of_digit(const DigitRule& rule, std::uint32_t stored) {
  std::uint32_t spread = 0;
  for (const char letter : rule.bits)
    spread = 2 * spread + (letter == '0' ? 0 : stored >> (letter - 'a') & 1);
  const std::uint32_t mirror = (stored & 1) != 0 ? 511 : 0;
  const std::uint32_t value = ((stored >> rule.range.bits) * rule.step + spread) ^ mirror;
  return static_cast<std::uint8_t>((mirror & 128) | value >> 2);
}

std::uint8_t value_of_bits(std::uint32_t bits, std::uint32_t stored) {
  return static_cast<std::uint8_t>(stored << (8 - bits) | stored >> (2 * bits - 8));
}

std::uint8_t endpoint_value(const EndpointRange& range, std::uint32_t stored) {
  for (const DigitRule& rule : kDigitRules) {
    if (rule.range.levels() == range.levels())
      return value_of_digit(rule, stored);
  }
  return value_of_bits(range.bits, stored);
}

EndpointTable table_of(const EndpointRange& range) {
  EndpointTable table;
  for (std::uint32_t stored = 0; stored < range.levels(); ++stored)
    table.values[stored] = endpoint_value(range, stored);
  const auto distance = [&](int value, std::uint32_t stored) {
    const int found = table.values[stored];
    return 2 * std::abs(found - value) + (found > value ? 1 : 0);
  };
  for (int value = 0; value < 256; ++value) {
    std::uint32_t best = 0;
    for (std::uint32_t stored = 1; stored < range.levels(); ++stored)
      best = distance(value, stored) < distance(value, best) ? stored : best;
    table.nearest[static_cast<std::size_t>(value)] = static_cast<std::uint8_t>(best);
  }
  return table;
}

/// The 128 bits of a block, the lowest first.
class Bits {
 public:
  void put(std::uint64_t value, std::uint32_t count) {
    words_[at_ / 64] |= value << (at_ % 64);
    if (at_ % 64 + count > 64)
      words_[1] |= value >> (64 - at_ % 64);
    at_ += count;
  }
  std::uint8_t take(std::uint32_t count) {
    std::uint64_t value = words_[at_ / 64] >> (at_ % 64);
    if (at_ % 64 + count > 64)
      value |= words_[1] << (64 - at_ % 64);
    at_ += count;
    return static_cast<std::uint8_t>(value & ((1U << count) - 1));
  }
  void load(const std::byte* bytes) { std::memcpy(words_.data(), bytes, sizeof words_); }
  UastcBytes bytes() const {
    UastcBytes bytes;
    std::memcpy(bytes.data(), words_.data(), sizeof words_);
    return bytes;
  }

 private:
  std::array<std::uint64_t, 2> words_{};
  std::uint32_t at_ = 0;
};

/// Calls `field(number, bits)` for each hint that a mode has, in their order.
template <class Hints, class Field>
void walk_hints(const UastcMode& mode, Hints& hints, const Field& field) {
  field(hints.bc1_endpoints, 1);
  if (mode.has_second_bc1_hint)
    field(hints.bc1_weights, 1);
  field(hints.flip, 1);
  field(hints.difference, 1);
  for (auto& intensity : hints.intensities)
    field(intensity, 3);
  if (mode.has_etc1_bias)
    field(hints.bias, 5);
  if (mode.has_alpha())
    field(hints.alpha, 8);
}

template <class Block, class Field>
void walk_solid(Block& block, const Field& field) {
  for (auto& channel : block.solid)
    field(channel, 8);
  field(block.hints.difference, 1);
  field(block.hints.intensities[0], 3);
  field(block.hints.selector, 2);
  for (auto& channel : block.hints.colour)
    field(channel, 5);
}

/// Calls it for the number of the pattern, or of the second plane.
template <class Block, class Field>
void walk_choice(const UastcMode& mode, Block& block, const Field& field) {
  if (mode.patterns != Patterns::none)
    field(block.pattern, mode.patterns == Patterns::three ? 4 : 5);
  else if (mode.planes == 2 && mode.channels > 2)
    field(block.plane_channel, 2);
}

/// Returns the bits of `count` digits that share a number.
std::uint32_t digit_bits(std::uint32_t base, std::size_t count) {
  constexpr std::array<std::uint8_t, 6> kOfThree{0, 2, 4, 5, 7, 8}, kOfFive{0, 3, 5, 7, 0, 0};
  return base == 3 ? kOfThree[count] : kOfFive[count];
}

std::size_t digits_together(std::uint32_t base) {
  return base == 3 ? 5 : 3;
}

void put_endpoints(const UastcMode& mode, const UastcBlock& block, Bits& bits) {
  const EndpointRange range = mode.range;
  const std::size_t count = mode.endpoints(), together = digits_together(range.base);
  for (std::size_t first = 0; range.base > 1 && first < count; first += together) {
    const std::size_t end = std::min(first + together, count);
    std::uint32_t number = 0;
    for (std::size_t i = end; i-- > first;)
      number = range.base * number + (std::uint32_t{block.endpoints[i]} >> range.bits);
    bits.put(number, digit_bits(range.base, end - first));
  }
  for (std::size_t i = 0; i < count; ++i)
    bits.put(block.endpoints[i] & ((1U << range.bits) - 1), range.bits);
}

void take_endpoints(const UastcMode& mode, Bits& bits, UastcBlock& block) {
  const EndpointRange range = mode.range;
  const std::size_t count = mode.endpoints(), together = digits_together(range.base);
  for (std::size_t first = 0; range.base > 1 && first < count; first += together) {
    const std::size_t end = std::min(first + together, count);
    std::uint32_t number = bits.take(digit_bits(range.base, end - first));
    for (std::size_t i = first; i < end; ++i, number /= range.base)
      block.endpoints[i] = static_cast<std::uint8_t>(number % range.base << range.bits);
  }
  for (std::size_t i = 0; i < count; ++i)
    block.endpoints[i] |= bits.take(range.bits);
}

/// Returns the weights that lack their top bit, a bit each.
std::uint32_t anchor_weights(const UastcMode& mode, const UastcBlock& block) {
  if (mode.planes == 2)
    return 3;
  std::uint32_t found = 1;
  if (mode.subsets > 1) {
    const auto anchors = anchors_of(pattern_of(mode.patterns, block.pattern));
    for (std::size_t s = 0; s < mode.subsets; ++s)
      found |= 1U << anchors[s];
  }
  return found;
}

/// Calls `field(weight, bits)` for all weights.
template <class Block, class Field>
void walk_weights(const UastcMode& mode, Block& block, const Field& field) {
  const std::uint32_t anchors = anchor_weights(mode, block);
  for (std::size_t i = 0; i < mode.weights(); ++i)
    field(block.weights[i], mode.weight_bits - (anchors >> i & 1));
}

constexpr Pattern kOneSubset{};

/// Returns both ends of each subset's line.
std::array<std::array<Rgba, 2>, kMostSubsets> lines_of(const UastcMode& mode,
                                                       const UastcBlock& block) {
  const EndpointTable& table = endpoint_table(mode.range);
  std::array<std::array<Rgba, 2>, kMostSubsets> lines;
  for (std::size_t s = 0; s < mode.subsets; ++s) {
    for (std::size_t end = 0; end < 2; ++end) {
      const auto value = [&](std::size_t c) {
        return table.values[block.endpoints[2 * (s * mode.channels + c) + end]];
      };
      lines[s][end] = mode.channels == 2 ? Rgba{value(0), value(0), value(0), value(1)}
                                         : Rgba{value(0), value(1), value(2),
                                                mode.channels == 4 ? value(3) : std::uint8_t{255}};
    }
  }
  return lines;
}

}  // namespace

const UastcMode& uastc_mode(std::uint8_t mode) {
  return kModes[mode];
}

std::span<const Pattern> patterns_of(Patterns list) {
  static const std::array<std::vector<Pattern>, 4> lists{
      std::vector<Pattern>{}, patterns_of_seeds(kSeedsOfTwo, 2),
      patterns_of_seeds(kSeedsOfThree, 3), patterns_of_seeds(kSeedsOfTwoOfThree, 2)};
  return lists[static_cast<std::size_t>(list)];
}

const Pattern& pattern_of(Patterns list, std::uint8_t number) {
  return list == Patterns::none ? kOneSubset : patterns_of(list)[number];
}

std::array<std::uint8_t, kMostSubsets> anchors_of(const Pattern& pattern) {
  std::array<std::uint8_t, kMostSubsets> anchors{};
  for (std::uint8_t i = kBlockTexels; i-- > 0;)
    anchors[pattern[i]] = i;
  return anchors;
}

const EndpointTable& endpoint_table(const EndpointRange& range) {
  static const std::array kTables{table_of(k12), table_of(k16),  table_of(k32),  table_of(k40),
                                  table_of(k48), table_of(k160), table_of(k192), table_of(k256)};
  constexpr std::array kRanges{k12, k16, k32, k40, k48, k160, k192, k256};
  std::size_t i = 0;
  while (kRanges[i].levels() != range.levels())
    ++i;
  return kTables[i];
}

void orient(UastcBlock& block) {
  const UastcMode& mode = kModes[block.mode];
  const std::uint32_t top = (1U << mode.weight_bits) - 1;
  const Pattern& pattern = pattern_of(mode.patterns, block.pattern);
  const auto anchors = anchors_of(pattern);
  for (std::size_t s = 0; s < mode.subsets; ++s) {
    for (std::size_t plane = 0; plane < mode.planes; ++plane) {
      if (2 * block.weights[anchors[s] * mode.planes + plane] <= top)
        continue;
      for (std::size_t i = 0; i < kBlockTexels; ++i) {
        std::uint8_t& weight = block.weights[i * mode.planes + plane];
        if (pattern[i] == s)
          weight = static_cast<std::uint8_t>(top - weight);
      }
      for (std::size_t c = 0; c < mode.channels; ++c) {
        const bool in_second =
            mode.planes == 2 && c + (mode.channels == 2 ? 2 : 0) == block.plane_channel;
        std::uint8_t* const pair = &block.endpoints[2 * (s * mode.channels + c)];
        if (mode.planes == 1 || in_second == (plane == 1))
          std::swap(pair[0], pair[1]);
      }
    }
  }
}

UastcBytes pack_block(const UastcBlock& block) {
  const UastcMode& mode = kModes[block.mode];
  Bits bits;
  const auto put = [&](auto field, std::uint32_t count) {
    assert(static_cast<std::uint32_t>(field) < 1U << count);
    bits.put(field, count);
  };
  put(mode.code, mode.code_bits);
  if (block.mode == kSolidMode) {
    walk_solid(block, put);
    return bits.bytes();
  }
  walk_hints(mode, block.hints, put);
  walk_choice(mode, block, put);
  put_endpoints(mode, block, bits);
  walk_weights(mode, block, put);
  return bits.bytes();
}

std::optional<UastcBlock> unpack_block(std::span<const std::byte, kUastcBlockBytes> bytes) {
  Bits bits;
  bits.load(bytes.data());
  UastcBlock block;
  block.mode = kModeOfBits[std::to_integer<std::size_t>(bytes[0]) & (kModeOfBits.size() - 1)];
  if (block.mode == kUastcModes)
    return std::nullopt;
  const UastcMode& mode = kModes[block.mode];
  const auto take = [&]<class Field>(Field& field, std::uint32_t count) {
    field = static_cast<Field>(bits.take(count));
  };
  bits.take(mode.code_bits);
  if (block.mode == kSolidMode) {
    walk_solid(block, take);
    return block;
  }
  walk_hints(mode, block.hints, take);
  block.plane_channel = kGreyAndAlphaPlane;
  walk_choice(mode, block, take);
  if (mode.patterns != Patterns::none && block.pattern >= patterns_of(mode.patterns).size())
    return std::nullopt;
  take_endpoints(mode, bits, block);
  walk_weights(mode, block, take);
  return block;
}

std::array<Rgba, kBlockTexels> texels_of(const UastcBlock& block) {
  std::array<Rgba, kBlockTexels> texels;
  if (block.mode == kSolidMode) {
    texels.fill(block.solid);
    return texels;
  }
  const UastcMode& mode = kModes[block.mode];
  const Pattern& pattern = pattern_of(mode.patterns, block.pattern);
  const auto lines = lines_of(mode, block);
  for (std::size_t i = 0; i < kBlockTexels; ++i) {
    const auto& [low, high] = lines[pattern[i]];
    const std::uint8_t* const weights = &block.weights[i * mode.planes];
    for (std::size_t c = 0; c < 4; ++c) {
      const bool in_second = mode.planes == 2 && c == block.plane_channel;
      texels[i][c] =
          between(low[c], high[c], weight_part(weights[in_second ? 1 : 0], mode.weight_bits));
    }
  }
  return texels;
}

}  // namespace meshhier::images
