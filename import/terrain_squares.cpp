#include "import/terrain_squares.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace meshhier::importing {
namespace {

constexpr std::size_t kLeft = 1, kRight = 2;  ///< cells around a run

/// The heights of the rows around a square, at its left column.
struct Around {
  std::array<const double*, 4> rows;

  double at(std::size_t row, std::ptrdiff_t column) const { return rows[row][column]; }
};

/// Returns 16 times the cubic's value in the middle of a row's four cells.
double cubic(const double* cells) {
  return 9 * (cells[0] + cells[1]) - (cells[-1] + cells[2]);
}

/// Returns whether a square is cut from its upper left corner to the lower right one.
bool is_cut_down(const Around& around) {
  const double a = around.at(1, 0), b = around.at(1, 1), d = around.at(2, 0), e = around.at(2, 1);
  constexpr double kWeights = 256;
  const double middle = (9 * (cubic(around.rows[1]) + cubic(around.rows[2])) -
                         (cubic(around.rows[0]) + cubic(around.rows[3]))) /
                        kWeights;
  if (std::isnan(middle))
    return std::abs(a - e) <= std::abs(b - d);
  return std::abs((a + e) / 2 - middle) <= std::abs((b + d) / 2 - middle);
}

/// Appends triangles whose corners turn left, where rows go south.
class Corners {
 public:
  Corners(bool is_mirrored, std::vector<Triangle<VertexId>>& to)
      : is_mirrored_(is_mirrored), to_(to) {}

  void add(std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    if (is_mirrored_)
      std::swap(q, r);
    to_.push_back({VertexId{p}, VertexId{q}, VertexId{r}});
  }

 private:
  bool is_mirrored_;
  std::vector<Triangle<VertexId>>& to_;
};

}  // namespace

void TerrainSquares::read_row(const TerrainCells::Run& run, std::int64_t row,
                              std::vector<double>& to) const {
  to.assign(kLeft + run.count + kRight, std::numeric_limits<double>::quiet_NaN());
  if (row < 0 || row >= mosaic_.rows())
    return;
  const std::uint32_t first = run.first > 0 ? run.first - static_cast<std::uint32_t>(kLeft) : 0;
  const std::uint32_t end = std::min<std::uint32_t>(
      run.first + run.count + static_cast<std::uint32_t>(kRight), mosaic_.columns());
  const std::size_t at = kLeft + first - run.first;
  mosaic_.read(static_cast<std::uint32_t>(row), first, std::span(to).subspan(at, end - first));
}

void TerrainSquares::read(std::uint64_t index, Rows& rows) const {
  const TerrainCells::Run run = cells_.run(index);
  const std::int64_t first = std::int64_t{run.row} - 1;
  const std::uint64_t above = index - cells_.run_of(1, 0);
  std::size_t known = 0;  // rows that the run above it has read
  if (run.row > 0 && rows.run == above) {
    std::ranges::rotate(rows.heights, rows.heights.begin() + 1);
    known = rows.heights.size() - 1;
  }
  for (std::size_t i = known; i < rows.heights.size(); ++i)
    read_row(run, first + static_cast<std::int64_t>(i), rows.heights[i]);
  rows.run = index;
}

void TerrainSquares::triangulate(std::uint64_t index, Rows& rows,
                                 std::vector<Triangle<VertexId>>& to) const {
  const TerrainCells::Run run = cells_.run(index);
  if (cells_.triangles_before(index + 1) == cells_.triangles_before(index))
    return;
  read(index, rows);
  const std::uint64_t below = cells_.run_of(run.row + 1, run.first);
  auto upper = static_cast<std::uint32_t>(cells_.vertices_before(index));
  auto lower = static_cast<std::uint32_t>(cells_.vertices_before(below));
  Corners corners(is_mirrored_, to);
  for (std::size_t i = kLeft; i < kLeft + run.count; ++i) {
    const Around around{{rows.heights[0].data() + i, rows.heights[1].data() + i,
                         rows.heights[2].data() + i, rows.heights[3].data() + i}};
    const bool has_a = !std::isnan(around.at(1, 0)), has_b = !std::isnan(around.at(1, 1));
    const bool has_d = !std::isnan(around.at(2, 0)), has_e = !std::isnan(around.at(2, 1));
    const std::uint32_t a = upper, b = a + (has_a ? 1 : 0);
    const std::uint32_t d = lower, e = d + (has_d ? 1 : 0);
    upper = b;
    lower = e;
    const int count = has_a + has_b + has_d + has_e;
    if (count == 4) {
      const bool is_down = is_cut_down(around);
      corners.add(a, d, is_down ? e : b);
      corners.add(e, b, is_down ? a : d);
    } else if (count == 3) {
      const auto [p, q, r] = !has_a   ? std::array{b, d, e}
                             : !has_b ? std::array{a, d, e}
                             : !has_d ? std::array{a, e, b}
                                      : std::array{a, d, b};
      corners.add(p, q, r);
    }
  }
}

}  // namespace meshhier::importing
