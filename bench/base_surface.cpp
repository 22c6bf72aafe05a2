#include "bench/base_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

namespace meshhier::bench {
namespace {

constexpr std::array<std::pair<std::string_view, BaseShape>, 4> kShapeNames{
    {{"sphere", BaseShape::sphere},
     {"torus", BaseShape::torus},
     {"genus5", BaseShape::genus5},
     {"shells", BaseShape::shells}}};

// Ground plans of one storey of unit cubes; the boundary of the cubes is the cage.
constexpr std::array<std::string_view, 1> kCube{"#"};
constexpr std::array<std::string_view, 3> kRing{"###",  //
                                                "#.#",  //
                                                "###"};
constexpr std::array<std::string_view, 7> kFiveHoles{"#######",  //
                                                     "#.###.#",  //
                                                     "#######",  //
                                                     "###.###",  //
                                                     "#######",  //
                                                     "#.###.#",  //
                                                     "#######"};

constexpr double kInnerShellRadius = 0.6;

/// Returns half the height of a storey, after fit_unit_cube; for the shells half the gap between
/// them.
double thickness_of(BaseShape shape) {
  switch (shape) {
    case BaseShape::torus:
      return 1.0 / 3;
    case BaseShape::genus5:
      return 1.0 / 7;
    case BaseShape::shells:
      return (1 - kInnerShellRadius) / 2;
    default:
      return 1;
  }
}

using Plan = std::span<const std::string_view>;

std::uint32_t next_corner(std::uint32_t corner) {
  return (corner + 1) % 4;
}
std::uint32_t previous_corner(std::uint32_t corner) {
  return (corner + 3) % 4;
}

/// Collects quads by their corners' integer coordinates.
class CageBuilder {
 public:
  using Corner = std::array<int, 3>;

  void add_face(const std::array<Corner, 4>& corners) {
    std::array<std::uint32_t, 4> face{};
    for (std::size_t c = 0; c < 4; ++c)
      face[c] = vertex(corners[c]);
    mesh_.faces.push_back(face);
  }
  QuadMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t vertex(const Corner& corner) {
    const auto next = static_cast<std::uint32_t>(mesh_.vertices.size());
    const auto [entry, is_new] = index_.try_emplace(corner, next);
    if (is_new) {
      mesh_.vertices.push_back({static_cast<double>(corner[0]), static_cast<double>(corner[1]),
                                static_cast<double>(corner[2])});
    }
    return entry->second;
  }

