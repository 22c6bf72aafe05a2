#include "export/cut_vertices.h"

#include "base/error.h"
#include "export/nearest_vertex.h"
#include "export/tile_vertices.h"

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::exporting {
CutVertices::CutVertices(const storage::HierarchyReader& reader, const NumberedCut& numbered,
                         std::uint64_t cache_bytes, const execution::CancelToken& cancel)
    : reader_(reader),
      rules_(reader.tile_format().attributes),
      numbered_(numbered),
      bases_{0},
      neighbours_(
          cache_bytes,
          [&reader](NodeId node) {
            TileMesh mesh = reader.read_tile(node).mesh;
            auto uses = border_uses(mesh);
            return OwnVertices{std::move(mesh.vertices), std::move(mesh.copies), std::move(uses)};
          },
          [](const OwnVertices& own) {
            return memory_bytes(own.vertices) + memory_bytes(own.copies.vertices) +
                   own.copies.size() * sizeof(std::uint32_t) + own.uses.size() * sizeof(BorderUse);
          }) {
  for (const NodeId node : numbered.cut.nodes()) {
    cancel.check();
    const TileRecord& record = reader.record(node);
    std::uint64_t vertices = record.own_count;
    if (record.copy_count > 0)
      vertices += own_copy_count(reader.read_tile(node).mesh);
    has_copies_ = has_copies_ || vertices > record.own_count;
    bases_.push_back(bases_.back() + vertices);
  }
  if (count() > UINT32_MAX) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: a cut has {} vertices, expected fewer than 2^32",
                            reader.directory().string(), count()));
  }
}

std::vector<CutVertices::BorderUse> CutVertices::border_uses(const TileMesh& mesh) {
  std::vector<BorderUse> uses;
  for (std::size_t t = 0; t < mesh.border_wedges.size(); ++t) {
    const TileTriangle& triangle = mesh.border[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t wedge = mesh.border_wedges[t][i];
      if (wedge == 0 || !mesh.is_own(triangle[i]))
        continue;
      for (const TileVertex other : triangle) {
        if (!mesh.is_own(other))
          uses.push_back({mesh.ghost(other).tile, raw(triangle[i]), wedge});
      }
    }
  }
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  return uses;
}

/// Numbers of the vertices that one tile's corners are.
class CutVertices::TileVertices {
 public:
  TileVertices(CutVertices& cut, std::size_t position, const PublishedTile& tile)
      : cut_(cut), position_(position), tile_(tile), ghosts_(tile.mesh.ghosts.size()) {}

  CutTriangle of(const TileTriangle& places, const CornerWedges& wedges) {
    return {of(places[0], wedges[0]), of(places[1], wedges[1]), of(places[2], wedges[2])};
  }

 private:
  std::uint32_t of(TileVertex place, std::uint32_t wedge) {
    const TileMesh& mesh = tile_.mesh;
    if (mesh.is_own(place))
      return number(position_, mesh.copies, {raw(place), wedge});
    std::vector<std::uint32_t>& vertices = ghosts_[raw(place) - mesh.own_count];
    if (vertices.empty())
      vertices = find(raw(place));
    return vertices[wedge];
  }

  std::uint32_t number(std::size_t position, const Copies& copies, const Wedge& at) const {
    const auto base = static_cast<std::uint32_t>(cut_.bases_[position]);
    if (at.wedge == 0)
      return base + at.place;
    const std::uint32_t places = cut_.reader_.record(cut_.numbered_.cut[position]).own_count;
    return base + places + static_cast<std::uint32_t>(copies.first_of(at.place)) + at.wedge - 1;
  }

