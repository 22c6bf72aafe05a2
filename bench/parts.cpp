#include "bench/parts.h"

#include "hierarchy/bounds.h"
#include "hierarchy/error.h"
#include "partition/compactness.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {

PlainMesh plain_mesh(const LoadedMesh& mesh) {
  Vec3d origin;
  if (mesh.double_coordinates) {
    BoundsD bounds;
    for (const Vec3d p : mesh.positions)
      bounds.add(p);
    origin = bounds.min * 0.5 + bounds.max * 0.5;
  }
  PlainMesh plain;
  plain.positions.reserve(mesh.positions.size());
  for (const Vec3d p : mesh.positions)
    plain.positions.push_back(to_float(p - origin));
  plain.triangles = mesh.triangles;
  return plain;
}

Parts without_empty_parts(std::vector<std::uint32_t> part_of, std::uint32_t count) {
  std::vector<std::uint32_t> number(count);
  for (const std::uint32_t part : part_of)
    number[part] = 1;
  std::uint32_t kept = 0;
  for (std::uint32_t& entry : number)
    entry = std::exchange(kept, kept + entry);
  for (std::uint32_t& part : part_of)
    part = number[part];
  return {std::move(part_of), kept};
}

void check_part_count(std::size_t points, std::uint32_t count) {
  if (count < 1 || count > points) {
    throw Error(ErrorCode::usage,
                fmt::format("{} vertices cannot be divided into {} parts that hold one at least",
                            points, count));
  }
}

/// Calls visit(part) once for each part that a corner belongs to.
template <class Visit>
void PartTiles::for_each_part(const MeshTriangle& triangle, const Visit& visit) const {
  const std::uint32_t a = parts_.part_of[triangle[0]];
  const std::uint32_t b = parts_.part_of[triangle[1]];
  const std::uint32_t c = parts_.part_of[triangle[2]];
  visit(a);
  if (b != a)
    visit(b);
  if (c != a && c != b)
    visit(c);
}

PartTiles::PartTiles(const PlainMesh& mesh, const Parts& parts)
    : mesh_(mesh), parts_(parts), place_(mesh.positions.size()) {
  vertices_.starts.resize(std::size_t{parts.count} + 1);
  triangles_.starts.resize(std::size_t{parts.count} + 1);
  for (std::size_t v = 0; v < place_.size(); ++v)
    place_[v] = static_cast<std::uint32_t>(vertices_.starts[parts.part_of[v] + 1]++);
  for (const MeshTriangle& t : mesh.triangles)
    for_each_part(t, [&](std::uint32_t part) { ++triangles_.starts[part + 1]; });
  for (std::uint32_t part = 0; part < parts.count; ++part) {
    vertices_.starts[part + 1] += vertices_.starts[part];
    triangles_.starts[part + 1] += triangles_.starts[part];
  }
  vertices_.numbers.resize(vertices_.starts.back());
  triangles_.numbers.resize(triangles_.starts.back());
  for (std::uint32_t v = 0; v < place_.size(); ++v)
    vertices_.numbers[vertices_.starts[parts.part_of[v]] + place_[v]] = v;
  std::vector<std::size_t> next(triangles_.starts.begin(), triangles_.starts.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for_each_part(mesh.triangles[t],
                  [&](std::uint32_t part) { triangles_.numbers[next[part]++] = t; });
  }
}

BuildTile PartTiles::tile(std::uint32_t part) const {
  BuildTile tile;
  TileMesh& mesh = tile.mesh;
  const auto own = vertices_.of(part);
  mesh.own_count = mesh.boundary_count = static_cast<std::uint32_t>(own.size());
  const auto is_own = [&](std::uint32_t v) { return parts_.part_of[v] == part; };
  const auto ghost_of = [&](std::uint32_t v) { return GhostRef{parts_.part_of[v], place_[v]}; };
  for (const std::uint32_t t : triangles_.of(part)) {
    for (const std::uint32_t v : mesh_.triangles[t]) {
      if (!is_own(v))
        mesh.ghosts.push_back(ghost_of(v));
    }
  }
  std::sort(mesh.ghosts.begin(), mesh.ghosts.end());
  mesh.ghosts.erase(std::unique(mesh.ghosts.begin(), mesh.ghosts.end()), mesh.ghosts.end());

  mesh.vertices.reserve(own.size() + mesh.ghosts.size());
  for (const std::uint32_t v : own)
    mesh.vertices.append(mesh_.positions[v], {});
  for (const GhostRef& ghost : mesh.ghosts)
    mesh.vertices.append(mesh_.positions[vertices_.of(ghost.tile)[ghost.index]], {});
  tile.history.weights.assign(own.size(), 1);

  for (const std::uint32_t t : triangles_.of(part)) {
    TileTriangle placed{};
    bool interior = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh_.triangles[t][k];
      if (is_own(v)) {
        placed[k] = static_cast<TileVertex>(place_[v]);
        continue;
      }
      const auto found = std::lower_bound(mesh.ghosts.begin(), mesh.ghosts.end(), ghost_of(v));
      const auto index = static_cast<std::uint32_t>(found - mesh.ghosts.begin());
      placed[k] = static_cast<TileVertex>(mesh.own_count + index);
      interior = false;
    }
    (interior ? mesh.interior : mesh.border).push_back(placed);
  }
  return tile;
}

PartFigures measure_parts(const PlainMesh& mesh, const Parts& parts) {
  const PartTiles tiles(mesh, parts);
  PartFigures figures{.count = parts.count,
                      .least_vertices = std::numeric_limits<std::uint64_t>::max()};
  std::vector<double> values;
  for (std::uint32_t part = 0; part < parts.count; ++part) {
    const BuildTile tile = tiles.tile(part);
    const std::uint64_t size = tile.mesh.own_count;
    figures.least_vertices = std::min(figures.least_vertices, size);
    figures.most_vertices = std::max(figures.most_vertices, size);
    const double value = partition::compactness(tile.mesh);
    if (value > 0)
      values.push_back(value);
    else
      ++figures.without_area;
    figures.mean_compactness += value;
  }
  figures.mean_vertices = static_cast<double>(mesh.positions.size()) / parts.count;
  if (values.empty())
    return figures;
  figures.mean_compactness /= static_cast<double>(values.size());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  figures.median_compactness = *middle;
  return figures;
}

}  // namespace meshhier::bench
