// The smallest picture, for tests of the real program.
#pragma once

#include "tests/app/program.h"

namespace meshhier::app {

/// Writes a PNG of one red texel.
inline void write_picture(const Path& path) {
  constexpr unsigned char kPng[] = {
      0x89, 'P',  'N',  'G',  '\r', '\n', 0x1a, '\n', 0,   0,    0,    13,   'I',  'H',
      'D',  'R',  0,    0,    0,    1,    0,    0,    0,   1,    8,    2,    0,    0,
      0,    0x90, 0x77, 0x53, 0xde, 0,    0,    0,    12,  'I',  'D',  'A',  'T',  0x78,
      0x9c, 0x63, 0xf8, 0xcf, 0xc0, 0,    0,    3,    1,   1,    0,    0xc9, 0xfe, 0x92,
      0xef, 0,    0,    0,    0,    'I',  'E',  'N',  'D', 0xae, 0x42, 0x60, 0x82};
  write_text(path, {reinterpret_cast<const char*>(kPng), sizeof kPng});
}

}  // namespace meshhier::app
