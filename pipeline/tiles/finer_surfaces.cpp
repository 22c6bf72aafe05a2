#include "pipeline/tiles/finer_surfaces.h"

#include "base/bounds.h"
#include "texture/vertex_feet.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <utility>

namespace meshhier::pipeline {
namespace {

/// The cells of a grid that the border triangles of a tile reach: the neighbours' surfaces are near
/// the border only there.
class BorderCells {
 public:
  explicit BorderCells(const TileMesh& mesh) {
    for (const TileTriangle& t : mesh.border)
      bounds_.add(bounds_of_triangle(mesh.vertices.positions, t));
    const Vec3f size = bounds_.max - bounds_.min;
    cell_ = std::max({size.x, size.y, size.z}) / kCells;
    for (const TileTriangle& t : mesh.border)
      for_each_cell(grown(bounds_of_triangle(mesh.vertices.positions, t)),
                    [&](std::size_t cell) { reached_[cell] = true; });
  }

  bool reaches(std::span<const Vec3f> positions, const TileTriangle& triangle) const {
    const Bounds box = bounds_of_triangle(positions, triangle);
    if (!overlaps(box))
      return false;
    bool found = false;
    for_each_cell(box, [&](std::size_t cell) { found = found || reached_[cell]; });
    return found;
  }

 private:
  static constexpr int kCells = 32;
  static constexpr std::size_t kSide = kCells + 1;

  static Bounds bounds_of_triangle(std::span<const Vec3f> positions, const TileTriangle& t) {
    Bounds box;
    for (const TileVertex corner : t)
      box.add(positions[raw(corner)]);
    return box;
  }
  Bounds grown(Bounds box) const {
    const Vec3f step{cell_, cell_, cell_};
    return {box.min - step, box.max + step};
  }
  bool overlaps(const Bounds& box) const {
    const Bounds all = grown(bounds_);
    for (int axis = 0; axis < 3; ++axis) {
      if (box.max[axis] < all.min[axis] || box.min[axis] > all.max[axis])
        return false;
    }
    return true;
  }
  std::size_t index(float value, int axis) const {
    if (!(cell_ > 0))
      return 0;
    const float at = (value - bounds_.min[axis]) / cell_;
    return static_cast<std::size_t>(std::clamp(at, 0.0f, static_cast<float>(kCells)));
  }
  template <class Visit>
  void for_each_cell(const Bounds& box, const Visit& visit) const {
    for (std::size_t x = index(box.min.x, 0); x <= index(box.max.x, 0); ++x) {
      for (std::size_t y = index(box.min.y, 1); y <= index(box.max.y, 1); ++y) {
        for (std::size_t z = index(box.min.z, 2); z <= index(box.max.z, 2); ++z)
          visit((x * kSide + y) * kSide + z);
      }
    }
  }

  Bounds bounds_;
  float cell_ = 0;
  std::vector<bool> reached_ = std::vector<bool>(kSide * kSide * kSide);
};

/// The vertices of a tile by their numbers in it, or in a neighbour that it has ghosts of.
class ParentVertices {
 public:
  ParentVertices(NodeId node, NodeId parent, const TileMesh& mesh) : is_own_(node == parent) {
    if (is_own_)
      return;
    const auto first = std::ranges::lower_bound(mesh.ghosts, GhostRef{parent.index, 0});
    auto number = mesh.own_count + static_cast<std::uint32_t>(first - mesh.ghosts.begin());
    for (auto ghost = first; ghost != mesh.ghosts.end() && ghost->tile == parent.index; ++ghost) {
      ghosts_.resize(ghost->index + std::size_t{1}, texture::kNoVertex);
      ghosts_[ghost->index] = number++;
    }
  }

  /// Whether any vertex of a neighbour's finer tile has become one of the tile's.
  bool has_any(std::span<const std::uint16_t> parents) const {
    return std::ranges::any_of(parents, [&](std::uint16_t parent) {
      return parent < ghosts_.size() && ghosts_[parent] != texture::kNoVertex;
    });
  }

  /// Returns the tile's vertices that a finer surface's have become.
  std::vector<std::uint32_t> beside(const BakeSource& source) const {
    std::vector<std::uint32_t> vertices(source.positions.size(), texture::kNoVertex);
    for (std::size_t v = 0; v < source.parents.size(); ++v) {
      const std::uint16_t parent = source.parents[v];
      if (is_own_ || parent < ghosts_.size())
        vertices[v] = is_own_ ? parent : ghosts_[parent];
    }
    return vertices;
  }