  /// The vertices that those at a ghost's place are. Requires that the ghost is not shown finer.
  std::vector<std::uint32_t> find(std::uint32_t place) const {
    const std::size_t ghost = place - tile_.mesh.own_count;
    const ShownGhost shown = *find_ghost(cut_.reader_.tree(), cut_.numbered_, tile_, ghost);
    const std::uint32_t there = shown.number - cut_.numbered_.base(shown.position);
    const auto neighbour = cut_.neighbours_.get(cut_.numbered_.cut[shown.position]);
    const auto here = vertices_at(tile_.mesh.vertices, tile_.mesh.copies, place);
    const auto all = vertices_at(neighbour->vertices, neighbour->copies, there);
    std::vector<std::uint32_t> numbers;
    for (const std::uint32_t wedge : shown.level == tile_.node.level
                                         ? equal_wedges(here, all, neighbour->uses, there, ghost)
                                         : nearest_wedges(here, all))
      numbers.push_back(number(shown.position, neighbour->copies, {there, wedge}));
    return numbers;
  }

  using Wedges = std::vector<std::uint32_t>;

  /// A place's first vertex is the same in all tiles; of its copies a neighbour may have fewer.
  Wedges equal_wedges(const std::vector<VertexAt>& here, const std::vector<VertexAt>& all,
                      std::span<const BorderUse> uses, std::uint32_t place,
                      std::size_t ghost) const {
    Wedges used;
    const auto first =
        std::lower_bound(uses.begin(), uses.end(), BorderUse{tile_.node.index, place, 0});
    for (auto use = first;
         use != uses.end() && use->tile == tile_.node.index && use->place == place; ++use)
      used.push_back(use->wedge);
    if (auto found = match(here, all, used))
      return *found;
    Wedges every(all.size() - 1);
    std::iota(every.begin(), every.end(), 1U);
    if (auto found = match(here, all, every))
      return *found;
    throw Error(ErrorCode::corrupt,
                fmt::format("tile {}: a copy at the place of ghost {} is no vertex of tile {}",
                            to_text(tile_.node), ghost,
                            to_text({tile_.node.level, tile_.mesh.ghosts[ghost].tile})));
  }

  /// Matches each vertex here with the first candidate that is like it, in order; nothing if there
  /// are too few.
  static std::optional<Wedges> match(const std::vector<VertexAt>& here,
                                     const std::vector<VertexAt>& all, const Wedges& candidates) {
    Wedges wedges{0};
    auto next = candidates.begin();
    for (std::size_t i = 1; i < here.size(); ++i) {
      next = std::find_if(next, candidates.end(), [&](std::uint32_t wedge) {
        return has_same_position(here[i], all[wedge]) && has_same_attributes(here[i], all[wedge]);
      });
      if (next == candidates.end())
        return std::nullopt;
      wedges.push_back(*next++);
    }
    return wedges;
  }

  Wedges nearest_wedges(const std::vector<VertexAt>& here, const std::vector<VertexAt>& all) const {
    Wedges wedges;
    for (const VertexAt& vertex : here)
      wedges.push_back(static_cast<std::uint32_t>(nearest_vertex(cut_.rules_, vertex, all)));
    return wedges;
  }

  CutVertices& cut_;
  std::size_t position_;
  const PublishedTile& tile_;
  /// Vertices of each ghost; empty: not looked up.
  std::vector<std::vector<std::uint32_t>> ghosts_;
};

std::vector<CutTriangle> CutVertices::triangles(std::size_t position, const PublishedTile& tile,
                                                const DrawnTile& drawn) {
  if (!has_copies_)
    return drawn.triangles;
  const TileMesh& mesh = tile.mesh;
  TileVertices vertices(*this, position, tile);
  std::vector<CutTriangle> triangles;
  triangles.reserve(drawn.triangles.size());
  for (std::size_t i = 0; i < mesh.interior.size(); ++i)
    triangles.push_back(vertices.of(mesh.interior[i], corner_wedges(mesh.interior_wedges, i)));
  for (const std::uint32_t i : drawn.border)
    triangles.push_back(vertices.of(mesh.border[i], corner_wedges(mesh.border_wedges, i)));
  return triangles;
}

}  // namespace meshhier::exporting
