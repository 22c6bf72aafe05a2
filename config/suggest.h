// "Did you mean": the known word nearest to a misspelt one.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace meshhier::config {

/// Returns the least number of letters to insert, delete, replace or swap with the next one that
/// turns `a` into `b`; case does not matter. (Optimal string alignment: Damerau 1964.) O(|a| |b|).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the candidate with the least distance to `word`, the first of equals; nothing if none is
/// near: within a third of its length, and at least 2. Words above 64 letters are near to nothing.
std::optional<std::string> nearest_word(std::string_view word,
                                        std::span<const std::string> candidates);

}  // namespace meshhier::config
