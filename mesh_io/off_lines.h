// Lines of numbers of an OFF file, parsed block by block, apart from those before and behind them:
// what a line is follows from how many there were before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

struct OffNumber {
  double value = 0;  ///< of the first three of a line as parse_decimal() has it, of others a float
  bool is_integer = false;
  bool fits_float = true;  ///< as DecimalNumber
};

struct OffLines {
  std::vector<char> text;
  std::vector<OffNumber> numbers;  ///< of all rows
  /// A line with numbers, and nothing else but a comment.
  struct Row {
    std::uint32_t offset = 0;  ///< in the text
    std::uint32_t count = 0;   ///< of numbers
  };
  std::vector<Row> rows;
  /// Behind the last row, or in front of the first line that is neither numbers nor empty.
  std::uint32_t plain_bytes = 0;
  std::uint64_t lines = 0;  ///< that end before it

  bool is_plain() const { return plain_bytes == text.size(); }
};

/// Of a block of LineBlocks::kBytes, at most: a number has two bytes of text.
inline constexpr std::uint64_t kOffLinesBytes = std::uint64_t{5} << 19;

/// Fills all but the text. O(bytes).
void parse_off_lines(OffLines& block);

/// Line ends in a text: LF, CRLF or CR.
std::uint64_t count_lines(std::span<const char> text);

}  // namespace meshhier::mesh_io
