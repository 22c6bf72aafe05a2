// Tables with a row for each enumerator.
#pragma once

#include <array>
#include <cstddef>

namespace meshhier {

/// Whether each row is that of the enumerator whose number is its place: row_of() looks there.
template <class Row, std::size_t N, class Enum>
constexpr bool are_in_order(const std::array<Row, N>& rows, Enum Row::*key) {
  for (std::size_t i = 0; i < N; ++i) {
    if (rows[i].*key != static_cast<Enum>(i))
      return false;
  }
  return true;
}

}  // namespace meshhier
