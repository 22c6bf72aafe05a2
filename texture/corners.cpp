#include "texture/corners.h"

#include "hierarchy/normal_code.h"
#include "hierarchy/vertex_numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace meshhier::texture {
namespace {

/// The look of a corner, as it has its bits.
struct Look {
  std::uint32_t normal = 0, u = 0, v = 0;
  friend constexpr auto operator<=>(const Look&, const Look&) = default;
};

/// A corner: 3 * triangle + its place in the triangle.
struct LookingCorner {
  std::uint32_t vertex = 0;
  Look look;
  std::uint32_t corner = 0;

  bool is_like(const LookingCorner& other) const {
    return vertex == other.vertex && look == other.look;
  }
  friend constexpr auto operator<=>(const LookingCorner&, const LookingCorner&) = default;
};

/// Both zeros are one.
std::uint32_t bits(float value) {
  return std::bit_cast<std::uint32_t>(value + 0.0f);
}

/// Gives the vertices of a tile their looks, and splits those that have several. Most corners look
/// like the first one of their vertex; only the others are sorted.
class Splitter {
 public:
  Splitter(const TileMesh& mesh, const Shading& normals, std::span<const CornerTexcoords> corners)
      : normals_(normals),
        texcoords_(corners),
        vertex_count_(static_cast<std::uint32_t>(mesh.vertices.size() + mesh.copies.size())),
        first_looks_(vertex_count_),
        has_look_(vertex_count_) {
    shading_.interior = normals.interior;
    shading_.border = normals.border;
    if (normals.split_of.empty()) {
      const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()),
                                  mesh.copies.places);
      shading_.interior = numbers.numbered(mesh.interior, mesh.interior_wedges);
      shading_.border = numbers.numbered(mesh.border, mesh.border_wedges);
    }
  }

  Shading operator()() && {
    if (!normals_.normals.empty())
      shading_.normals.assign(normals_.normals.begin(), normals_.normals.begin() + vertex_count_);
    shading_.texcoords.resize(vertex_count_);
    std::uint32_t t = 0;
    for (auto* triangles : {&shading_.interior, &shading_.border}) {
      for (TileTriangle& shown : *triangles) {
        for (std::uint32_t k = 0; k < 3; ++k)
          look_at(shown[k], texcoords_[t][k], 3 * t + k);
        ++t;
      }
    }
    split();
    if (shading_.split_of.empty()) {
      shading_.interior.clear();
      shading_.border.clear();
    }
    return std::move(shading_);
  }

 private:
  /// The first look is the vertex's own.
  void look_at(TileVertex& shown, const Vec2f& at, std::uint32_t corner) {
    const std::uint32_t number = raw(shown);
    const std::uint32_t vertex =
        number < vertex_count_ ? number : normals_.split_of[number - vertex_count_];
    const NormalCode normal = normals_.normals.empty() ? NormalCode{} : normals_.normals[number];
    const Look look{std::bit_cast<std::uint32_t>(normal), bits(at.u), bits(at.v)};
    if (has_look_[vertex] == 0) {
      has_look_[vertex] = 1;
      first_looks_[vertex] = look;
      shading_.texcoords[vertex] = at;
      if (!shading_.normals.empty())
        shading_.normals[vertex] = normal;
    } else if (look != first_looks_[vertex]) {
      others_.push_back({vertex, look, corner});
    }
    shown = TileVertex{vertex};
  }

  /// Makes a split of each other look, by vertices and the first corners that show them.
  void split() {
    std::sort(others_.begin(), others_.end());
    std::vector<std::array<std::size_t, 2>> groups;  // of equal looks: begin and end
    for (std::size_t i = 0, end = 0; i < others_.size(); i = end) {
      while (end < others_.size() && others_[end].is_like(others_[i]))
        ++end;
      groups.push_back({i, end});
    }
    std::sort(groups.begin(), groups.end(), [&](const auto& a, const auto& b) {
      const LookingCorner &left = others_[a[0]], &right = others_[b[0]];
      return std::pair(left.vertex, left.corner) < std::pair(right.vertex, right.corner);
    });
    for (const auto& [begin, end] : groups)
      add_split(std::span(others_).subspan(begin, end - begin));
  }

  void add_split(std::span<const LookingCorner> corners) {
    const auto& [vertex, look, first] = corners.front();
    const auto number =
        TileVertex{static_cast<std::uint32_t>(vertex_count_ + shading_.split_of.size())};
    shading_.split_of.push_back(vertex);
    shading_.texcoords.push_back(texcoords_[first / 3][first % 3]);
    if (!shading_.normals.empty())
      shading_.normals.push_back(std::bit_cast<NormalCode>(look.normal));
    const std::size_t interior = shading_.interior.size();
    for (const LookingCorner& c : corners) {
      const std::size_t t = c.corner / 3;
      (t < interior ? shading_.interior[t] : shading_.border[t - interior])[c.corner % 3] = number;
    }
  }

  const Shading& normals_;
  std::span<const CornerTexcoords> texcoords_;
  std::uint32_t vertex_count_;
  std::vector<Look> first_looks_;  ///< of vertices
  std::vector<char> has_look_;
  std::vector<LookingCorner> others_;
  Shading shading_;
};

}  // namespace

double area_of(const CornerTexcoords& corners) {
  const auto& [a, b, c] = corners;
  const double bu = double(b.u) - a.u, bv = double(b.v) - a.v;
  const double cu = double(c.u) - a.u, cv = double(c.v) - a.v;
  return std::abs(bu * cv - bv * cu) / 2;
}

Shading with_texcoords(const TileMesh& mesh, const Shading& normals,
                       std::span<const CornerTexcoords> corners) {
  return Splitter(mesh, normals, corners)();
}

std::vector<TangentCode> tangents_of(const TileMesh& mesh, const Shading& shown,
                                     std::span<const CornerTangents> corners) {
  std::vector<TangentCode> tangents(shown.texcoords.size(), kNoTangent);
  auto corner = corners.begin();
  const auto give = [&](std::span<const TileTriangle> triangles) {
    for (const TileTriangle& triangle : triangles) {
      for (std::size_t k = 0; k < 3; ++k)
        tangents[raw(triangle[k])] = (*corner)[k];
      ++corner;
    }
  };
  if (!shown.split_of.empty()) {
    give(shown.interior);
    give(shown.border);
    return tangents;
  }
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  give(numbers.numbered(mesh.interior, mesh.interior_wedges));
  give(numbers.numbered(mesh.border, mesh.border_wedges));
  return tangents;
}

}  // namespace meshhier::texture