 private:
  bool is_own_;
  std::vector<std::uint32_t> ghosts_;  ///< by their numbers in the neighbour
};

/// Returns a part with its own directions alone, so that the whole can go: there may be many
/// neighbours.
FinerSurface alone(FinerSurface part, const BakeSource& whole) {
  BakeSource source;
  source.positions = whole.positions;
  source.parents = whole.parents;
  source.triangles = std::move(part.triangles);
  source.corners = std::move(part.corners);
  source.normals = std::move(part.normals);
  if (!source.corners.empty())
    source.directions = whole.directions.around(source.corners);
  return {std::make_shared<const BakeSource>(std::move(source))};
}

FinerSurface near(const BorderCells& border, std::shared_ptr<const BakeSource> source) {
  FinerSurface part;
  for (std::size_t t = 0; t < source->triangles.size(); ++t) {
    if (!border.reaches(source->positions, source->triangles[t]))
      continue;
    part.triangles.push_back(source->triangles[t]);
    if (!source->corners.empty())
      part.corners.push_back(source->corners[t]);
    if (!source->normals.empty())
      part.normals.push_back(source->normals[t]);
  }
  if (part.triangles.empty())
    return {};
  if (source->image.texels.empty())
    return alone(std::move(part), *source);
  part.source = std::move(source);
  return part;
}

/// Calls visit(tile) for the tiles of a finer level that are below a node: partitions, where these
/// come before.
template <class Visit>
void for_each_tile(const Tree& tree, NodeId node, Level finer, const Visit& visit) {
  if (node.level >= finer || tree.is_partition(node))
    return visit(node);
  const Tree::Children children = tree.children(node);
  for (const NodeId child : children.span())
    for_each_tile(tree, tree.tile_node(child), finer, visit);
}

}  // namespace

BakeSource bare_source(const TileMesh& mesh, std::vector<std::uint16_t> parents) {
  BakeSource source;
  source.positions = mesh.vertices.positions;
  source.parents = std::move(parents);
  source.triangles = mesh.interior;
  source.triangles.insert(source.triangles.end(), mesh.border.begin(), mesh.border.end());
  return source;
}

texture::FinerShape FinerSurface::shape() const {
  return {source->positions, triangles.empty() ? source->triangles : triangles, beside};
}

texture::TexturedSurface FinerSurface::surface() const {
  const bool is_whole = triangles.empty();
  return {source->positions, is_whole ? source->triangles : triangles,
          is_whole ? source->corners : corners, &source->image, beside};
}

texture::NormalSurface FinerSurface::normal_surface() const {
  const bool is_whole = triangles.empty();
  return {source->positions,
          is_whole ? source->triangles : triangles,
          is_whole ? source->normals : normals,
          is_whole ? source->corners : corners,
          &source->directions,
          beside};
}

std::vector<FinerSurface> finer_surfaces(
    const Forest& forest, NodeId node, Level finer, const TileMesh& mesh,
    const std::function<std::shared_ptr<const BakeSource>(NodeId tile)>& source) {
  std::vector<FinerSurface> surfaces;
  const auto add = [&](NodeId parent, const auto& choose) {
    const ParentVertices vertices(node, parent, mesh);
    for_each_tile(forest.tree(), parent, finer, [&](NodeId tile) {
      if (parent != node && !vertices.has_any(forest.map_up(tile, node.level)))
        return;
      FinerSurface one = choose(source(tile));
      if (!one.source || one.source->triangles.empty())
        return;
      one.beside = vertices.beside(*one.source);
      surfaces.push_back(std::move(one));
    });
  };
  add(node, [](auto whole) { return FinerSurface{std::move(whole)}; });
  const BorderCells border(mesh);
  std::set<std::uint32_t> neighbours;
  for (const GhostRef& ghost : mesh.ghosts)
    neighbours.insert(ghost.tile);
  for (const std::uint32_t neighbour : neighbours)
    add({node.level, neighbour}, [&](auto whole) { return near(border, std::move(whole)); });
  return surfaces;
}

}  // namespace meshhier::pipeline
