// Letters as strokes, for the numbers and units of pictures.
#pragma once

#include "export/plan_region.h"

#include <functional>
#include <string_view>

namespace meshhier::drawing {

/// A letter's width with the space behind it, in heights of digits.
inline constexpr double kLetterAdvance = 5.5 / 6;

/// Calls visit(from, to) for the strokes of a text: x from its beginning, y from the base line
/// down, in heights of digits. It has digits, the letters of units, and . : + -; others are blank.
void for_each_stroke(
    std::string_view text,
    const std::function<void(exporting::PlanPoint from, exporting::PlanPoint to)>& visit);

}  // namespace meshhier::drawing
