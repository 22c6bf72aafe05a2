#include "tests/cluster_simplify/wedge_tiles.h"

#include "hierarchy/tile_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

namespace meshhier::tests {
namespace {

/// Equal for 0 and -0.
std::array<float, 3> key_of(Vec3f p) {
  return {p.x + 0.0F, p.y + 0.0F, p.z + 0.0F};
}

std::vector<float> attributes_of(const WedgeMesh& mesh, std::uint32_t v) {
  const auto width = static_cast<std::ptrdiff_t>(mesh.channels);
  const auto begin = mesh.attributes.begin() + v * width;
  return {begin, begin + width};
}

/// The vertices at each place, own places first.
struct Places {
  std::vector<std::vector<std::uint32_t>> vertices;
  std::uint32_t own_count = 0;
  std::vector<std::uint32_t> place_of, wedge_of;  ///< per vertex
};

Places places_of(const WedgeMesh& mesh, float limit) {
  Places places;
  places.place_of.resize(mesh.positions.size());
  places.wedge_of.resize(mesh.positions.size());
  std::map<std::array<float, 3>, std::uint32_t> known;
  for (const bool ghosts : {false, true}) {
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
      if ((mesh.positions[v].x > limit) != ghosts)
        continue;
      const auto place = known
                             .try_emplace(key_of(mesh.positions[v]),
                                          static_cast<std::uint32_t>(places.vertices.size()))
                             .first->second;
      places.vertices.resize(known.size());
      places.place_of[v] = place;
      places.wedge_of[v] = static_cast<std::uint32_t>(places.vertices[place].size());
      places.vertices[place].push_back(v);
    }
    if (!ghosts)
      places.own_count = static_cast<std::uint32_t>(places.vertices.size());
  }
  return places;
}

void add_vertices(const WedgeMesh& mesh, const Places& places, TileMesh& tile) {
  tile.vertices.channels = mesh.channels;
  tile.copies.vertices.channels = mesh.channels;
  for (std::uint32_t place = 0; place < places.vertices.size(); ++place) {
    for (const std::uint32_t v : places.vertices[place]) {
      const bool is_first = v == places.vertices[place].front();
      (is_first ? tile.vertices : tile.copies.vertices)
          .append(mesh.positions[v], attributes_of(mesh, v));
      if (!is_first)
        tile.copies.places.push_back(place);
    }
  }
  for (std::uint32_t i = 0; i + places.own_count < places.vertices.size(); ++i)
    tile.ghosts.push_back({1, i});
}

void add_triangle(const MeshTriangle& t, const Places& places, TileMesh& tile) {
  TileTriangle corners{};
  CornerWedges wedges{};
  std::size_t own = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = TileVertex{places.place_of[t[k]]};
    wedges[k] = places.wedge_of[t[k]];
    own += std::size_t{places.place_of[t[k]] < places.own_count};
  }
  if (own == 0)
    return;
  (own == 3 ? tile.interior : tile.border).push_back(corners);
  if (!tile.copies.empty())
    (own == 3 ? tile.interior_wedges : tile.border_wedges).push_back(wedges);
}

}  // namespace

std::uint32_t WedgeMesh::add(Vec3f position, const std::vector<float>& vertex_attributes) {
  positions.push_back(position);
  attributes.insert(attributes.end(), vertex_attributes.begin(), vertex_attributes.end());
  return static_cast<std::uint32_t>(positions.size()) - 1;
}

WedgeMesh soup_of(const TestMesh& mesh, int channels, const CornerAttributes& attributes) {
  WedgeMesh soup{channels, {}, {}, {}};
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    MeshTriangle corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = mesh.positions[mesh.triangles[i][k]];
      corners[k] = soup.add(p, attributes(i, p));
    }
    soup.triangles.push_back(corners);
  }
  return soup;
}

WedgeMesh welded(const WedgeMesh& mesh) {
  WedgeMesh result{mesh.channels, {}, {}, mesh.triangles};
  std::map<std::pair<std::array<float, 3>, std::vector<std::uint32_t>>, std::uint32_t> known;
  for (MeshTriangle& t : result.triangles) {
    for (std::uint32_t& v : t) {
      const std::vector<float> attributes = attributes_of(mesh, v);
      std::vector<std::uint32_t> bits;  // which no order of floats compares: halves of doubles
      for (const float number : attributes)
        bits.push_back(std::bit_cast<std::uint32_t>(number));
      const auto [found, is_new] = known.try_emplace({key_of(mesh.positions[v]), bits}, 0);
      if (is_new)
        found->second = result.add(mesh.positions[v], attributes);
      v = found->second;
    }
  }
  return result;
}

BuildTile tile_of(const WedgeMesh& mesh, float limit) {
  const Places places = places_of(mesh, limit);
  BuildTile tile;
  tile.mesh.own_count = places.own_count;
  tile.mesh.boundary_count = places.own_count;
  tile.history.weights.assign(places.own_count, 1);
  add_vertices(mesh, places, tile.mesh);
  for (const MeshTriangle& t : mesh.triangles)
    add_triangle(t, places, tile.mesh);
  normalize_triangles(tile.mesh.interior, tile.mesh.interior_wedges, false);
  normalize_triangles(tile.mesh.border, tile.mesh.border_wedges, false);
  return tile;
}

std::span<const float> wedge_of(const TileMesh& mesh, std::uint32_t place, std::uint32_t wedge) {
  return wedge == 0 ? mesh.vertices.attributes_of(place)
                    : mesh.copies.vertices.attributes_of(mesh.copies.first_of(place) + wedge - 1);
}

}  // namespace meshhier::tests
