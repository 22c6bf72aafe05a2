#include "cluster_simplify/seam_wedges.h"

#include "base/error.h"
#include "cluster_simplify/seams.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace meshhier::cluster_simplify {
namespace {

/// A wedge of a ghost, by its number in the ghost's own tile.
struct GhostWedge {
  std::uint32_t ghost = 0;
  std::uint32_t wedge = 0;
  friend constexpr auto operator<=>(const GhostWedge&, const GhostWedge&) = default;
};

/// Sorts and removes repeats.
void sort_unique(std::vector<GhostWedge>& wedges) {
  std::sort(wedges.begin(), wedges.end());
  wedges.erase(std::unique(wedges.begin(), wedges.end()), wedges.end());
}

/// The number that a wedge gets among those of its ghost in `sorted`.
std::uint32_t local_number(std::span<const GhostWedge> sorted, const GhostWedge& wedge) {
  if (wedge.wedge == 0)
    return 0;
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), GhostWedge{wedge.ghost, 0});
  const auto found = std::lower_bound(first, sorted.end(), wedge);
  return static_cast<std::uint32_t>(found - first) + 1;
}

/// The number of a ghost's wedge in the ghost's own tile.
std::uint32_t owners_number(const TileMesh& mesh, TileVertex ghost, std::uint32_t wedge) {
  if (wedge == 0)
    return 0;
  const std::size_t own_copies = mesh.copies.size() - mesh.ghost_wedges.size();
  return mesh.ghost_wedges[mesh.copies.first_of(raw(ghost)) - own_copies + wedge - 1];
}

/// The inverse, for a wedge that the tile has.
std::uint32_t copies_number(const TileMesh& mesh, TileVertex ghost, std::uint32_t wedge) {
  const std::size_t own_copies = mesh.copies.size() - mesh.ghost_wedges.size();
  const auto begin = mesh.ghost_wedges.begin() +
                     static_cast<std::ptrdiff_t>(mesh.copies.first_of(raw(ghost)) - own_copies);
  const auto end = mesh.ghost_wedges.begin() +
                   static_cast<std::ptrdiff_t>(mesh.copies.first_of(raw(ghost) + 1) - own_copies);
  return static_cast<std::uint32_t>(std::lower_bound(begin, end, wedge) - begin) + 1;
}

/// The copies of ghosts, as GhostWedge: of all but own places.
std::vector<GhostWedge> ghost_copies(const TileMesh& mesh) {
  std::vector<GhostWedge> copies(mesh.ghost_wedges.size());
  const std::size_t own_copies = mesh.copies.size() - copies.size();
  for (std::size_t i = 0; i < copies.size(); ++i)
    copies[i] = {mesh.copies.places[own_copies + i] - mesh.own_count, mesh.ghost_wedges[i]};
  return copies;
}

}  // namespace

void number_ghost_wedges(TileMesh& mesh) {
  std::vector<GhostWedge> used;
  const auto for_each_ghost_corner = [&](const auto& visit) {
    for (std::size_t i = 0; i < mesh.border_wedges.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (const TileVertex v = mesh.border[i][k]; !mesh.is_own(v))
          visit(raw(v) - mesh.own_count, mesh.border_wedges[i][k]);
      }
    }
  };
  for_each_ghost_corner([&](std::uint32_t ghost, std::uint32_t wedge) {
    if (wedge > 0)
      used.push_back({ghost, wedge});
  });
  sort_unique(used);
  for_each_ghost_corner([&](std::uint32_t ghost, std::uint32_t& wedge) {
    wedge = local_number(used, {ghost, wedge});
  });
  mesh.copies.vertices.channels = mesh.vertices.channels;
  for (const GhostWedge& copy : used) {
    mesh.copies.places.push_back(mesh.own_count + copy.ghost);
    mesh.ghost_wedges.push_back(copy.wedge);
  }
  if (!mesh.copies.empty())
    return;
  mesh.interior_wedges.clear();
  mesh.border_wedges.clear();
}

void name_ghost_wedges(const TileMesh& mesh, std::vector<CornerWedges>& border_wedges) {
  for (std::size_t i = 0; i < border_wedges.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!mesh.is_own(mesh.border[i][k]))
        border_wedges[i][k] = owners_number(mesh, mesh.border[i][k], border_wedges[i][k]);
    }
  }
}

void fill_ghost_copies(TileMesh& mesh, const Boundary& boundary) {
  Copies& copies = mesh.copies;
  const std::size_t own_copies = copies.size() - mesh.ghost_wedges.size();
  for (std::size_t i = copies.vertices.size();
       i < copies.size() && copies.places[i] < mesh.vertices.size(); ++i) {
    const GhostRef& ghost = mesh.ghost(TileVertex{copies.places[i]});
    const std::size_t copy =
        boundary.copies.first_of(ghost.index) + mesh.ghost_wedges[i - own_copies] - 1;
    if (copy >= boundary.copies.size() || boundary.copies.places[copy] != ghost.index)
      throw Error(ErrorCode::internal, "a ghost has a wedge that its tile does not have");
    copies.vertices.append(boundary.copies.vertices, copy, copy + 1);
  }
}

