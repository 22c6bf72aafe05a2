// Which cells of a grid have a height, counted: by it each vertex and triangle has its number
// without being stored.
//
// A run is a part of a row, of kRunCells cells. Vertices are cells with a height, row by row.
// Triangles are numbered by the run of their first corner:
//
//      a---b---c     A cell, its right neighbour and the two below them are a square. It has two
//      | \ |   |     triangles; one, if one of the four has no height; else none. The squares of a
//      d---e---f     run are those whose upper left cell is in it.
#pragma once

#include "execution/cancel.h"
#include "mesh_io/mosaic.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::importing {

/// Returns how many triangles a square has by how many of its corners have a height.
constexpr std::uint32_t triangles_of(std::uint32_t corners) {
  return corners == 4 ? 2 : corners == 3 ? 1 : 0;
}

class TerrainCells {
 public:
  static constexpr std::uint32_t kRunCells = 4096;

  /// Some cells of a row.
  struct Run {
    std::uint32_t row = 0, first = 0, count = 0;
  };

  /// Reads all heights and counts them; if there are no voids, it knows without reading. `advance`
  /// is called with parts of the work done, and may throw. Throws as Mosaic::read(), and
  /// Error(input) if there are 2^32 vertices or more, or too many runs; Error(interrupted).
  TerrainCells(const mesh_io::Mosaic& mosaic, const std::function<void(double part)>& advance,
               const execution::CancelToken& cancel);

  std::uint64_t vertices() const { return vertices_.back(); }
  std::uint64_t triangles() const { return triangles_.back(); }
  const mesh_io::SharedCells& shared() const { return shared_; }
  std::uint64_t runs() const { return vertices_.size() - 1; }
  std::uint64_t held_bytes() const;

  Run run(std::uint64_t index) const;
  std::uint64_t run_of(std::uint32_t row, std::uint32_t column) const {
    return std::uint64_t{row} * runs_of_row_ + column / kRunCells;
  }
  /// Returns the run that holds a vertex.
  std::uint64_t run_with(std::uint64_t vertex) const;
  /// Return how many vertices and triangles come before a run, up to runs().
  std::uint64_t vertices_before(std::uint64_t run) const { return vertices_[run]; }
  std::uint64_t triangles_before(std::uint64_t run) const { return triangles_[run]; }

 private:
  struct Counted;

  Counted count_rows(const mesh_io::Mosaic& mosaic, std::uint32_t first, std::uint32_t end) const;
  void take(const Counted& counted);

  std::uint32_t columns_, rows_;
  std::uint32_t runs_of_row_;
  std::vector<std::uint32_t> vertices_;   ///< before each run, and all
  std::vector<std::uint64_t> triangles_;  ///< likewise
  mesh_io::SharedCells shared_;
};

}  // namespace meshhier::importing
