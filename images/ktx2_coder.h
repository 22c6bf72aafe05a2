// KTX2 of Basis Universal: pictures that graphics devices keep compressed.
//
// The library for it is no package of Debian's, but one of npm's: a program of Node.js
// (images/ktx2/coder.mjs) codes, in processes of its own, each for one picture at a time.
#pragma once

#include "images/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshhier::images {

/// Larger pictures are not encoded: of the encoder's memory they take a gigabyte and more.
inline constexpr std::uint32_t kMostKtx2Side = 2048;

enum class Ktx2Content : std::uint32_t {
  etc1s = 0,      ///< colours, in half a byte a texel: as JPEG at the same quality, and coarser
  uastc = 1,      ///< colours, in a byte a texel: what nobody tells from the picture
  directions = 2  ///< the same of a normal map
};

/// What keeps this machine from coding, and what mends it, in a sentence; empty: nothing does.
std::string missing_for_ktx2();

/// With all smaller pictures, down to a single texel. Deterministic for one version of the library.
/// `quality`: 1 ... 100, of etc1s. Requires sides that are multiples of 4, up to kMostKtx2Side.
/// Throws Error(io) if missing_for_ktx2(). Thread-safe.
std::vector<std::byte> encode_ktx2(const Image& image, Ktx2Content content, int quality);

/// The largest of its pictures, with the size and the channels that its head says. Throws
/// Error(input) that starts with `name` if it is broken, Error(io) if missing_for_ktx2().
/// Thread-safe.
Image decode_ktx2(std::span<const std::byte> file, const Image& shape, const std::string& name);

/// Memory of the process that codes a picture, which it keeps for the next one: 130 MiB, and for
/// 512 x 512 texels 250 MiB, for 2048 x 2048 600 MiB.
std::uint64_t ktx2_coder_bytes(std::uint64_t texels);

/// Ends the processes that wait for pictures. Thread-safe.
void end_ktx2_coders();

}  // namespace meshhier::images
