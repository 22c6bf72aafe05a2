// From cells of a grid to places: of its own map, or of another one.
//
// Problem. A change of maps takes PROJ 0.2 to 1 us a place, a grid has 10^8 cells that are read
// several times, and the last bits of the result depend on the processor.
// Idea. The change is asked at the nodes of a lattice over the grid, and what it says is rounded.
// A cell has the cubic through the nearest 4 x 4 nodes (Lagrange's): sums and products.
//
//      o . . . o . . . o . . . o      o  nodes; at the edges the nearest four are all on one side
//      . . . . . . . . . . . . .      x  amid four of them the change is asked as well: the lattice
//      . . x . . . x . . . x . .         is made twice as fine until the cubic is as near to it as
//      . . . . . . . . . . . . .         it has to be
//      o . . . o . . . o . . . o
//
// Invariant. Equal bytes on every processor, but where a node's last bit before rounding differs.
// Cost. A cell 10 ns. A sheet of a map needs 9 x 9 nodes, at most 1025 x 1025 are made.
#pragma once

#include "mesh_io/height_raster.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace meshhier::mesh_io {

/// A place for each cell, also for what lies between cells. Thread-safe.
class CellPlaces {
 public:
  /// Another map, and how exact it has to be.
  struct Change {
    /// Returns the place of a column and row; NaN: there is none.
    std::function<MapPoint(MapPoint cell)> exact;
    double grain = 0;      ///< places of nodes are multiples of it
    double tolerance = 0;  ///< how far off the cubic may be
    /// Only places within the box count.
    MapPoint least, most;
  };

  /// The places that a map has.
  explicit CellPlaces(const GridMap& map) : map_(map) {}
  /// Makes a lattice over so many columns and rows.
  CellPlaces(std::uint32_t columns, std::uint32_t rows, const Change& change);

  /// Returns places of a row's cells from column `first` on.
  void read(std::uint32_t row, std::uint32_t first, std::span<MapPoint> places) const;
  MapPoint at(double column, double row) const;

  /// Returns whether there is a lattice.
  bool is_changed() const { return !nodes_.empty(); }
  /// Returns how far off the cubic was where the change was asked; infinite if it has no place
  /// there, or the other way round.
  double largest_error() const { return largest_error_; }
  std::uint64_t held_bytes() const { return nodes_.size() * sizeof(MapPoint); }

 private:
  /// The four nodes on an axis that a cell is made of.
  struct Stencil {
    std::uint32_t first = 0;
    std::array<double, 4> weights{};
  };

  Stencil stencil(double in_steps) const;
  void ask_nodes(const Change& change);
  double ask_between(const Change& change) const;
  MapPoint node_cell(double column, double row) const;
  /// Returns what a column of nodes has at a row.
  MapPoint on_line(const Stencil& rows, std::uint32_t column) const;

  GridMap map_;
  std::uint32_t steps_ = 0;                  ///< between nodes, on each axis
  double column_cells_ = 0, row_cells_ = 0;  ///< from the first cells to the last ones
  std::vector<MapPoint> nodes_;              ///< (steps + 1)^2, by rows
  double largest_error_ = 0;
};

}  // namespace meshhier::mesh_io
