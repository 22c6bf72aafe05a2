// KTX2 files of UASTC blocks (ktx2_format.h), packed by Zstandard.
#pragma once

#include "images/pyramid.h"
#include "images/uastc_block.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::images {

/// The meaning of channels.
enum class Ktx2Meaning : std::uint8_t { colours, directions };

struct Ktx2Picture {
  TexelSize size;
  bool has_alpha = false;
  Ktx2Meaning meaning = Ktx2Meaning::colours;
};

/// Returns a file of levels, the largest first, each of whose blocks come row by row. The same for
/// one version of libzstd. Throws Error(internal) with the library's words.
std::vector<std::byte> ktx2_file(const Ktx2Picture& picture,
                                 std::span<const std::vector<UastcBytes>> levels);

/// Returns the memory that it takes besides the blocks, for a picture of so many texels.
std::uint64_t ktx2_packing_bytes(std::uint64_t texels);

}  // namespace meshhier::images
