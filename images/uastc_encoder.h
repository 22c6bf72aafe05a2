// Blocks of UASTC (uastc_block.h) of texels.
//
// Problem. UASTC has 19 modes, many with dozens of patterns. To try them all takes 50 us a block,
// four seconds a picture of 1024 x 1024 texels.
//
// Idea. Few modes, each where it pays. While a block is worse than a limit, more are tried, and the
// best one is kept: the one with the least error and bytes.
//
//       one colour               8
//       one line                 0; 5 if the line is short, 18 if it is long
//       off the line             6: the channel that is farthest off has weights of its own
//       farther off              4, 7 and 2: two lines, in a few patterns (uastc_subsets.h)
//       with alpha               10 or 12: one line; 11 as 6
//
//       fewer bytes, when packed 0 with the weights of another block (uastc_reuse.h); 8 with the
//                                mean colour
//
// Invariant. Blocks depend on their texels and on those before, and are the same on every
// processor.
//
// Cost. 0.1 s a megatexel of colours, 0.3 of directions; docs/decisions/046 has the curves of
// error, bytes and time.
#pragma once

#include "images/uastc_block.h"
#include "images/uastc_line.h"
#include "images/uastc_reuse.h"

#include <cstddef>
#include <span>

namespace meshhier::images {

/// Limits of what is tried. Errors are sums of squares over a block's texels.
struct UastcEffort {
  float plane_error;          ///< a second plane is tried from here on
  float subset_error;         ///< two subsets are tried from here on
  std::size_t pattern_tries;  ///< patterns of subsets that are tried
  bool fine_weights;          ///< each with finer weights and coarser endpoints too
  float byte_error;           ///< the error that is as bad as a byte more in the packed file
};

/// 48.2 dB of photographs; the encoder of Basis Universal has 47.7 at its quickest.
inline constexpr UastcEffort kColourEffort{80, 320, 2, false, 2};
/// Directions have two channels that do not follow each other, and are seen in highlights.
inline constexpr UastcEffort kDirectionEffort{8, 64, 6, true, 0};

/// A block that may be taken.
struct UastcCandidate {
  UastcBlock block;
  float error = 1e30F;
};

/// Makes the blocks of a picture, one after another.
class UastcEncoder {
 public:
  explicit UastcEncoder(const UastcEffort& effort) : effort_(effort) {}

  /// Returns a block for 4 x 4 texels, row by row.
  UastcBlock encode(std::span<const Rgba, kBlockTexels> texels);

 private:
  UastcBlock encode_opaque(std::span<const Rgba, kBlockTexels> texels);
  /// Tries the weights of a block before.
  void try_weights(const Channels<3>& texels, const Line<3>& principal, UastcCandidate& best) const;

  UastcEffort effort_;
  RecentWeights recent_;
};

}  // namespace meshhier::images
