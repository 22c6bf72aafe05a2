// Huffman codes of JPEGs that are maps of directions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace meshhier::images {

/// As JPEG stores a code (ITU-T T.81, annex B.2.4.2): how many symbols have 1, 2 ... 16 bits, and
/// the symbols, the shortest first.
template <std::size_t kSymbols>
struct JpegCode {
  std::array<std::uint8_t, 16> counts;
  std::array<std::uint8_t, kSymbols> symbols;
};
struct JpegCodePair {
  JpegCode<12> steady;    ///< of a block's mean
  JpegCode<162> changes;  ///< of its other coefficients
};

/// The codes that fit the maps of six scans (dragon, horse, feline, igea, blade, snowden) at
/// quality 85, each scan as much as another: first of red and green, then of blue, which is coarse.
/// Files are as large as with the best code for all channels of a map, which is known after a
/// second pass, and take half of the time: dragon -0.2 %, horse -0.5 %.
inline constexpr std::array<JpegCodePair, 2> kDirectionCodes = {{
    {{{1, 1, 1, 1, 1, 1, 1, 1, 0, 3, 1, 0, 0, 0, 0, 0}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}},
     {{0, 2, 2, 1, 3, 2, 4, 5, 1, 5, 4, 3, 1, 2, 0, 127},
      {1,   2,   0,   17,  3,   33,  18,  49,  4,   65,  81,  97,  34,  19,  113, 5,   129, 145,
       50,  161, 177, 20,  66,  193, 35,  209, 82,  6,   240, 225, 98,  51,  21,  114, 241, 146,
       36,  130, 67,  162, 178, 210, 83,  194, 52,  22,  99,  37,  115, 7,   147, 131, 68,  211,
       163, 179, 84,  53,  100, 149, 116, 195, 226, 132, 102, 38,  212, 85,  148, 86,  117, 69,
       23,  133, 70,  242, 101, 180, 55,  227, 8,   9,   10,  24,  25,  26,  39,  40,  41,  42,
       54,  56,  57,  58,  71,  72,  73,  74,  87,  88,  89,  90,  103, 104, 105, 106, 118, 119,
       120, 121, 122, 134, 135, 136, 137, 138, 150, 151, 152, 153, 154, 164, 165, 166, 167, 168,
       169, 170, 181, 182, 183, 184, 185, 186, 196, 197, 198, 199, 200, 201, 202, 213, 214, 215,
       216, 217, 218, 228, 229, 230, 231, 232, 233, 234, 243, 244, 245, 246, 247, 248, 249, 250}}},
    {{{1, 1, 1, 1, 1, 1, 0, 1, 5, 0, 0, 0, 0, 0, 0, 0}, {0, 1, 2, 3, 6, 4, 5, 7, 8, 9, 10, 11}},
     {{1, 1, 0, 2, 1, 3, 3, 2, 3, 4, 5, 3, 5, 1, 3, 125},
      {0,   1,   17,  2,   33,  49,  18,  3,   65,  81,  97,  113, 129, 19,  145, 34,  161, 50,
       177, 193, 4,   209, 66,  82,  240, 35,  225, 146, 20,  98,  83,  114, 241, 51,  130, 100,
       67,  147, 5,   99,  36,  84,  162, 210, 194, 6,   7,   8,   9,   10,  21,  22,  23,  24,
       25,  26,  37,  38,  39,  40,  41,  42,  52,  53,  54,  55,  56,  57,  58,  68,  69,  70,
       71,  72,  73,  74,  85,  86,  87,  88,  89,  90,  101, 102, 103, 104, 105, 106, 115, 116,
       117, 118, 119, 120, 121, 122, 131, 132, 133, 134, 135, 136, 137, 138, 148, 149, 150, 151,
       152, 153, 154, 163, 164, 165, 166, 167, 168, 169, 170, 178, 179, 180, 181, 182, 183, 184,
       185, 186, 195, 196, 197, 198, 199, 200, 201, 202, 211, 212, 213, 214, 215, 216, 217, 218,
       226, 227, 228, 229, 230, 231, 232, 233, 234, 242, 243, 244, 245, 246, 247, 248, 249, 250}}},
}};

}  // namespace meshhier::images