  QuadMesh mesh_;
  std::map<Corner, std::uint32_t> index_;
};

bool is_filled(Plan plan, int x, int y) {
  if (y < 0 || y >= static_cast<int>(plan.size()))
    return false;
  const std::string_view row = plan[static_cast<std::size_t>(y)];
  return x >= 0 && x < static_cast<int>(row.size()) && row[static_cast<std::size_t>(x)] == '#';
}

void add_cube_faces(CageBuilder& cage, Plan plan, int x, int y) {
  cage.add_face({{{x, y, 1}, {x + 1, y, 1}, {x + 1, y + 1, 1}, {x, y + 1, 1}}});
  cage.add_face({{{x, y, 0}, {x, y + 1, 0}, {x + 1, y + 1, 0}, {x + 1, y, 0}}});
  if (!is_filled(plan, x - 1, y))
    cage.add_face({{{x, y + 1, 0}, {x, y, 0}, {x, y, 1}, {x, y + 1, 1}}});
  if (!is_filled(plan, x + 1, y))
    cage.add_face({{{x + 1, y, 0}, {x + 1, y + 1, 0}, {x + 1, y + 1, 1}, {x + 1, y, 1}}});
  if (!is_filled(plan, x, y - 1))
    cage.add_face({{{x, y, 0}, {x + 1, y, 0}, {x + 1, y, 1}, {x, y, 1}}});
  if (!is_filled(plan, x, y + 1))
    cage.add_face({{{x + 1, y + 1, 0}, {x, y + 1, 0}, {x, y + 1, 1}, {x + 1, y + 1, 1}}});
}

/// Moves the box of the vertices to the origin and scales its longest side to 2.
void fit_unit_cube(std::vector<Vec3d>& vertices) {
  Vec3d low = vertices.front();
  Vec3d high = low;
  for (const Vec3d p : vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3d extent = high - low;
  const double scale = 2 / std::max({extent.x, extent.y, extent.z});
  const Vec3d centre = (low + high) * 0.5;
  for (Vec3d& p : vertices)
    p = (p - centre) * scale;
}

QuadMesh cage_of(Plan plan) {
  CageBuilder cage;
  for (int y = 0; y < static_cast<int>(plan.size()); ++y) {
    for (int x = 0; x < static_cast<int>(plan.front().size()); ++x) {
      if (is_filled(plan, x, y))
        add_cube_faces(cage, plan, x, y);
    }
  }
  QuadMesh mesh = cage.take();
  fit_unit_cube(mesh.vertices);
  return mesh;
}

/// Appends the mesh's own copy, turned inside out.
void append_inverted_copy(QuadMesh& mesh) {
  const auto vertex_count = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::size_t face_count = mesh.faces.size();
  for (std::uint32_t v = 0; v < vertex_count; ++v)
    mesh.vertices.push_back(Vec3d(mesh.vertices[v]));
  for (std::size_t f = 0; f < face_count; ++f) {
    const auto [a, b, c, d] = mesh.faces[f];
    mesh.faces.push_back({a + vertex_count, d + vertex_count, c + vertex_count, b + vertex_count});
  }
}

/// Numbers the undirected edges in order of appearance: an entry a side of a face.
std::vector<std::array<std::uint32_t, 4>> edge_ids(const QuadMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> ids;
  std::vector<std::array<std::uint32_t, 4>> result;
  for (const auto& face : mesh.faces) {
    auto& sides = result.emplace_back();
    for (std::uint32_t s = 0; s < 4; ++s) {
      const auto ends = std::minmax(face[s], face[next_corner(s)]);
      const auto next = static_cast<std::uint32_t>(ids.size());
      sides[s] = ids.try_emplace({ends.first, ends.second}, next).first->second;
    }
  }
  return result;
}

struct VertexStar {
  Vec3d face_sum;  ///< sum of the points of the faces around
  Vec3d edge_sum;  ///< sum of the midpoints of the edges around, each counted twice
  double valence = 0;
};

Vec3d smoothed(Vec3d p, const VertexStar& star) {
  const double n = star.valence;
  return (star.face_sum * (1 / n) + star.edge_sum * (1 / n) + p * (n - 3)) * (1 / n);
}

/// Cubic Bernstein polynomials and their derivatives.
struct Cubic {
  explicit Cubic(double t)
      : value{(1 - t) * (1 - t) * (1 - t), 3 * t * (1 - t) * (1 - t), 3 * t * t * (1 - t),
              t * t * t},
        slope{-3 * (1 - t) * (1 - t), 3 * (1 - t) * (1 - 3 * t), 3 * t * (2 - 3 * t), 3 * t * t} {}
  std::array<double, 4> value;
  std::array<double, 4> slope;
};

/// Indices in a control net of the corner c, its neighbours along the sides c and c - 1, and its
/// inner point.
struct NetCorner {
  std::size_t corner, along, before, inner;
};
constexpr std::array<NetCorner, 4> kNetCorners{
    {{0, 1, 4, 5}, {3, 7, 2, 6}, {15, 14, 11, 10}, {12, 8, 13, 9}}};

}  // namespace

std::optional<BaseShape> shape_named(std::string_view name) {
  for (const auto& [text, shape] : kShapeNames) {
    if (text == name)
      return shape;
  }
  return std::nullopt;
}

std::string_view name_of(BaseShape shape) {
  for (const auto& [text, named] : kShapeNames) {
    if (named == shape)
      return text;
  }
  return "unknown";
}

std::vector<std::array<PatchSide, 4>> opposite_sides(const QuadMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, PatchSide> side_from_to;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::uint32_t s = 0; s < 4; ++s)
      side_from_to[{mesh.faces[f][s], mesh.faces[f][next_corner(s)]}] = {f, s};
  }
  std::vector<std::array<PatchSide, 4>> result(mesh.faces.size());
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::uint32_t s = 0; s < 4; ++s)
      result[f][s] = side_from_to.at({mesh.faces[f][next_corner(s)], mesh.faces[f][s]});
  }
  return result;
}

