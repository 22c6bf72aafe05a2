#include "texture/corners.h"

#include "base/sort_few.h"
#include "hierarchy/normal_code.h"
#include "hierarchy/vertex_numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace meshhier::texture {
namespace {

/// A corner's look, and which one it is: 3 * triangle + its place in the triangle.
struct Look {
  std::uint32_t normal = 0, u = 0, v = 0;  ///< their bits
  std::uint32_t corner = 0;

  bool is_like(const Look& other) const {
    return normal == other.normal && u == other.u && v == other.v;
  }
  friend constexpr auto operator<=>(const Look&, const Look&) = default;
};

/// Both zeros are one.
std::uint32_t bits(float value) {
  return std::bit_cast<std::uint32_t>(value + 0.0f);
}

/// Gives the vertices of a tile their looks, and splits those that have several.
class Splitter {
 public:
  Splitter(const TileMesh& mesh, const Shading& normals, std::span<const CornerTexcoords> corners)
      : normals_(normals),
        texcoords_(corners),
        vertex_count_(static_cast<std::uint32_t>(mesh.vertices.size() + mesh.copies.size())) {
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
    const std::vector<std::uint32_t> first_alike = find_first_alike();
    give(first_alike);
    if (shading_.split_of.empty()) {
      shading_.interior.clear();
      shading_.border.clear();
    }
    return std::move(shading_);
  }

 private:
  std::uint32_t corner_count() const { return static_cast<std::uint32_t>(3 * texcoords_.size()); }

  TileVertex& shown(std::uint32_t corner) {
    const std::size_t interior = shading_.interior.size();
    const std::size_t t = corner / 3;
    return t < interior ? shading_.interior[t][corner % 3]
                        : shading_.border[t - interior][corner % 3];
  }
  /// The vertex at a corner, whichever split of it the normals show there.
  std::uint32_t vertex_at(std::uint32_t corner) {
    const std::uint32_t number = raw(shown(corner));
    return number < vertex_count_ ? number : normals_.split_of[number - vertex_count_];
  }
  const Vec2f& texcoord_at(std::uint32_t corner) const {
    return texcoords_[corner / 3][corner % 3];
  }
  NormalCode normal_at(std::uint32_t corner) {
    return normals_.normals.empty() ? NormalCode{} : normals_.normals[raw(shown(corner))];
  }
  Look look_at(std::uint32_t corner) {
    const Vec2f& at = texcoord_at(corner);
    return {std::bit_cast<std::uint32_t>(normal_at(corner)), bits(at.u), bits(at.v), corner};
  }

  /// The looks of all corners, those of a vertex side by side; `ends`: where each vertex's end.
  std::vector<Look> looks_by_vertex(std::vector<std::uint32_t>& ends) {
    ends.assign(vertex_count_ + 1, 0);
    for (std::uint32_t c = 0; c < corner_count(); ++c)
      ++ends[vertex_at(c) + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Look> looks(corner_count());
    for (std::uint32_t c = 0; c < corner_count(); ++c)
      looks[ends[vertex_at(c)]++] = look_at(c);
    ends.pop_back();
    return looks;
  }

  /// Finds, for each corner, the first one of the same vertex that looks alike.
  std::vector<std::uint32_t> find_first_alike() {
    std::vector<std::uint32_t> ends, first(corner_count());
    std::vector<Look> looks = looks_by_vertex(ends);
    std::uint32_t begin = 0;
    for (const std::uint32_t end : ends) {
      const std::span<Look> group = std::span(looks).subspan(begin, end - begin);
      sort_few(group, [](const Look& look) { return look; });
      for (std::size_t i = 0; i < group.size(); ++i) {
        const bool goes_on = i > 0 && group[i].is_like(group[i - 1]);
        first[group[i].corner] = goes_on ? first[group[i - 1].corner] : group[i].corner;
      }
      begin = end;
    }
    return first;
  }

  /// The first look is the vertex's own, the others are splits.
  void give(const std::vector<std::uint32_t>& first_alike) {
    std::vector<std::uint32_t> number(corner_count());
    std::vector<bool> has_look(vertex_count_);
    std::vector<std::uint32_t> splits;  // the first corners that show them
    for (std::uint32_t c = 0; c < corner_count(); ++c) {
      if (first_alike[c] != c)
        continue;
      const std::uint32_t vertex = vertex_at(c);
      if (has_look[vertex]) {
        splits.push_back(c);
        continue;
      }
      has_look[vertex] = true;
      number[c] = vertex;
      shading_.texcoords[vertex] = texcoord_at(c);
      if (!shading_.normals.empty())
        shading_.normals[vertex] = normal_at(c);
    }
    std::stable_sort(splits.begin(), splits.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return vertex_at(a) < vertex_at(b); });
    for (const std::uint32_t c : splits) {
      number[c] = static_cast<std::uint32_t>(vertex_count_ + shading_.split_of.size());
      shading_.split_of.push_back(vertex_at(c));
      shading_.texcoords.push_back(texcoord_at(c));
      if (!shading_.normals.empty())
        shading_.normals.push_back(normal_at(c));
    }
    for (std::uint32_t c = 0; c < corner_count(); ++c)
      shown(c) = TileVertex{number[first_alike[c]]};
  }

  const Shading& normals_;
  std::span<const CornerTexcoords> texcoords_;
  std::uint32_t vertex_count_;
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
