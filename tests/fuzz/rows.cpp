// Rows of points or rays for a query: a text, an array of numpy's or a PLY, perhaps in gzip.
//
// First a byte: which rows they are. What is read is written as a text, and must come back.
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "query/row_source.h"
#include "support/memory_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace meshhier::tests::fuzz {
namespace {

constexpr const char* kRows = "/rows";

std::vector<double> read(std::string_view content, querying::RowKind kind) {
  MemoryFiles files;
  files.put(kRows, content);
  std::vector<double> numbers;
  const std::uint64_t rows = querying::read_rows(
      files, kRows, kind,
      [&](std::span<const double> some) {
        require(some.size() % querying::columns_of(kind) == 0, "whole rows are visited");
        numbers.insert(numbers.end(), some.begin(), some.end());
      },
      [] {});
  require(numbers.size() == rows * querying::columns_of(kind), "all rows are counted");
  return numbers;
}

std::string text_of_rows(const std::vector<double>& numbers, querying::RowKind kind) {
  const std::size_t columns = querying::columns_of(kind);
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    text += fmt::format("{}{}", numbers[i], i % columns == columns - 1 ? "\r\n" : ";");
  return text;
}

bool is_same_number(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

}  // namespace

void rows(Bytes input) {
  Take take(input);
  const auto kind =
      take.upto<std::uint8_t>(1) == 0 ? querying::RowKind::points : querying::RowKind::rays;
  std::vector<double> numbers;
  const std::string message =
      refusal({ErrorCode::input}, kRows, [&] { numbers = read(text_of(take.rest()), kind); });
  if (!message.empty())
    return;
  const std::vector<double> again = read(text_of_rows(numbers, kind), kind);
  require(std::ranges::equal(numbers, again, is_same_number), "rows come back from a text");
}

}  // namespace meshhier::tests::fuzz