QuadMesh subdivided(const QuadMesh& mesh) {
  const auto edges = edge_ids(mesh);
  const std::size_t edge_count = mesh.faces.size() * 2;  // closed: four sides, two faces an edge
  const std::size_t first_edge = mesh.vertices.size();
  const std::size_t first_face = first_edge + edge_count;
  QuadMesh result;
  result.vertices.resize(first_face + mesh.faces.size());
  std::vector<VertexStar> stars(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& face = mesh.faces[f];
    Vec3d centre;
    for (const std::uint32_t v : face)
      centre = centre + mesh.vertices[v] * 0.25;
    result.vertices[first_face + f] = centre;
    for (std::uint32_t c = 0; c < 4; ++c) {
      const Vec3d midpoint = (mesh.vertices[face[c]] + mesh.vertices[face[next_corner(c)]]) * 0.5;
      stars[face[c]].face_sum = stars[face[c]].face_sum + centre;
      stars[face[c]].valence += 1;
      stars[face[c]].edge_sum = stars[face[c]].edge_sum + midpoint;
      stars[face[next_corner(c)]].edge_sum = stars[face[next_corner(c)]].edge_sum + midpoint;
      // An edge point is the mean of its ends and the two face points; each face gives its half.
      Vec3d& edge_point = result.vertices[first_edge + edges[f][c]];
      edge_point = edge_point + midpoint * 0.25 + centre * 0.25;
    }
    for (std::uint32_t c = 0; c < 4; ++c) {
      result.faces.push_back(
          {face[c], static_cast<std::uint32_t>(first_edge + edges[f][c]),
           static_cast<std::uint32_t>(first_face + f),
           static_cast<std::uint32_t>(first_edge + edges[f][previous_corner(c)])});
    }
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    result.vertices[v] = smoothed(mesh.vertices[v], stars[v]);
  return result;
}

BaseSurface::BaseSurface(BaseShape shape) : thickness_(thickness_of(shape)) {
  const bool round = shape == BaseShape::sphere || shape == BaseShape::shells;
  cage_ = cage_of(round ? Plan(kCube) : shape == BaseShape::torus ? Plan(kRing) : Plan(kFiveHoles));
  radius_.assign(cage_.faces.size() * 4, round ? 1.0 : 0.0);
  if (shape == BaseShape::shells) {
    append_inverted_copy(cage_);
    radius_.resize(cage_.faces.size() * 4, -kInnerShellRadius);
  }
  // One step leaves every quad with at most one irregular corner, where the patches are at their
  // best.
  cage_ = subdivided(cage_);
  fit_unit_cube(cage_.vertices);
  fit_control_nets();
}

void BaseSurface::fit_control_nets() {
  const auto opposite = opposite_sides(cage_);
  std::vector<double> valence(cage_.vertices.size());
  for (const auto& face : cage_.faces) {
    for (const std::uint32_t v : face)
      valence[v] += 1;
  }
  std::vector<Vec3d> corner_sum(cage_.vertices.size());
  nets_.resize(cage_.faces.size());
  for (std::size_t f = 0; f < cage_.faces.size(); ++f) {
    const auto& face = cage_.faces[f];
    for (std::uint32_t c = 0; c < 4; ++c) {
      const double n = valence[face[c]];
      const Vec3d sides =
          cage_.vertices[face[next_corner(c)]] + cage_.vertices[face[previous_corner(c)]];
      const Vec3d across = cage_.vertices[face[(c + 2) % 4]];
      const Vec3d inner = (cage_.vertices[face[c]] * n + sides * 2 + across) * (1 / (n + 5));
      nets_[f][kNetCorners[c].inner] = inner;
      corner_sum[face[c]] = corner_sum[face[c]] + inner;
    }
  }
  double side_length = 0;
  for (std::size_t f = 0; f < cage_.faces.size(); ++f) {
    const auto& face = cage_.faces[f];
    for (std::uint32_t c = 0; c < 4; ++c) {
      const NetCorner& at = kNetCorners[c];
      nets_[f][at.corner] = corner_sum[face[c]] * (1 / valence[face[c]]);
      // The neighbour across side c starts that side at our next corner, so it ends it at ours.
      const PatchSide next = opposite[f][c];
      const PatchSide previous = opposite[f][previous_corner(c)];
      const std::size_t next_inner = kNetCorners[next_corner(next.side)].inner;
      const std::size_t previous_inner = kNetCorners[previous.side].inner;
      nets_[f][at.along] = (nets_[f][at.inner] + nets_[next.face][next_inner]) * 0.5;
      nets_[f][at.before] = (nets_[f][at.inner] + nets_[previous.face][previous_inner]) * 0.5;
      side_length += length(cage_.vertices[face[next_corner(c)]] - cage_.vertices[face[c]]);
    }
  }
  patch_size_ = side_length / static_cast<double>(4 * cage_.faces.size());
}

SurfacePoint BaseSurface::at(std::uint32_t face, double u, double v) const {
  assert(face < nets_.size());
  const ControlNet& net = nets_[face];
  const Cubic across(u);
  const Cubic up(v);
  Vec3d position;
  Vec3d along_u;
  Vec3d along_v;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const Vec3d control = net[row * 4 + column];
      position = position + control * (up.value[row] * across.value[column]);
      along_u = along_u + control * (up.value[row] * across.slope[column]);
      along_v = along_v + control * (up.slope[row] * across.value[column]);
    }
  }
  if (const double radius = radius_[face]; radius != 0) {
    const Vec3d outwards = position * (1 / length(position));
    return {outwards * std::fabs(radius), radius < 0 ? outwards * -1.0 : outwards};
  }
  const Vec3d normal = cross(along_u, along_v);
  return {position, normal * (1 / length(normal))};
}

}  // namespace meshhier::bench
