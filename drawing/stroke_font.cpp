#include "drawing/stroke_font.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace meshhier::drawing {
namespace {

/// A letter on a grid of 5 by 7 points: "XY XY XY|XY XY", points of polylines, y up.
struct Glyph {
  char letter;
  std::string_view strokes;
};

constexpr std::array kGlyphs{Glyph{'0', "10 30 41 45 36 16 05 01 10"},
                             Glyph{'1', "14 26 20|10 30"},
                             Glyph{'2', "05 16 36 45 44 00 40"},
                             Glyph{'3', "05 16 36 45 44 33 13|33 42 41 30 10 01"},
                             Glyph{'4', "30 36 02 42"},
                             Glyph{'5', "46 06 03 33 42 41 30 10 01"},
                             Glyph{'6', "45 36 16 05 01 10 30 41 42 33 03"},
                             Glyph{'7', "06 46 10"},
                             Glyph{'8', "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33"},
                             Glyph{'9', "01 10 30 41 45 36 16 05 04 13 43"},
                             Glyph{'-', "13 33"},
                             Glyph{'+', "13 33|22 24"},
                             Glyph{'.', "20 20"},
                             Glyph{':', "21 21|24 24"},
                             Glyph{'_', "00 40"},
                             Glyph{'c', "44 14 03 01 10 40"},
                             Glyph{'e', "02 42 43 34 14 03 01 10 40"},
                             Glyph{'f', "36 25 20|14 34"},
                             Glyph{'i', "24 20|26 26"},
                             Glyph{'k', "06 00|44 02|13 40"},
                             Glyph{'m', "00 04|03 14 23 20|23 34 43 40"},
                             Glyph{'n', "00 04|03 14 34 43 40"},
                             Glyph{'s', "44 14 03 12 32 41 30 00"},
                             Glyph{'t', "26 21 30 40|14 34"},
                             Glyph{'u', "04 01 10 30 41|44 40"}};
constexpr double kHeight = 6;

exporting::PlanPoint point_at(std::string_view strokes, std::size_t i, double left) {
  return {left + (strokes[i] - '0') / kHeight, -(strokes[i + 1] - '0') / kHeight};
}

}  // namespace

void for_each_stroke(
    std::string_view text,
    const std::function<void(exporting::PlanPoint from, exporting::PlanPoint to)>& visit) {
  double left = 0;
  for (const char letter : text) {
    const auto* const glyph = std::ranges::find(kGlyphs, letter, &Glyph::letter);
    const std::string_view strokes = glyph == kGlyphs.end() ? "" : glyph->strokes;
    for (std::size_t i = 0; i + 4 < strokes.size(); i += 3) {
      if (strokes[i + 2] == ' ')
        visit(point_at(strokes, i, left), point_at(strokes, i + 3, left));
    }
    left += kLetterAdvance;
  }
}

}  // namespace meshhier::drawing
