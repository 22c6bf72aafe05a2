#include "compare/cut_surface.h"

#include "execution/parallel.h"
#include "export/piece.h"
#include "export/triangle_clipper.h"
#include "hierarchy/value_channels.h"
#include "hierarchy/vertex_numbers.h"

#include <algorithm>
#include <utility>

#include <tbb/task_arena.h>

namespace meshhier::comparing {
namespace {

TileSurfaceFacts facts_of(const TileSurface& tile) {
  TileSurfaceFacts facts;
  facts.triangles = tile.triangles.size();
  for (const SurfaceTriangle& triangle : tile.triangles) {
    const double doubled = doubled_area(triangle);
    facts.area += doubled / 2;
    facts.flat += doubled > 0 ? 0 : 1;
    for (Vec3f corner : triangle)
      facts.bounds.add(corner);
  }
  return facts;
}

TileSurfaceFacts facts_of(const TileRecord& record) {
  TileSurfaceFacts facts;
  facts.triangles = std::uint64_t{record.interior_count} + record.drawn_border_count;
  if (std::uint64_t{record.interior_count} + record.border_count > 0)
    facts.bounds = record.bounds;
  return facts;
}

/// Returns the objects of the triangles that a tile draws, which are those of their first corners.
std::vector<std::uint32_t> objects_of(const TileMesh& mesh, const exporting::DrawnTile& drawn,
                                      const PlacedValue& object) {
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  std::vector<std::uint32_t> objects;
  objects.reserve(drawn.triangles.size());
  const auto add = [&](const TileTriangle& triangle) {
    const std::size_t vertex = raw(triangle[0]), places = mesh.vertices.size();
    const auto attributes = vertex < places ? mesh.vertices.attributes_of(vertex)
                                            : mesh.copies.vertices.attributes_of(vertex - places);
    objects.push_back(static_cast<std::uint32_t>(object.in(attributes.data())));
  };
  for (const TileTriangle& triangle : numbers.numbered(mesh.interior, mesh.interior_wedges))
    add(triangle);
  const auto border = numbers.numbered(mesh.border, mesh.border_wedges);
  for (const std::uint32_t i : drawn.border)
    add(border[i]);
  return objects;
}

/// Tells of each own place whether a triangle has it.
std::vector<bool> used_places(const TileMesh& mesh) {
  std::vector<bool> is_used(mesh.own_count);
  for (const auto* triangles : {&mesh.interior, &mesh.border}) {
    for (const TileTriangle& triangle : *triangles) {
      for (const TileVertex corner : triangle) {
        if (raw(corner) < mesh.own_count)
          is_used[raw(corner)] = true;
      }
    }
  }
  return is_used;
}

void add(TileSurfaceFacts& total, const TileSurfaceFacts& facts) {
  total.triangles += facts.triangles;
  total.flat += facts.flat;
  total.area += facts.area;
  total.bounds.add(facts.bounds);
}

}  // namespace

std::size_t tiles_in_flight() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

std::uint32_t PlacedTile::place_of(std::uint32_t number) const {
  if (number >= base && number - base < own_count)
    return number - base;
  const auto found = std::ranges::lower_bound(foreign, number, {}, &Foreign::number);
  return own_count + static_cast<std::uint32_t>(found - foreign.begin());
}

CutSurface::CutSurface(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes)
    : reader_(reader),
      numbered_(exporting::number_vertices(reader, std::move(cut))),
      neighbours_(
          cache_bytes,
          [&reader](NodeId node) {
            Positions positions = reader.read_tile(node).mesh.vertices.positions;
            positions.resize(reader.record(node).own_count);
            return positions;
          },
          [](const Positions& positions) { return positions.size() * sizeof(Vec3f); }) {
  facts_.reserve(numbered_.cut.size());
  for (const NodeId node : numbered_.cut.nodes()) {
    facts_.push_back(facts_of(reader_.record(node)));
    add(total_, facts_.back());
  }
}

CutSurface::CutSurface(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes,
                       execution::Progress& progress, const execution::CancelToken& cancel,
                       exporting::Region piece)
    : CutSurface(reader, std::move(cut), cache_bytes) {
  piece_ = std::move(piece);
  const std::vector<std::size_t> positions = tiles_in(reader_, numbered_.cut, piece_);
  std::vector<NodeId> nodes;
  for (const std::size_t position : positions)
    nodes.push_back(numbered_.cut[position]);
  reader_.will_read(nodes);
  progress.advance(numbered_.cut.size() - positions.size());
  facts_.assign(facts_.size(), {});
  total_ = {};
  execution::ordered_for(
      positions.size(), tiles_in_flight(), cancel,
      [&](std::size_t i) { return facts_of(load(positions[i])); },
      [&](std::size_t i, const TileSurfaceFacts& facts) {
        facts_[positions[i]] = facts;
        add(total_, facts);
        progress.advance(1);
      });
}

Vec3f CutSurface::shown_position(const exporting::ShownGhost& ghost) const {
  const std::scoped_lock lock(mutex_);
  const auto positions = neighbours_.get(numbered_.cut[ghost.position]);
  return (*positions)[ghost.number - numbered_.base(ghost.position)];
}

/// Returns the places of other tiles that the triangles of a tile have, ascending by number.
std::vector<CutSurface::ForeignPlace> CutSurface::foreign_places(const PublishedTile& tile) const {
  std::vector<ForeignPlace> places;
  for (std::size_t i = 0; i < tile.mesh.ghosts.size(); ++i) {
    const auto ghost = find_ghost(reader_.tree(), numbered_, tile, i);
    if (!ghost)
      continue;
    const Vec3f position = ghost->level == tile.node.level
                               ? tile.mesh.vertices.positions[tile.mesh.own_count + i]
                               : shown_position(*ghost);
    places.push_back({{ghost->number, static_cast<std::uint32_t>(ghost->position)}, position});
  }
  const auto number_of = [](const ForeignPlace& place) { return place.foreign.number; };
  std::ranges::sort(places, {}, number_of);
  // Several ghosts may be shown at one place.
  const auto repeated = std::ranges::unique(places, {}, number_of);
  places.erase(repeated.begin(), repeated.end());
  return places;
}

PlacedTile CutSurface::load_placed(std::size_t position) const {
  const PublishedTile tile = reader_.read_tile(numbered_.cut[position]);
  const TileMesh& mesh = tile.mesh;
  exporting::DrawnTile drawn = draw_tile(reader_.tree(), numbered_, position, tile);
  PlacedTile placed;
  if (const auto object = placed_object(reader_.tile_format().attributes))
    placed.facts.objects = objects_of(mesh, drawn, *object);
  placed.facts.interior_count = mesh.interior.size();
  placed.facts.border = std::move(drawn.border);
  placed.base = numbered_.base(position);
  placed.own_count = mesh.own_count;
  placed.is_used = used_places(mesh);
  placed.places.assign(mesh.vertices.positions.begin(),
                       mesh.vertices.positions.begin() + mesh.own_count);
  for (const ForeignPlace& place : foreign_places(tile)) {
    placed.places.push_back(place.position);
    placed.foreign.push_back(place.foreign);
  }
  placed.triangles = std::move(drawn.triangles);
  for (exporting::CutTriangle& triangle : placed.triangles) {
    for (std::uint32_t& corner : triangle)
      corner = placed.place_of(corner);
  }
  return placed;
}

TileSurface CutSurface::load(std::size_t position) const {
  PlacedTile placed = load_placed(position);
  const auto tile_of = [&](std::uint32_t place) {
    return place < placed.own_count ? static_cast<std::uint32_t>(position)
                                    : placed.foreign[place - placed.own_count].tile;
  };
  TileSurface surface;
  surface.facts = std::move(placed.facts);
  surface.triangles.reserve(placed.triangles.size());
  surface.touched.reserve(placed.triangles.size() - surface.facts.interior_count);
  for (const Triangle<std::uint32_t>& t : placed.triangles) {
    surface.triangles.push_back({placed.places[t[0]], placed.places[t[1]], placed.places[t[2]]});
    if (surface.triangles.size() > surface.facts.interior_count)
      surface.touched.push_back({tile_of(t[0]), tile_of(t[1]), tile_of(t[2])});
  }
  return piece_.is_all() ? surface : piece_of(std::move(surface));
}

TileSurface CutSurface::piece_of(TileSurface tile) const {
  const exporting::CornerMixer mixer(reader_.tile_format().attributes, 0);
  const exporting::TriangleClipper clipper(piece_, mixer);
  exporting::ClippedPolygon corners(3);
  TileSurface piece;
  for (std::uint32_t i = 0; i < tile.triangles.size(); ++i) {
    for (std::size_t k = 0; k < corners.size(); ++k)
      corners[k].position = tile.triangles[i][k];
    if ((piece_.objects && !piece_.objects->has(tile.facts.objects[i])) ||
        !clipper.touches(corners))
      continue;
    piece.triangles.push_back(tile.triangles[i]);
    piece.facts.numbers.push_back(tile.facts.number_in_tile(i));
    if (!tile.facts.objects.empty())
      piece.facts.objects.push_back(tile.facts.objects[i]);
    if (i < tile.facts.interior_count)
      ++piece.facts.interior_count;
    else
      piece.touched.push_back(tile.touched[i - tile.facts.interior_count]);
  }
  return piece;
}

}  // namespace meshhier::comparing
