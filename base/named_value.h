// Tables of values with names: a row each, which may say more of its value. A table
// with a row for each enumerator is in their order.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier {

/// The least row of such a table.
template <class Value>
struct NamedValue {
  std::string_view name;
  Value value;
};
template <class Value>
NamedValue(std::string_view, Value) -> NamedValue<Value>;

/// The row of `value`, which must have one.
template <class Table, class Value>
constexpr const auto& row_with(const Table& table, Value value) {
  return *std::ranges::find_if(table, [&](const auto& row) { return row.value == value; });
}

template <class Table, class Value>
constexpr std::string_view name_in(const Table& table, Value value) {
  return row_with(table, value).name;
}

/// The value of that name; none if there is none.
template <class Table>
constexpr auto value_named(const Table& table, std::string_view name) {
  const auto row = std::ranges::find_if(table, [&](const auto& one) { return one.name == name; });
  return row == table.end() ? std::nullopt : std::optional(row->value);
}

/// All names, with ", " between them.
template <class Table>
std::string names_in(const Table& table) {
  std::string names;
  for (const auto& row : table)
    names.append(names.empty() ? "" : ", ").append(row.name);
  return names;
}

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
