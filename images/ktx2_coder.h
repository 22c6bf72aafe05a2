// KTX2 of Basis Universal as ETC1S: pictures that graphics devices keep in half a byte a texel.
//
// Problem. The library for it is no package of Debian's, but one of npm's. (UASTC, of a byte a
// texel, is coded here: uastc_picture.h, ktx2_reader.cpp.)
//
// Idea. A program of Node.js (images/ktx2/coder.mjs) codes, in processes of its own, each for one
// picture at a time. A process that has coded waits for the next picture:
//
//       thread 1 --- request: kind, width, height, quality, bytes; texels ---> process A
//       thread 2 --- ... ---------------------------------------------------> process B
//                <-- answer: good or not, bytes ---------------------------
//
// Invariant. A process has one picture at a time, so as many run as threads ask. An answer depends
// on its request alone. A process that dies takes only its own picture with it.
//
// Cost. A process takes 130 MiB and keeps its highest memory; a texel takes 2.5 us of CPU
// (formats.cpp).
#pragma once

#include "images/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshhier::images {

/// The longest side of a picture that is encoded: larger ones take a gigabyte and more of the
/// encoder's memory.
inline constexpr std::uint32_t kMostKtx2Side = 2048;

/// Says in a sentence what keeps this machine from coding, and what to do; empty: it can.
std::string missing_for_ktx2();

/// Encodes a picture with all smaller ones, down to a single texel: like JPEG at the same quality,
/// and coarser. Deterministic for one version of the library. `quality`: 1 ... 99. Requires sides
/// that are multiples of 4, up to kMostKtx2Side. Throws Error(io) if missing_for_ktx2(), or if
/// processes end while they have the picture; Error(internal) with the library's words.
/// Thread-safe.
std::vector<std::byte> encode_etc1s(const Image& image, int quality);

/// Decodes the largest of a file's pictures. `shape`: its size and channels, as the file's head
/// says; its texels do not count. Throws Error(input) that starts with `name` if it is broken,
/// Error(io) if missing_for_ktx2(). Thread-safe.
Image decode_ktx2(std::span<const std::byte> file, const Image& shape, const std::string& name);

/// Returns the memory of the process that codes a picture, which it keeps for the next one: 130
/// MiB, and for 512 x 512 texels 250 MiB, for 2048 x 2048 600 MiB.
std::uint64_t ktx2_coder_bytes(std::uint64_t texels);

/// Ends the processes that wait for pictures. Thread-safe.
void end_ktx2_coders();

}  // namespace meshhier::images
