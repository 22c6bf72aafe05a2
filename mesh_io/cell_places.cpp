#include "mesh_io/cell_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::mesh_io {
namespace {

constexpr std::uint32_t kFewestSteps = 8, kMostSteps = 1024;

double to_grain(double value, double grain) {
  return std::floor(value / grain + 0.5) * grain;
}

bool is_place(MapPoint p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

bool is_within(MapPoint p, MapPoint least, MapPoint most) {
  return p.x >= least.x && p.x <= most.x && p.y >= least.y && p.y <= most.y;
}

/// Returns how far a place is from where it should be, if either of them counts.
double error_of(MapPoint place, MapPoint exact, const CellPlaces::Change& change) {
  if (!is_within(place, change.least, change.most) && !is_within(exact, change.least, change.most))
    return 0;
  if (!is_place(place) || !is_place(exact))
    return std::numeric_limits<double>::infinity();
  return std::max(std::abs(place.x - exact.x), std::abs(place.y - exact.y));
}

/// Returns the sum of four places by their weights.
MapPoint weighed(const std::array<double, 4>& weights, const MapPoint* places,
                 std::size_t stride = 1) {
  MapPoint sum;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum.x += weights[i] * places[i * stride].x;
    sum.y += weights[i] * places[i * stride].y;
  }
  return sum;
}

}  // namespace

CellPlaces::CellPlaces(std::uint32_t columns, std::uint32_t rows, const Change& change)
    : column_cells_(columns - 1.0), row_cells_(rows - 1.0) {
  for (steps_ = kFewestSteps;; steps_ *= 2) {
    ask_nodes(change);
    largest_error_ = ask_between(change);
    if (largest_error_ <= change.tolerance || steps_ == kMostSteps)
      return;
  }
}

MapPoint CellPlaces::node_cell(double column, double row) const {
  return {column_cells_ * column / steps_, row_cells_ * row / steps_};
}

void CellPlaces::ask_nodes(const Change& change) {
  nodes_.clear();
  for (std::uint32_t row = 0; row <= steps_; ++row) {
    for (std::uint32_t column = 0; column <= steps_; ++column) {
      const MapPoint exact = change.exact(node_cell(column, row));
      nodes_.push_back({to_grain(exact.x, change.grain), to_grain(exact.y, change.grain)});
    }
  }
}

double CellPlaces::ask_between(const Change& change) const {
  double largest = 0;
  for (std::uint32_t row = 0; row < steps_; ++row) {
    for (std::uint32_t column = 0; column < steps_; ++column) {
      const MapPoint cell = node_cell(column + 0.5, row + 0.5);
      largest = std::max(largest, error_of(at(cell.x, cell.y), change.exact(cell), change));
    }
  }
  return largest;
}

/// The weights of Lagrange's cubic through 0, 1, 2, 3.
CellPlaces::Stencil CellPlaces::stencil(double in_steps) const {
  const double last = steps_ - 3.0;
  const double first = std::clamp(std::floor(in_steps) - 1, 0.0, last);
  const double a = in_steps - first, b = a - 1, c = a - 2, d = a - 3;
  return {static_cast<std::uint32_t>(first),
          {b * c * d / -6, a * c * d / 2, a * b * d / -2, a * b * c / 6}};
}

MapPoint CellPlaces::on_line(const Stencil& rows, std::uint32_t column) const {
  const std::size_t stride = steps_ + std::size_t{1};
  return weighed(rows.weights, nodes_.data() + rows.first * stride + column, stride);
}

MapPoint CellPlaces::at(double column, double row) const {
  if (!is_changed())
    return map_.at(column, row);
  const auto in_steps = [&](double cell, double cells) {
    return cells > 0 ? cell * (steps_ / cells) : 0;
  };
  const Stencil across = stencil(in_steps(column, column_cells_));
  const Stencil down = stencil(in_steps(row, row_cells_));
  std::array<MapPoint, 4> line;
  for (std::uint32_t i = 0; i < line.size(); ++i)
    line[i] = on_line(down, across.first + i);
  return weighed(across.weights, line.data());
}

void CellPlaces::read(std::uint32_t row, std::uint32_t first, std::span<MapPoint> places) const {
  if (!is_changed()) {
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] = map_.at(static_cast<double>(first + i), row);
    return;
  }
  const double to_steps = column_cells_ > 0 ? steps_ / column_cells_ : 0;
  const Stencil down = stencil(row_cells_ > 0 ? row * (steps_ / row_cells_) : 0);
  std::vector<MapPoint> line;  // the nodes of the row, as far as they are needed
  std::uint32_t line_first = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Stencil across = stencil(static_cast<double>(first + i) * to_steps);
    if (i == 0)
      line_first = across.first;
    while (line_first + line.size() < across.first + std::size_t{4})
      line.push_back(on_line(down, line_first + static_cast<std::uint32_t>(line.size())));
    places[i] = weighed(across.weights, line.data() + (across.first - line_first));
  }
}

}  // namespace meshhier::mesh_io
