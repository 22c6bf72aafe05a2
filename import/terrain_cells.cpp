#include "import/terrain_cells.h"

#include "base/error.h"
#include "execution/parallel.h"
#include "mesh_io/mesh_source.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::uint64_t kMostRuns = std::uint64_t{1} << 24;
constexpr std::size_t kBandsInFlight = 32;

}  // namespace

/// The counts of the runs of some rows.
struct TerrainCells::Counted {
  std::vector<std::uint32_t> vertices, triangles;
  mesh_io::SharedCells shared;
};

TerrainCells::TerrainCells(const mesh_io::Mosaic& mosaic,
                           const std::function<void(double part)>& advance,
                           const execution::CancelToken& cancel)
    : columns_(mosaic.columns()),
      rows_(mosaic.rows()),
      runs_of_row_((mosaic.columns() - 1) / kRunCells + 1) {
  const std::uint64_t runs = std::uint64_t{rows_} * runs_of_row_;
  if (runs > kMostRuns)
    throw Error(ErrorCode::input, fmt::format("the heights have {} rows, too many", rows_));
  vertices_.reserve(runs + 1);
  triangles_.reserve(runs + 1);
  vertices_.push_back(0);
  triangles_.push_back(0);
  const auto rows_of_band = static_cast<std::uint32_t>(
      std::max<std::uint64_t>(1, mesh_io::MeshSource::kBlockSize / columns_));
  const std::size_t bands = (rows_ - 1) / rows_of_band + 1;
  execution::ordered_for(
      bands, kBandsInFlight, cancel,
      [&](std::size_t band) {
        const auto first = static_cast<std::uint32_t>(band * rows_of_band);
        return count_rows(mosaic, first, std::min(rows_ - first, rows_of_band) + first);
      },
      [&](std::size_t, const Counted& counted) {
        take(counted);
        advance(1.0 / static_cast<double>(bands));
      });
}

std::uint64_t TerrainCells::held_bytes() const {
  return vertices_.capacity() * sizeof(vertices_[0]) +
         triangles_.capacity() * sizeof(triangles_[0]);
}

TerrainCells::Run TerrainCells::run(std::uint64_t index) const {
  const auto first = static_cast<std::uint32_t>(index % runs_of_row_ * kRunCells);
  return {static_cast<std::uint32_t>(index / runs_of_row_), first,
          std::min(kRunCells, columns_ - first)};
}

std::uint64_t TerrainCells::run_with(std::uint64_t vertex) const {
  const auto behind = std::ranges::upper_bound(vertices_, vertex);
  return static_cast<std::uint64_t>(behind - vertices_.begin()) - 1;
}

TerrainCells::Counted TerrainCells::count_rows(const mesh_io::Mosaic& mosaic, std::uint32_t first,
                                               std::uint32_t end) const {
  Counted counted;
  // One cell more than there are: behind the last one there is nothing.
  std::vector<std::uint8_t> upper(columns_ + 1), lower(columns_ + 1);
  std::vector<double> heights(mosaic.may_have_voids() ? columns_ : 0);
  const auto read = [&](std::uint32_t row, std::vector<std::uint8_t>& to,
                        mesh_io::SharedCells* shared) {
    if (!mosaic.may_have_voids())
      std::fill_n(to.begin(), columns_, std::uint8_t{1});
    else
      mosaic.read(row, 0, heights, shared);
    for (std::size_t i = 0; i < heights.size(); ++i)
      to[i] = std::isnan(heights[i]) ? 0 : 1;
  };
  read(first, lower, &counted.shared);
  for (std::uint32_t row = first; row < end; ++row) {
    upper.swap(lower);
    if (row + 1 < rows_)
      read(row + 1, lower, row + 1 < end ? &counted.shared : nullptr);
    else
      std::ranges::fill(lower, std::uint8_t{0});
    for (std::uint32_t begin = 0; begin < columns_; begin += kRunCells) {
      std::uint32_t vertices = 0, triangles = 0;
      for (std::uint32_t i = begin; i < std::min(columns_, begin + kRunCells); ++i) {
        vertices += upper[i];
        triangles += triangles_of(0U + upper[i] + upper[i + 1] + lower[i] + lower[i + 1]);
      }
      counted.vertices.push_back(vertices);
      counted.triangles.push_back(triangles);
    }
  }
  return counted;
}

void TerrainCells::take(const Counted& counted) {
  shared_ += counted.shared;
  for (std::size_t i = 0; i < counted.vertices.size(); ++i) {
    const std::uint64_t vertices = std::uint64_t{vertices_.back()} + counted.vertices[i];
    if (vertices >= std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorCode::input, "the heights are 2^32 or more; build parts of them");
    vertices_.push_back(static_cast<std::uint32_t>(vertices));
    triangles_.push_back(triangles_.back() + counted.triangles[i]);
  }
}

}  // namespace meshhier::importing
