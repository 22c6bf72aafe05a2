// Lines of numbers of an OFF file, parsed block by block, apart from those before and behind them.
// Only the reader knows what a line means: that follows from how many lines came before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

struct OffNumber {
  double value = 0;  ///< a double as of parse_decimal() if it is among the first three of its line,
                     ///< else a float
  bool is_integer = false;
  bool fits_float = true;  ///< as DecimalNumber
};

struct OffLines {
  std::vector<char> text;
  std::vector<OffNumber> numbers;  ///< numbers of all rows
  /// A line with numbers, and nothing else but a comment.
  struct Row {
    std::uint32_t offset = 0;  ///< in the text
    std::uint32_t count = 0;   ///< numbers that it has
  };
  std::vector<Row> rows;
  /// Bytes up to the end of the last row, or up to the first line that is neither numbers nor
  /// empty.
  std::uint32_t plain_bytes = 0;
  std::uint64_t lines = 0;  ///< lines that end within plain_bytes

  bool is_plain() const { return plain_bytes == text.size(); }
};

/// The largest memory of a block of LineBlocks::kBytes: a number has two bytes of text.
inline constexpr std::uint64_t kOffLinesBytes = std::uint64_t{5} << 19;

/// Fills all but the text. O(bytes). Thread-safe for different blocks.
void parse_off_lines(OffLines& block);

/// Counts line ends in a text: LF, CRLF or CR.
std::uint64_t count_lines(std::span<const char> text);

}  // namespace meshhier::mesh_io
