// Weights that blocks had before: a packer finds them again.
//
// Problem. Blocks of UASTC pack badly: half of a block's bytes are weights, which are hardly ever
// those of another one.
//
// Idea. A block takes the weights of one of the last blocks if it is little farther off with them.
// Which are nearest? A block's endpoints can be anything, so a factor and a sum do not count: those
// are nearest whose correlation with the texels' places along their line is greatest.
//
//       texels along their line   0.1  0.4  0.9 ...  \  as all have a mean of 0 and a length of 1,
//       weights before            2    5    14  ...  /  a sum of 16 products says how much alike
//
// Cost. 10 ns a remembered set.
#pragma once

#include "images/sixteen_floats.h"
#include "images/uastc_block.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace meshhier::images {

/// The mode whose weights are remembered.
inline constexpr std::uint8_t kReusedMode = 0;

class RecentWeights {
 public:
  struct Set {
    std::array<std::uint8_t, kBlockTexels> weights{};
    Sixteen parts;  ///< the same from 0 to 1, as the format has them
    Sixteen way;    ///< of mean 0 and length 1
  };

  struct Found {
    const Set* set;  ///< null: there is none
    float alike;     ///< the part of `along` that lies in the set's way
  };
  /// Returns the set that is most alike `along`, whose mean is 0.
  Found most_alike(const Sixteen& along) const;
  /// Remembers the weights of an oriented block instead of the oldest ones. Requires kReusedMode.
  void add(const UastcBlock& block);

 private:
  /// 64 sets pack a hundredth more and take three times as long.
  static constexpr std::size_t kSets = 16;
  std::array<Set, kSets> sets_;
  std::size_t count_ = 0;  ///< sets that ever were
};

}  // namespace meshhier::images
