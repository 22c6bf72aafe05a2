// UASTC LDR 4x4 of Basis Universal: 4 x 4 texels in 16 bytes, in one of 19 modes.
//
// Problem. Graphics devices know blocks of different kinds (ASTC, BC7, ETC2, ...). UASTC is a
// block that becomes each of them with little work, as it holds what ASTC and BC7 have in common.
//
// Idea. A texel lies on a line between two colours, its endpoints, at a place that its weight
// says. A mode says how finely both are stored, how many lines there are (subsets: a pattern tells
// each texel its line), and whether a channel has weights of its own (a second plane):
//
//       bit 0                                                                       bit 127
//       | mode | hints | pattern or plane | endpoints, as ASTC packs them | weights | unused |
//
// The hints tell a transcoder what ETC1, BC1 and EAC blocks it makes. The first texel of each
// subset, its anchor, has a weight in the lower half, whose top bit is left out.
//
// Invariant. pack_block() and unpack_block() undo each other. What is unpacked is within its
// tables' bounds.
//
// The format is that of the published "UASTC LDR 4x4 Texture Specification"; patterns, weights and
// endpoints are those of ASTC (Khronos Data Format Specification 1.3, chapter 23).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace meshhier::images {

inline constexpr std::uint32_t kBlockSide = 4;
inline constexpr std::size_t kBlockTexels = 16;
inline constexpr std::size_t kUastcBlockBytes = 16;
inline constexpr std::size_t kMostSubsets = 3;

using UastcBytes = std::array<std::byte, kUastcBlockBytes>;
using Rgba = std::array<std::uint8_t, 4>;
/// A subset for each texel, row by row.
using Pattern = std::array<std::uint8_t, kBlockTexels>;

/// The lists of patterns that modes choose from.
enum class Patterns : std::uint8_t { none, two, three, two_of_three };

/// Endpoint values: bits, and with a base of 3 or 5 a digit above them.
struct EndpointRange {
  std::uint8_t bits, base;  ///< base: 1, 3 or 5
  constexpr std::uint32_t levels() const { return std::uint32_t{base} << bits; }
};

struct UastcMode {
  std::uint8_t code, code_bits;
  std::uint8_t weight_bits;
  EndpointRange range;
  std::uint8_t subsets, planes;
  std::uint8_t channels;  ///< channels with endpoints: 2 (grey and alpha), 3 or 4
  Patterns patterns;
  bool has_second_bc1_hint, has_etc1_bias;

  constexpr bool has_alpha() const { return channels != 3; }
  constexpr std::size_t endpoints() const { return std::size_t{2} * channels * subsets; }
  constexpr std::size_t weights() const { return kBlockTexels * planes; }
};

inline constexpr std::uint8_t kUastcModes = 19, kSolidMode = 8;
/// Returns the mode of that number; in kSolidMode's row only the code counts.
const UastcMode& uastc_mode(std::uint8_t mode);

/// Return the patterns of a list, and the anchors of a pattern's subsets.
std::span<const Pattern> patterns_of(Patterns list);
std::array<std::uint8_t, kMostSubsets> anchors_of(const Pattern& pattern);

/// Returns the pattern of a block, all of subset 0 where there is none.
const Pattern& pattern_of(Patterns list, std::uint8_t number);

/// The values of endpoints: what a stored one means, and which one is nearest to a value.
struct EndpointTable {
  std::array<std::uint8_t, 256> values{};   ///< of each stored one
  std::array<std::uint8_t, 256> nearest{};  ///< the stored one; the lower one of two
};
const EndpointTable& endpoint_table(const EndpointRange& range);

/// Returns how far a weight is on the way between endpoints, in parts of 64.
constexpr std::uint32_t weight_part(std::uint32_t weight, std::uint32_t bits) {
  // The bits, repeated to six.
  std::uint32_t part = 0;
  for (int left = 6; left > 0; left -= static_cast<int>(bits))
    part |= left >= static_cast<int>(bits) ? weight << (left - bits) : weight >> (bits - left);
  return part + (part > 32 ? 1 : 0);
}

/// Returns a value between endpoints, as ASTC has it for pictures that are no sRGB to a device.
constexpr std::uint8_t between(std::uint32_t low, std::uint32_t high, std::uint32_t part) {
  constexpr std::uint32_t kBoth = 257;  // a byte, repeated to 16 bits
  return static_cast<std::uint8_t>((kBoth * (low * (64 - part) + high * part) + 32) >> 14);
}

/// Advice for transcoders. None is wrong, but some make worse pictures.
struct UastcHints {
  bool bc1_endpoints = false;                 ///< BC1's are those of the block
  bool bc1_weights = false;                   ///< BC1's are those of the block
  bool flip = false;                          ///< ETC1's halves lie above each other
  bool difference = false;                    ///< ETC1 stores the second colour by its difference
  std::array<std::uint8_t, 2> intensities{};  ///< ETC1's tables of both halves
  std::uint8_t bias = 13;                     ///< what is added to ETC1's colours; 13: nothing
  std::uint8_t alpha = 0x1d;                  ///< EAC's table, and 16 times its multiplier
  /// These two describe solid blocks alone.
  std::uint8_t selector = 0;
  std::array<std::uint8_t, 3> colour{};  ///< 5 bits with `difference`, else 4
};

struct UastcBlock {
  std::uint8_t mode = kSolidMode;
  std::uint8_t pattern = 0;
  std::uint8_t plane_channel = 0;  ///< the channel of the second plane
  UastcHints hints;
  Rgba solid{};
  /// Stored values: for each subset and channel the low and the high one.
  std::array<std::uint8_t, 18> endpoints{};
  /// For each texel one, or one of each plane.
  std::array<std::uint8_t, 32> weights{};
};

/// Turns lines around whose anchors' weights lie in the upper half.
void orient(UastcBlock& block);

/// Requires an oriented block.
UastcBytes pack_block(const UastcBlock& block);

/// Returns nothing if there is no such mode or pattern.
std::optional<UastcBlock> unpack_block(std::span<const std::byte, kUastcBlockBytes> bytes);

/// Returns the texels of a block, row by row.
std::array<Rgba, kBlockTexels> texels_of(const UastcBlock& block);

}  // namespace meshhier::images
