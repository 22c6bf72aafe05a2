#include "drawing/paper.h"

#include "base/error.h"
#include "drawing/stroke_font.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

namespace meshhier::drawing {
namespace {

// Millimetres.
constexpr double kMargin = 5, kMarginOfLabels = 14, kBarRoom = 12;
constexpr double kA4Width = 210, kA4Height = 297;
constexpr double kGridWidth = 0.1, kBarWidth = 1.2, kBarEdge = 0.2;
constexpr double kGridApart = 50, kMostBar = 60;
constexpr double kLeast = 1, kMost = 1e6;

/// 10 to a whole power, by products: the same on every machine.
double power_of_ten(int exponent) {
  double power = 1;
  for (int i = 0; i < std::abs(exponent); ++i)
    power *= 10;
  return exponent < 0 ? 1 / power : power;
}

/// Returns the exponent of the greatest power of ten that is at most `value`.
int exponent_of(double value) {
  int exponent = 0;
  while (exponent < 300 && power_of_ten(exponent + 1) <= value)
    ++exponent;
  while (exponent > -300 && power_of_ten(exponent) > value)
    --exponent;
  return exponent;
}

/// Returns the round number that is `factor` times 10 to `exponent`.
double round_number(double factor, int exponent) {
  return exponent < 0 ? factor / power_of_ten(-exponent) : factor * power_of_ten(exponent);
}

/// Returns how many digits behind the point a multiple of the length has at most.
int digits_of(double step) {
  constexpr int kMostDigits = 12;
  int digits = 0;
  for (double scaled = step; digits < kMostDigits; ++digits, scaled = step * power_of_ten(digits)) {
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * std::max(scaled, 1e-3))
      break;
  }
  return digits;
}

/// Returns the scale with which the box fits on A4, one way or the other.
double fitting_scale(double across, double down, double metres, double margins) {
  const double wide = kA4Width - margins, high = kA4Height - margins - kBarRoom;
  const double upright = std::max(across / wide, down / high);
  const double lying =
      std::max(across / (kA4Height - margins), down / (kA4Width - margins - kBarRoom));
  const double least = 1000 * metres * std::min(upright, lying);
  return least > 0 ? least_round_length(least) : 1;
}

void require_size(const Paper& paper, double across, double down, double metres) {
  const double most = std::max(paper.inner_width, paper.inner_height);
  if (most >= kLeast && most <= kMost)
    return;
  const double natural = 1000 * metres * std::max(across, down);
  if (!(natural > 0)) {
    throw Error(ErrorCode::usage, "what there is to draw is a point: nothing can be drawn of it");
  }
  throw Error(ErrorCode::usage,
              fmt::format("at --scale {} the drawing would be {:.3g} x {:.3g} mm; give one from "
                          "{} to {}",
                          scale_text(paper.scale), paper.inner_width, paper.inner_height,
                          scale_text(least_round_length(natural / kMost)),
                          scale_text(round_length(natural / kLeast))));
}

/// Returns the width of the longest number beside the grid.
double label_width(const BoundsD& box, double step) {
  std::size_t letters = 0;
  for (const double end : {box.min.y, box.max.y})
    letters = std::max(letters, coordinate_text(std::round(end / step) * step, step).size());
  return static_cast<double>(letters) * kTextHeight * kLetterAdvance;
}

void add_grid(Paper& paper, double step) {
  constexpr double kMostLines = 2000;
  PaperMarks& marks = paper.marks;
  const double right = paper.left + paper.inner_width / paper.mm_per_unit;
  const double bottom = paper.top - paper.inner_height / paper.mm_per_unit;
  if (!((right - paper.left + paper.top - bottom) / step <= kMostLines)) {
    throw Error(ErrorCode::usage,
                fmt::format("--grid {}: there would be more than {} lines; give a larger one", step,
                            kMostLines));
  }
  const double end_x = paper.margin + paper.inner_width, end_y = paper.margin + paper.inner_height;
  for (double i = std::ceil(paper.left / step); i * step <= right; ++i) {
    const double x = paper.on_paper(i * step, 0).x;
    marks.grid.push_back({{x, paper.margin}, {x, end_y}, kGridWidth});
    marks.texts.push_back({{x, end_y + kTextHeight + 1.5},
                           coordinate_text(i * step, step),
                           PaperText::Anchor::middle});
  }
  for (double i = std::ceil(bottom / step); i * step <= paper.top; ++i) {
    const double y = paper.on_paper(0, i * step).y;
    marks.grid.push_back({{paper.margin, y}, {end_x, y}, kGridWidth});
    marks.texts.push_back(
        {{paper.margin - 1, y - 0.6}, coordinate_text(i * step, step), PaperText::Anchor::end});
  }
}

/// Adds a bar of four fields, dark and light, and what it and the scale say.
void add_bar(Paper& paper, const SheetUnit& unit) {
  constexpr int kFields = 4;
  const double most = std::min(kMostBar, std::max(paper.inner_width, 15.0));
  const double field = round_length(most / kFields / paper.mm_per_unit);
  const double step = field * paper.mm_per_unit, x = paper.margin;
  const double y = paper.height - kMargin - kTextHeight - 1;
  PaperMarks& marks = paper.marks;
  for (const double edge : {y - kBarWidth / 2, y + kBarWidth / 2})
    marks.bar.push_back({{x, edge}, {x + kFields * step, edge}, kBarEdge});
  for (int i = 0; i <= kFields; ++i) {
    const double at = x + i * step;
    marks.bar.push_back({{at, y - kBarWidth / 2}, {at, y + kBarWidth / 2}, kBarEdge});
    for (double at_y = y - kBarWidth / 2; i % 2 == 0 && i < kFields && at_y < y + kBarWidth / 2;
         at_y += kBarEdge)
      marks.bar.push_back({{at, at_y}, {at + step, at_y}, kBarEdge});
  }
  const double text = y + kBarWidth / 2 + kTextHeight + 0.8;
  marks.texts.push_back({{x, text}, "0", PaperText::Anchor::start});
  marks.texts.push_back(
      {{x + kFields * step, text},
       fmt::format("{} {}", coordinate_text(kFields * field, kFields * field), unit.name),
       PaperText::Anchor::middle});
  marks.texts.push_back({{x + kFields * step + 6, y + 1}, scale_text(paper.scale)});
}

}  // namespace