void join_copies(const TileMesh& first, std::uint32_t second_index, const TileMesh& second,
                 std::uint32_t first_index, TileMesh& joined) {
  Copies& copies = joined.copies;
  copies.vertices.channels = joined.vertices.channels;
  const auto add_own = [&](const TileMesh& tile, std::uint32_t offset) {
    const std::size_t count = tile.copies.first_of(tile.own_count);
    copies.vertices.append(tile.copies.vertices, 0, count);
    for (std::size_t i = 0; i < count; ++i)
      copies.places.push_back(tile.copies.places[i] + offset);
  };
  add_own(first, 0);
  add_own(second, first.own_count);

  struct Outside {
    GhostWedge wedge;  ///< of a ghost of the joined tile
    const TileMesh* tile;
    std::size_t copy;
  };
  std::vector<Outside> outside;
  const auto collect = [&](const TileMesh& tile, std::uint32_t sibling) {
    const std::vector<GhostWedge> ghosts = ghost_copies(tile);
    for (std::size_t i = 0; i < ghosts.size(); ++i) {
      const GhostRef& ref = tile.ghosts[ghosts[i].ghost];
      if (ref.tile == sibling)
        continue;
      const auto found = std::lower_bound(joined.ghosts.begin(), joined.ghosts.end(), ref);
      outside.push_back(
          {{static_cast<std::uint32_t>(found - joined.ghosts.begin()), ghosts[i].wedge},
           &tile,
           tile.copies.size() - ghosts.size() + i});
    }
  };
  collect(first, second_index);
  collect(second, first_index);
  std::stable_sort(outside.begin(), outside.end(),
                   [](const Outside& a, const Outside& b) { return a.wedge < b.wedge; });
  outside.erase(std::unique(outside.begin(), outside.end(),
                            [](const Outside& a, const Outside& b) { return a.wedge == b.wedge; }),
                outside.end());
  for (const Outside& copy : outside) {
    copies.places.push_back(joined.own_count + copy.wedge.ghost);
    joined.ghost_wedges.push_back(copy.wedge.wedge);
    copies.vertices.append(copy.tile->copies.vertices, copy.copy, copy.copy + 1);
  }
}

CornerWedges joined_wedges(const TileMesh& tile, std::size_t border, const TileTriangle& placed,
                           const TileMesh& joined) {
  if (tile.border_wedges.empty())
    return {};
  CornerWedges wedges = tile.border_wedges[border];
  for (std::size_t k = 0; k < 3; ++k) {
    const TileVertex v = tile.border[border][k];
    if (tile.is_own(v) || wedges[k] == 0)
      continue;
    wedges[k] = owners_number(tile, v, wedges[k]);
    if (!joined.is_own(placed[k]))
      wedges[k] = copies_number(joined, placed[k], wedges[k]);
  }
  return wedges;
}

void append_wedges(std::size_t count, std::span<const CornerWedges> wedges,
                   std::vector<CornerWedges>& to) {
  to.insert(to.end(), wedges.begin(), wedges.end());
  to.resize(to.size() + (wedges.empty() ? count : 0));
}

void drop_degenerate(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    triangles[kept] = triangles[i];
    wedges[kept] = wedges[i];
    kept += std::size_t{!is_degenerate(triangles[i])};
  }
  triangles.resize(kept);
  wedges.resize(kept);
}

void keep_one_of_places(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges,
                        const std::function<GhostRef(TileVertex)>& ref) {
  struct Named {
    TileTriangle places;
    CornerWedges named;   ///< from the corner on whose name is the least
    CornerWedges wedges;  ///< from the first place on
  };
  std::vector<Named> sorted;
  sorted.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const TileTriangle& t = triangles[i];
    if (is_degenerate(t))
      continue;
    const std::array<GhostRef, 3> names{ref(t[0]), ref(t[1]), ref(t[2])};
    const auto least = std::min_element(names.begin(), names.end()) - names.begin();
    const std::size_t first = smallest_corner(t);
    sorted.push_back({turned(t, first), turned(wedges[i], static_cast<std::size_t>(least)),
                      turned(wedges[i], first)});
  }
  std::sort(sorted.begin(), sorted.end(), [](const Named& a, const Named& b) {
    return std::tie(a.places, a.named) < std::tie(b.places, b.named);
  });
  sorted.erase(std::unique(sorted.begin(), sorted.end(),
                           [](const Named& a, const Named& b) { return a.places == b.places; }),
               sorted.end());
  triangles.resize(sorted.size());
  wedges.resize(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    triangles[i] = sorted[i].places;
    wedges[i] = sorted[i].wedges;
  }
}

void drop_equal(std::vector<TileTriangle>& triangles, std::vector<CornerWedges>& wedges) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < wedges.size(); ++i) {
    if (kept > 0 && triangles[kept - 1] == triangles[i] && wedges[kept - 1] == wedges[i])
      continue;
    triangles[kept] = triangles[i];
    wedges[kept++] = wedges[i];
  }
  if (!wedges.empty())
    triangles.resize(kept);
  wedges.resize(kept);
}

std::vector<CornerWedges> wedges_of_images(const TileMesh& joined,
                                           std::span<const TileTriangle> triangles,
                                           std::span<const CornerWedges> wedges,
                                           const ContractedTile& contracted) {
  std::vector<CornerWedges> kept;
  kept.reserve(triangles.size());
  const auto image = [&](TileVertex v) {
    return joined.is_own(v) ? std::uint32_t{contracted.parent_map[raw(v)]} : raw(v) + (1U << 16);
  };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const TileTriangle& t = triangles[i];
    if (is_degenerate(Triangle<std::uint32_t>{image(t[0]), image(t[1]), image(t[2])}))
      continue;
    CornerWedges& corners = kept.emplace_back(wedges.empty() ? CornerWedges{} : wedges[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = joined.is_own(t[k]) ? contracted.wedge_map(raw(t[k]), corners[k])
                                       : owners_number(joined, t[k], corners[k]);
    }
  }
  return kept;
}

}  // namespace meshhier::cluster_simplify
