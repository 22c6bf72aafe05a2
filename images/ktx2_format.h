// KTX 2.0 files (Khronos, "KTX File Format Specification" 2.0) of Basis Universal: where numbers
// lie, little endian.
//
//      0  identifier, 12 bytes                  80  levels, the largest first, 24 bytes each:
//     12  format of texels: 0, as it is               offset u64, bytes u64, bytes unpacked u64
//         described below                       ..  description (Khronos Data Format): its bytes
//     16  size of a type: 1                           u32, then a block of 24 bytes and samples
//     20  width                                       of 16 bytes
//     24  height                                ..  keys and values: for each its bytes u32, the
//     28  depth: 0                                    key, 0, the value, 0; then up to a
//     32  layers: 0                                   multiple of 4
//     36  faces: 1                              ..  data that levels share: of ETC1S alone
//     40  levels                                ..  the levels, the smallest first
//     44  supercompression
//     48  description: offset, bytes
//     56  keys and values: offset, bytes
//     64  shared data: offset u64, bytes u64
#pragma once

#include <cstddef>
#include <cstdint>

namespace meshhier::images::ktx2 {

inline constexpr std::size_t kHeadBytes = 80, kLevelBytes = 24;
inline constexpr std::size_t kVkFormatAt = 12, kTypeSizeAt = 16, kWidthAt = 20, kHeightAt = 24,
                             kDepthAt = 28, kLayersAt = 32, kFacesAt = 36, kLevelsAt = 40,
                             kSchemeAt = 44, kDescriptionAt = 48, kDescriptionBytesAt = 52,
                             kKeysAt = 56, kKeysBytesAt = 60, kGlobalDataAt = 64;
/// The supercompression.
enum Scheme : std::uint32_t { kPlain = 0, kBasisLz = 1, kZstandard = 2 };

// Khronos Data Format, from the description's start on: its first block says the model of colours,
// and each sample its channel.
inline constexpr std::size_t kModelAt = 12, kSampleAt = 28, kSampleBytes = 16, kChannelAt = 3;
enum Model : std::uint8_t { kEtc1s = 163, kUastc = 166 };
inline constexpr std::uint32_t kChannelBits = 0x0f, kUastcRgb = 0, kUastcRgba = 3;
inline constexpr std::uint32_t kDescriptionBytes = kSampleAt + kSampleBytes;

}  // namespace meshhier::images::ktx2