double round_length(double most) {
  const int exponent = exponent_of(most);
  double best = round_number(1, exponent);
  for (const double factor : {2.0, 5.0}) {
    if (round_number(factor, exponent) <= most)
      best = round_number(factor, exponent);
  }
  return best;
}

double least_round_length(double least) {
  const double below = round_length(least);
  return below >= least ? below : round_length(std::max(2.5 * below, below * 2));
}

std::string scale_text(double scale) {
  return scale >= 1 ? fmt::format("1:{:.10g}", scale) : fmt::format("{:.10g}:1", 1 / scale);
}

std::string coordinate_text(double value, double step) {
  std::string text = fmt::format("{:.{}f}", value, digits_of(step));
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.starts_with('-') ? text.substr(1) : text;
}

Paper paper_for(const BoundsD& box, const SheetUnit& unit, const PaperRequest& request) {
  if (unit.metres == 0) {
    throw Error(ErrorCode::usage,
                "a scale needs the unit of the model's coordinates, which it does not tell: give "
                "--units m, or the one that it is");
  }
  const double across = box.max.x - box.min.x, down = box.max.y - box.min.y;
  Paper paper{.left = box.min.x, .top = box.max.y};
  const double margin = request.has_grid ? kMarginOfLabels : kMargin;
  paper.scale = request.scale.value_or(fitting_scale(across, down, unit.metres, 2 * margin));
  paper.mm_per_unit = 1000 * unit.metres / paper.scale;
  const double step =
      request.grid ? request.grid->in(unit.metres) : round_length(kGridApart / paper.mm_per_unit);
  paper.margin = request.has_grid ? std::max(margin, label_width(box, step) + 2) : margin;
  paper.inner_width = across * paper.mm_per_unit;
  paper.inner_height = down * paper.mm_per_unit;
  require_size(paper, across, down, unit.metres);
  paper.width = paper.inner_width + 2 * paper.margin;
  paper.height = paper.inner_height + 2 * paper.margin + (request.has_bar ? kBarRoom : 0);
  if (request.has_grid)
    add_grid(paper, step);
  if (request.has_bar) {
    paper.width = std::max(paper.width, 2 * paper.margin + kMostBar + 30);
    add_bar(paper, unit);
  }
  return paper;
}

}  // namespace meshhier::drawing
