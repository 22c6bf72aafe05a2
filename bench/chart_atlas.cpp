#include "bench/chart_atlas.h"

#include "base/error.h"
#include "bench/noise.h"
#include "bench/require_range.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

constexpr std::uint64_t kOrderStream = 0x6f72646572;
constexpr std::uint64_t kTurnStream = 0x7475726e;
/// Texels of a chart's side, at least.
constexpr std::uint32_t kLeastSide = 4;

const AtlasOptions& checked(const AtlasOptions& options) {
  require_range("images", options.images, 1, 10'000);
  require_range("side", options.side, 64, 65'500);
  require_range("charts", options.charts, 1, 65'536);
  require_range("gutter", options.gutter, 0, 64);
  return options;
}

std::uint32_t rounded_root(double square) {
  return static_cast<std::uint32_t>(std::lround(std::sqrt(square)));
}

std::uint32_t root_above(std::uint32_t square) {
  std::uint32_t root = 1;
  while (std::uint64_t{root} * root < square)
    ++root;
  return root;
}

/// Returns 0 ... count - 1 in random order (Fisher & Yates; Durstenfeld, Algorithm 235,
/// 1964).
std::vector<std::uint32_t> shuffled(std::uint32_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  for (std::uint32_t left = count; left > 1; --left)
    std::swap(order[left - 1], order[random_at(seed, left) % left]);
  return order;
}

/// A quarter counter-clockwise of a square of that side, y going down.
TexelPlace turned(TexelPlace at, double side) {
  return {at.y, side - at.x};
}

TexelPlace turned(TexelPlace at, double side, std::uint32_t times) {
  for (; times > 0; --times)
    at = turned(at, side);
  return at;
}

}  // namespace

TexelPlace PlacedChart::texel_of(ChartPlace place) const {
  const double size = side;
  const TexelPlace upright{place.column * size / cells.columns(),
                           size - place.row * size / cells.rows()};
  const TexelPlace at = turned(upright, size, turns);
  return {x + at.x, y + at.y};
}

ChartPlace PlacedChart::place_of(TexelPlace texel) const {
  const double size = side;
  const TexelPlace within{std::clamp(texel.x - x, 0.0, size), std::clamp(texel.y - y, 0.0, size)};
  const TexelPlace upright = turned(within, size, (4 - turns) % 4);
  return {upright.x * cells.columns() / size, (size - upright.y) * cells.rows() / size};
}

ChartAtlas::ChartAtlas(const PatchGrid& grid, const AtlasOptions& options)
    : options_(checked(options)), cells_(grid.cells()) {
  const double wanted = static_cast<double>(options.images) * options.charts / grid.patch_count();
  charts_a_side_ = std::clamp(rounded_root(wanted), 1U, cells_);
  const std::uint32_t count = grid.patch_count() * charts_a_side_ * charts_a_side_;
  slots_a_row_ = root_above((count + options.images - 1) / options.images);
  if (slot_side() < kLeastSide + 2 * options.gutter) {
    throw Error(
        ErrorCode::usage,
        fmt::format("side: {} charts with gutters of {} texels do not fit {} pictures of {} "
                    "texels; ask for fewer charts, or for more or larger pictures",
                    count, options.gutter, options.images, options.side));
  }
  chart_in_ = shuffled(count, options.seed ^ kOrderStream);
}

std::optional<PlacedChart> ChartAtlas::chart(std::uint32_t image, std::uint32_t column,
                                             std::uint32_t row) const {
  // Pictures share the charts evenly: each has those from its share's begin to its end.
  const auto begin_of = [&](std::uint64_t i) { return i * chart_count() / options_.images; };
  const std::uint64_t slot = begin_of(image) + std::uint64_t{row} * slots_a_row_ + column;
  if (slot >= begin_of(image + std::uint64_t{1}))
    return std::nullopt;
  const std::uint32_t chart = chart_in_[slot];
  return PlacedChart{cells_of(chart),
                     image,
                     column * slot_side() + options_.gutter,
                     row * slot_side() + options_.gutter,
                     chart_side(),
                     static_cast<std::uint32_t>(random_at(options_.seed ^ kTurnStream, chart) % 4)};
}

ChartCells ChartAtlas::cells_of(std::uint32_t chart) const {
  const std::uint32_t in_patch = chart % (charts_a_side_ * charts_a_side_);
  const auto begin_of = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>(std::uint64_t{i} * cells_ / charts_a_side_);
  };
  const std::uint32_t column = in_patch % charts_a_side_, row = in_patch / charts_a_side_;
  return {chart / (charts_a_side_ * charts_a_side_), begin_of(column), begin_of(column + 1),
          begin_of(row), begin_of(row + 1)};
}

}  // namespace meshhier::bench
