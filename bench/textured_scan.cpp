#include "bench/textured_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::bench {
namespace {

/// The shade of texels that no chart covers.
constexpr std::uint8_t kBackground = 24;
/// The finest detail, in texels: a lens shows no finer one.
constexpr double kFinestWaveTexels = 4;
/// Finer detail is beyond what SolidPaint can tell.
constexpr double kFinestWave = 1e-5;

double finest_wave(const ReliefSurface& surface, const ChartAtlas& atlas) {
  const double texel =
      surface.base().patch_size() / (atlas.charts_a_side() * double{1} * atlas.chart_side());
  return std::max(kFinestWave, kFinestWaveTexels * texel);
}

/// The points of space that the texels of a chart show, row by row. It knows two lines of the
/// chart's vertices at a time, those beside the row of texels.
class ChartPainter {
 public:
  ChartPainter(const ReliefSurface& surface, const PlacedChart& chart)
      : surface_(surface), chart_(chart) {}

  /// Writes the surface points of the texels from (x, y) on.
  void points_of(std::uint32_t x, std::uint32_t y, std::span<Vec3d> points) {
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = point_at(chart_.place_of({static_cast<double>(x + i) + 0.5, y + 0.5}));
  }

 private:
  using Line = std::vector<Vec3d>;

  /// A cell, and a place within it.
  struct CellPlace {
    std::uint32_t column = 0, row = 0;
    double right = 0, up = 0;  ///< 0 to 1
  };

  CellPlace cell_of(ChartPlace place) const {
    const auto below = [](double at, std::uint32_t count) {
      return std::min(static_cast<std::uint32_t>(at), count - 1);
    };
    const std::uint32_t column = below(place.column, chart_.cells.columns());
    const std::uint32_t row = below(place.row, chart_.cells.rows());
    return {column, row, place.column - column, place.row - row};
  }

  /// Returns a point on the triangles of the mesh.
  Vec3d point_at(ChartPlace place) {
    const CellPlace at = cell_of(place);
    load_lines(chart_.rows_stay_rows() ? at.row : at.column);
    const Vec3d low_left = corner(at, 0, 0), low_right = corner(at, 1, 0);
    const Vec3d high_left = corner(at, 0, 1), high_right = corner(at, 1, 1);
    if (is_cut_upwards(grid_point(chart_, at.column, at.row))) {
      return at.right >= at.up
                 ? low_left + (low_right - low_left) * at.right + (high_right - low_right) * at.up
                 : low_left + (high_left - low_left) * at.up + (high_right - high_left) * at.right;
    }
    return at.right + at.up <= 1
               ? low_left + (low_right - low_left) * at.right + (high_left - low_left) * at.up
               : high_right + (high_left - high_right) * (1 - at.right) +
                     (low_right - high_right) * (1 - at.up);
  }

  Vec3d corner(const CellPlace& at, std::uint32_t right, std::uint32_t up) const {
    return chart_.rows_stay_rows() ? lines_[up][at.column + right] : lines_[right][at.row + up];
  }

  void load_lines(std::uint32_t first) {
    if (first_ == first)
      return;
    // Rows of texels walk the lines one by one, upwards or downwards.
    if (first_ && first == *first_ + 1) {
      std::swap(lines_[0], lines_[1]);
      load_line(first + 1, lines_[1]);
    } else if (first_ && first + 1 == *first_) {
      std::swap(lines_[0], lines_[1]);
      load_line(first, lines_[0]);
    } else {
      load_line(first, lines_[0]);
      load_line(first + 1, lines_[1]);
    }
    first_ = first;
  }

  void load_line(std::uint32_t number, Line& line) const {
    line.clear();
    const bool is_row = chart_.rows_stay_rows();
    const std::uint32_t last = is_row ? chart_.cells.columns() : chart_.cells.rows();
    for (std::uint32_t i = 0; i <= last; ++i) {
      const PatchPoint at = is_row ? grid_point(chart_, i, number) : grid_point(chart_, number, i);
      line.push_back(surface_.vertex(at).moved);
    }
  }

  const ReliefSurface& surface_;
  PlacedChart chart_;
  std::optional<std::uint32_t> first_;  ///< number of lines_[0]
  std::array<Line, 2> lines_;
};

/// The charts side by side in a row of a picture's slots.
class SlotRowPainter {
 public:
  SlotRowPainter(const TexturedScan& mesh, std::uint32_t image, std::uint32_t row)
      : mesh_(mesh), points_(mesh.atlas().slot_side()) {
    for (std::uint32_t column = 0; column < mesh.atlas().slots_a_row(); ++column) {
      if (const auto chart = mesh.atlas().chart(image, column, row))
        charts_.emplace_back(mesh.surface(), *chart);
    }
  }

  void paint(std::uint32_t y, std::span<std::uint8_t> row) {
    const std::uint32_t slot = mesh_.atlas().slot_side();
    for (std::size_t i = 0; i < charts_.size(); ++i) {
      charts_[i].points_of(static_cast<std::uint32_t>(i) * slot, y, points_);
      mesh_.paint().paint(points_, row.subspan(3 * i * slot, 3 * std::size_t{slot}));
    }
  }

 private:
  const TexturedScan& mesh_;
  std::vector<ChartPainter> charts_;
  std::vector<Vec3d> points_;
};

}  // namespace

TexturedScan::TexturedScan(const TexturedOptions& options)
    : options_(options),
      surface_(options.surface),
      atlas_(surface_.grid(), options.atlas),
      paint_({options.surface.seed, finest_wave(surface_, atlas_)}) {}

void TexturedScan::visit_charts(const std::function<void(const PlacedChart&)>& visit) const {
  for (std::uint32_t image = 0; image < atlas_.options().images; ++image) {
    for (std::uint32_t row = 0; row < atlas_.slots_a_row(); ++row) {
      for (std::uint32_t column = 0; column < atlas_.slots_a_row(); ++column) {
        if (const auto chart = atlas_.chart(image, column, row))
          visit(*chart);
      }
    }
  }
}

void TexturedScan::visit_rows(
    std::uint32_t image, const std::function<void(std::span<const std::uint8_t>)>& visit) const {
  const std::uint32_t side = atlas_.options().side, slot = atlas_.slot_side();
  std::vector<std::uint8_t> row(3 * std::size_t{side}, kBackground);
  std::uint32_t y = 0;
  for (std::uint32_t slots = 0; slots < atlas_.slots_a_row(); ++slots) {
    SlotRowPainter painter(*this, image, slots);
    std::fill(row.begin(), row.end(), kBackground);
    for (std::uint32_t i = 0; i < slot; ++i) {
      painter.paint(y++, row);
      visit(row);
    }
  }
  std::fill(row.begin(), row.end(), kBackground);
  for (; y < side; ++y)
    visit(row);
}

}  // namespace meshhier::bench
