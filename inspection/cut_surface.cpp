#include "inspection/cut_surface.h"

#include "execution/parallel.h"

#include <algorithm>
#include <utility>

#include <tbb/task_arena.h>

namespace meshhier::inspection {
namespace {

/// Where a border triangle's corner is shown.
struct ShownCorner {
  std::uint32_t number = 0;
  std::uint32_t tile = 0;  ///< position in the cut
  Vec3f place;

  friend bool operator<(const ShownCorner& a, const ShownCorner& b) { return a.number < b.number; }
};

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

CutSurface::CutSurface(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes,
                       execution::Progress& progress, const execution::CancelToken& cancel)
    : reader_(reader),
      numbered_(number_vertices(reader, std::move(cut))),
      neighbours_(
          cache_bytes,
          [&reader](NodeId node) {
            Positions positions = reader.read_tile(node).mesh.vertices.positions;
            positions.resize(reader.record(node).own_count);
            return positions;
          },
          [](const Positions& positions) { return positions.size() * sizeof(Vec3f); }) {
  reader_.will_read(numbered_.cut.nodes());
  facts_.reserve(numbered_.cut.size());
  execution::ordered_for(
      numbered_.cut.size(), tiles_in_flight(), cancel,
      [this](std::size_t position) { return facts_of(load(position)); },
      [&](std::size_t, const TileSurfaceFacts& facts) {
        facts_.push_back(facts);
        add(total_, facts);
        progress.advance(1);
      });
}

Vec3f CutSurface::shown_position(const ShownGhost& ghost) const {
  const std::scoped_lock lock(mutex_);
  const auto positions = neighbours_.get(numbered_.cut[ghost.position]);
  return (*positions)[ghost.number - numbered_.base(ghost.position)];
}

TileSurface CutSurface::load(std::size_t position) const {
  const PublishedTile tile = reader_.read_tile(numbered_.cut[position]);
  const TileMesh& mesh = tile.mesh;
  const DrawnTile drawn = draw_tile(reader_.tree(), numbered_, position, tile);
  const std::uint32_t base = numbered_.base(position);

  std::vector<ShownCorner> foreign;
  for (std::size_t i = 0; i < mesh.ghosts.size(); ++i) {
    const auto ghost = find_ghost(reader_.tree(), numbered_, tile, i);
    if (!ghost)
      continue;
    const Vec3f place = ghost->level == tile.node.level
                            ? mesh.vertices.positions[mesh.own_count + i]
                            : shown_position(*ghost);
    foreign.push_back({ghost->number, static_cast<std::uint32_t>(ghost->position), place});
  }
  std::sort(foreign.begin(), foreign.end());

  const auto corner_at = [&](std::uint32_t number) {
    if (number >= base && number - base < mesh.own_count)
      return ShownCorner{number, static_cast<std::uint32_t>(position),
                         mesh.vertices.positions[number - base]};
    return *std::lower_bound(foreign.begin(), foreign.end(), ShownCorner{number, 0, {}});
  };

  TileSurface surface;
  surface.interior_count = mesh.interior.size();
  surface.triangles.reserve(drawn.triangles.size());
  surface.touched.reserve(drawn.triangles.size() - mesh.interior.size());
  for (const CutTriangle& t : drawn.triangles) {
    const std::array<ShownCorner, 3> corners{corner_at(t[0]), corner_at(t[1]), corner_at(t[2])};
    surface.triangles.push_back({corners[0].place, corners[1].place, corners[2].place});
    if (surface.triangles.size() > surface.interior_count)
      surface.touched.push_back({corners[0].tile, corners[1].tile, corners[2].tile});
  }
  return surface;
}

}  // namespace meshhier::inspection
