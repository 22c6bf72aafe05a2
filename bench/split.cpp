#include "bench/split.h"

#include "base/angle.h"
#include "base/error.h"
#include "bench/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

constexpr std::array kSplitCases{
    SplitCase{"charts", "texture coordinates, projected onto the six sides of a box"},
    SplitCase{"hard_edges", "normals, apart where the surface bends by more than --degrees"},
    SplitCase{"flat", "one normal a triangle"},
    SplitCase{"face_colours", "one of eight colours a triangle"},
    SplitCase{"soup", "three vertices a triangle, without attributes"},
    SplitCase{"mixed", "charts, hard edges and coloured patches at once"},
};

Vec3d area_normal(const LoadedMesh& mesh, const MeshTriangle& t) {
  const Vec3d a = mesh.positions[t[0]];
  return cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

Vec3d unit(Vec3d v) {
  const double size = length(v);
  return size > 0 ? v * (1 / size) : Vec3d{0, 0, 1};
}

/// Gives each corner its channels.
class Splitter {
 public:
  Splitter(const LoadedMesh& mesh, double degrees)
      : mesh_(mesh), least_cosine_(turn_by(degrees * std::numbers::pi / 180).cosine) {
    for (const MeshTriangle& t : mesh.triangles)
      normals_.push_back(area_normal(mesh, t));
    for (const Vec3d& p : mesh.positions) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
    }
  }

  void add_texcoord(std::size_t triangle, std::size_t corner, std::vector<float>& channels) const {
    const Vec3d n = normals_[triangle];
    const std::array<double, 3> sizes{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const auto axis =
        static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    const int side = 2 * axis + (n[axis] < 0 ? 1 : 0);
    const Vec3d p = mesh_.positions[mesh_.triangles[triangle][corner]];
    const double u = along(p, (axis + 1) % 3);
    const double v = along(p, (axis + 2) % 3);
    // Three by two sides, with a margin between them.
    channels.push_back(static_cast<float>((side % 3 + 0.05 + 0.9 * u) / 3));
    channels.push_back(static_cast<float>((side / 3 + 0.05 + 0.9 * v) / 2));
  }

  void add_flat_normal(std::size_t triangle, std::vector<float>& channels) const {
    add(unit(normals_[triangle]), channels);
  }

  /// Adds the normal of the triangles around the corner that bend away from its own by less than
  /// the angle.
  void add_smooth_normal(std::size_t triangle, std::size_t corner, std::vector<float>& channels) {
    if (around_.empty())
      collect();
    const Vec3d own = unit(normals_[triangle]);
    Vec3d sum;
    const std::uint32_t vertex = mesh_.triangles[triangle][corner];
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
      if (dot(unit(normals_[around_[i]]), own) >= least_cosine_)
        sum = sum + normals_[around_[i]];
    }
    add(unit(sum), channels);
  }

  static void add_colour(std::uint64_t which, std::vector<float>& channels) {
    for (int bit = 0; bit < 3; ++bit)
      channels.push_back((which >> bit & 1) != 0 ? 230.0F : 40.0F);
  }
  static void add_face_colour(std::size_t triangle, std::vector<float>& channels) {
    add_colour(random_at(1, triangle), channels);
  }
  /// Adds a colour by the cell of a coarse lattice that holds the triangle's first corner.
  void add_patch_colour(std::size_t triangle, std::vector<float>& channels) const {
    const Vec3d p = mesh_.positions[mesh_.triangles[triangle][0]];
    std::uint64_t cell = 0;
    for (int axis = 0; axis < 3; ++axis)
      cell = cell * 8 + static_cast<std::uint64_t>(along(p, axis) * 7.99);
    add_colour(random_at(2, cell), channels);
  }

 private:
  double along(Vec3d p, int axis) const {
    const double extent = high_[axis] - low_[axis];
    return extent > 0 ? (p[axis] - low_[axis]) / extent : 0;
  }
  static void add(Vec3d v, std::vector<float>& channels) {
    for (int axis = 0; axis < 3; ++axis)
      channels.push_back(static_cast<float>(v[axis]));
  }
  void collect() {
    first_.assign(mesh_.positions.size() + 1, 0);
    for (const MeshTriangle& t : mesh_.triangles) {
      for (const std::uint32_t v : t)
        ++first_[v + 1];
    }
    for (std::size_t v = 0; v + 1 < first_.size(); ++v)
      first_[v + 1] += first_[v];
    around_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      for (const std::uint32_t v : mesh_.triangles[i])
        around_[next[v]++] = i;
    }
  }

  const LoadedMesh& mesh_;
  double least_cosine_;
  std::vector<Vec3d> normals_;
  Vec3d low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
  std::vector<std::uint32_t> first_, around_;  ///< triangles around each vertex
};

}  // namespace

std::span<const SplitCase> split_cases() {
  return kSplitCases;
}

LoadedMesh split(const LoadedMesh& mesh, std::string_view name, double degrees) {
  if (std::none_of(kSplitCases.begin(), kSplitCases.end(),
                   [&](const SplitCase& listed) { return listed.name == name; }))
    throw Error(ErrorCode::usage, fmt::format("no way to split vertices is called {}", name));
  const bool is_mixed = name == "mixed";
  LoadedMesh result;
  result.double_coordinates = mesh.double_coordinates;
  result.attributes.normals = is_mixed || name == "flat" || name == "hard_edges";
  result.attributes.colour = is_mixed || name == "face_colours" ? ColourType::u8 : ColourType::none;
  result.attributes.texcoords = is_mixed || name == "charts";
  Splitter splitter(mesh, degrees);
  std::map<std::pair<std::uint32_t, std::vector<float>>, std::uint32_t> known;
  std::vector<float> channels;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    MeshTriangle& triangle = result.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      channels.clear();
      if (name == "flat")
        splitter.add_flat_normal(t, channels);
      else if (result.attributes.normals)
        splitter.add_smooth_normal(t, k, channels);
      if (is_mixed)
        splitter.add_patch_colour(t, channels);
      else if (name == "face_colours")
        Splitter::add_face_colour(t, channels);
      if (result.attributes.texcoords)
        splitter.add_texcoord(t, k, channels);
      const std::uint32_t vertex = mesh.triangles[t][k];
      const auto number = static_cast<std::uint32_t>(result.positions.size());
      triangle[k] =
          name == "soup" ? number : known.try_emplace({vertex, channels}, number).first->second;
      if (triangle[k] != number)
        continue;
      result.positions.push_back(mesh.positions[vertex]);
      result.channels.insert(result.channels.end(), channels.begin(), channels.end());
    }
  }
  return result;
}

}  // namespace meshhier::bench
