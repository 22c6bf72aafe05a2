#include "mesh_io/off_lines.h"

#include "mesh_io/line_parser.h"
#include "mesh_io/number_text.h"
#include "mesh_io/word_stream.h"

#include <cmath>
#include <optional>
#include <string_view>

namespace meshhier::mesh_io {
namespace {

std::optional<OffNumber> number_of(std::string_view word, bool is_decimal) {
  if (word.empty() || word.size() > WordStream::kMaxWordBytes)
    return std::nullopt;
  // A double holds it, and the sign of no zero is lost.
  constexpr std::int64_t kMost = std::int64_t{1} << 53;
  const auto integer = parse_integer(word);
  if (integer && *integer != 0 && std::abs(*integer) <= kMost) {
    const auto value = static_cast<double>(*integer);
    return OffNumber{value, true, static_cast<double>(static_cast<float>(value)) == value};
  }
  if (is_decimal) {
    const auto number = parse_decimal(word);
    return number ? std::optional(OffNumber{number->value, integer.has_value(), number->fits_float})
                  : std::nullopt;
  }
  const auto number = parse_real<float>(word);
  return number ? std::optional(OffNumber{*number, integer.has_value(), true}) : std::nullopt;
}

/// Returns whether the line has nothing but numbers.
bool take_row(LineParser& line, OffLines& block) {
  constexpr std::uint32_t kDecimals = 3;
  const auto offset = static_cast<std::uint32_t>(line.at() - block.text.data());
  std::uint32_t count = 0;
  for (line.skip_blanks(); !line.is_at_end() && line.next() != '#'; line.skip_blanks()) {
    const auto number = number_of(line.take_number(), count < kDecimals);
    if (!number)
      return false;
    block.numbers.push_back(*number);
    ++count;
  }
  line.skip_line();
  if (count > 0)
    block.rows.push_back({offset, count});
  return true;
}

}  // namespace

void parse_off_lines(OffLines& block) {
  block.numbers.clear();
  block.rows.clear();
  block.lines = 0;
  LineParser line(block.text.data(), block.text.data() + block.text.size());
  const char* begin = line.at();
  while (line.has_more() && take_row(line, block)) {
    block.lines += line.has_more() ? 1 : 0;
    line.take_line_end();
    begin = line.at();
  }
  block.plain_bytes = static_cast<std::uint32_t>(begin - block.text.data());
}

std::uint64_t count_lines(std::span<const char> text) {
  LineParser line(text.data(), text.data() + text.size());
  std::uint64_t lines = 0;
  while (line.has_more()) {
    line.skip_line();
    lines += line.has_more() ? 1 : 0;
    line.take_line_end();
  }
  return lines;
}

}  // namespace meshhier::mesh_io
