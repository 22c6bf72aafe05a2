#include "bench/patch_grid.h"

#include <cassert>
#include <optional>

namespace meshhier::bench {
namespace {

constexpr std::uint32_t kNoPatch = ~std::uint32_t{0};

std::optional<std::uint32_t> corner_at(PatchPoint p, std::uint32_t n) {
  const bool at_ends = (p.column == 0 || p.column == n) && (p.row == 0 || p.row == n);
  if (!at_ends)
    return std::nullopt;
  return p.row == 0 ? (p.column == 0 ? 0u : 1u) : (p.column == 0 ? 3u : 2u);
}

/// A side and how far along it a point is.
struct SidePoint {
  std::uint32_t side;
  std::uint32_t along;
};

std::optional<SidePoint> side_at(PatchPoint p, std::uint32_t n) {
  if (p.row == 0)
    return SidePoint{0, p.column};
  if (p.column == n)
    return SidePoint{1, p.row};
  if (p.row == n)
    return SidePoint{2, n - p.column};
  if (p.column == 0)
    return SidePoint{3, n - p.row};
  return std::nullopt;
}

PatchPoint point_on(PatchSide at, std::uint32_t along, std::uint32_t n) {
  switch (at.side) {
    case 0:
      return {at.face, along, 0};
    case 1:
      return {at.face, n, along};
    case 2:
      return {at.face, n - along, n};
    default:
      return {at.face, 0, n - along};
  }
}

}  // namespace

PatchGrid::PatchGrid(const QuadMesh& mesh, std::uint32_t cells)
    : cells_(cells),
      faces_(mesh.faces),
      opposite_(opposite_sides(mesh)),
      corner_owner_(mesh.vertices.size(), PatchSide{kNoPatch, 0}) {
  assert(cells >= 1);
  for (std::uint32_t patch = 0; patch < patch_count(); ++patch) {
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
      PatchSide& owner = corner_owner_[faces_[patch][corner]];
      if (owner.face == kNoPatch)
        owner = {patch, corner};
    }
  }
  first_.push_back(0);
  for (std::uint32_t patch = 0; patch < patch_count(); ++patch) {
    const std::uint64_t middle_rows = std::uint64_t{cells_ - 1} * size(parts(patch, 1));
    first_.push_back(first_.back() + size(parts(patch, 0)) + (cells_ > 1 ? middle_rows : 0) +
                     size(parts(patch, cells_)));
  }
}

bool PatchGrid::is_owned(PatchPoint point) const {
  const RowParts row = parts(point.patch, point.row);
  return point.column == 0 ? row.left : point.column == cells_ ? row.right : row.middle;
}

std::uint64_t PatchGrid::index(PatchPoint point) const {
  const PatchPoint owner = owner_of(point);
  std::uint64_t before = first_[owner.patch];
  if (owner.row > 0) {
    before += size(parts(owner.patch, 0));
    if (owner.row > 1)
      before += std::uint64_t{owner.row - 1} * size(parts(owner.patch, 1));
  }
  const RowParts row = parts(owner.patch, owner.row);
  if (owner.column == 0)
    return before;
  before += row.left ? 1 : 0;
  if (owner.column < cells_)
    return before + owner.column - 1;
  return before + (row.middle ? cells_ - 1 : 0);
}

PatchGrid::RowParts PatchGrid::parts(std::uint32_t patch, std::uint32_t row) const {
  const auto owns_corner = [&](std::uint32_t corner) {
    const PatchSide owner = corner_owner_[faces_[patch][corner]];
    return owner.face == patch && owner.side == corner;
  };
  const auto owns_side = [&](std::uint32_t side) { return patch < opposite_[patch][side].face; };
  if (row == 0)
    return {owns_corner(0), owns_side(0), owns_corner(1)};
  if (row == cells_)
    return {owns_corner(3), owns_side(2), owns_corner(2)};
  return {owns_side(3), true, owns_side(1)};
}

std::uint64_t PatchGrid::size(const RowParts& row) const {
  return (row.left ? 1u : 0u) + (row.middle ? cells_ - 1 : 0u) + (row.right ? 1u : 0u);
}

PatchPoint PatchGrid::owner_of(PatchPoint point) const {
  if (const auto corner = corner_at(point, cells_)) {
    const PatchSide owner = corner_owner_[faces_[point.patch][*corner]];
    return point_on(owner, 0, cells_);
  }
  if (const auto on_side = side_at(point, cells_)) {
    const PatchSide across = opposite_[point.patch][on_side->side];
    if (across.face < point.patch)
      return point_on(across, cells_ - on_side->along, cells_);
  }
  return point;
}

}  // namespace meshhier::bench
