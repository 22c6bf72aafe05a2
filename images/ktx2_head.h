// The head of a KTX2 file (ktx2_format.h), with all of its numbers checked.
#pragma once

#include "images/image_codec.h"
#include "images/ktx2_format.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::images {

struct Ktx2Head {
  struct Level {
    std::uint64_t offset, bytes, unpacked;
  };
  std::uint32_t width = 0, height = 0, channels = 3;
  ktx2::Model model = ktx2::kUastc;
  std::uint32_t scheme = ktx2::kPlain;
  std::vector<Level> levels;     ///< the largest first
  std::uint64_t file_bytes = 0;  ///< the end of all levels, and of the data that they share
};

/// Reads it. Throws Error(input) that starts with `name` if it is of another kind than a single
/// picture of Basis Universal, or broken, or ends early; and what the source throws.
Ktx2Head read_ktx2_head(const ByteSource& source, const std::string& name);

}  // namespace meshhier::images
