// Oddities: a file has something otherwise than its format says, but cannot mean anything else.
#pragma once

#include <cstdint>

namespace meshhier::mesh_io {

/// Counts of oddities, which are read all the same.
struct OddSyntax {
  std::uint64_t header_lines = 0;  ///< also beginnings and ends of solids
  std::uint64_t broken_rows = 0;   ///< rows that go on in the next line
  std::uint64_t integers = 0;      ///< written as floats: "200.0"
  std::uint64_t rounded = 0;       ///< integers of 64 bits beyond those that a double holds
  std::uint64_t lines_behind = 0;  ///< lines with words behind the mesh
  std::uint64_t bytes_behind = 0;  ///< zeros behind a text

  OddSyntax& operator+=(const OddSyntax& other) {
    header_lines += other.header_lines;
    broken_rows += other.broken_rows;
    integers += other.integers;
    rounded += other.rounded;
    lines_behind += other.lines_behind;
    bytes_behind += other.bytes_behind;
    return *this;
  }
  friend bool operator==(const OddSyntax&, const OddSyntax&) = default;
};

}  // namespace meshhier::mesh_io
