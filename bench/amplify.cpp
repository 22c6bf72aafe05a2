// amplify(): repeated 1:4 subdivision with displacement, streamed.
//
// With m = 2^times, every input triangle becomes a triangular lattice of points (column, row),
// column + row <= m; its corners A, B, C are (0, 0), (m, 0), (0, m). Each step halves the lattice's
// spacing: a new point lies between two old ones. A point's displacement depends on its two parents
// and its own output number only, so a point on an edge comes out the same, bit for bit, in every
// triangle at that edge and in the walk along the edge alone.
#include "base/error.h"
#include "bench/block_writer.h"
#include "bench/generator.h"
#include "bench/noise.h"
#include "hierarchy/attribute_rules.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

constexpr int kMostTimes = 10;  ///< lattices of 525,825 points, 50 MB, and a factor of a million

struct EdgeEnds {
  std::uint32_t low;  ///< the vertex of the smaller number
  std::uint32_t high;
};

struct EdgeTable {
  std::vector<EdgeEnds> edges;                            ///< in order of appearance
  std::vector<std::array<std::uint32_t, 3>> of_triangle;  ///< edge from corner c to corner c + 1
};

struct HalfEdge {
  std::uint64_t ends;    ///< low vertex in the upper half, high vertex in the lower
  std::uint64_t corner;  ///< 3 * triangle + corner it starts at
  friend constexpr auto operator<=>(const HalfEdge&, const HalfEdge&) = default;
};

std::vector<HalfEdge> sorted_half_edges(const std::vector<MeshTriangle>& triangles) {
  std::vector<HalfEdge> result;
  result.reserve(triangles.size() * 3);
  for (const MeshTriangle& t : triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [low, high] = std::minmax(t[c], t[(c + 1) % 3]);
      result.push_back({(std::uint64_t{low} << 32) | high, result.size()});
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

EdgeTable edge_table(const std::vector<MeshTriangle>& triangles) {
  std::vector<HalfEdge> half_edges = sorted_half_edges(triangles);
  // The first half-edge of each edge, by corner, gives the order of appearance.
  std::vector<std::uint64_t> first_corner;
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    if (i == 0 || half_edges[i].ends != half_edges[i - 1].ends)
      first_corner.push_back(half_edges[i].corner);
  }
  std::sort(first_corner.begin(), first_corner.end());
  EdgeTable table;
  table.edges.resize(first_corner.size());
  table.of_triangle.resize(triangles.size());
  std::uint32_t edge = 0;
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    const auto [ends, corner] = half_edges[i];
    if (i == 0 || ends != half_edges[i - 1].ends) {
      edge = static_cast<std::uint32_t>(
          std::lower_bound(first_corner.begin(), first_corner.end(), corner) -
          first_corner.begin());
      table.edges[edge] = {static_cast<std::uint32_t>(ends >> 32),
                           static_cast<std::uint32_t>(ends)};
    }
    table.of_triangle[corner / 3][corner % 3] = edge;
  }
  return table;
}

/// Returns unit vectors, area-weighted; zero where no triangle is.
std::vector<Vec3d> vertex_normals(const LoadedMesh& mesh) {
  std::vector<Vec3d> normals(mesh.positions.size());
  for (const MeshTriangle& t : mesh.triangles) {
    const Vec3d a = mesh.positions[t[0]];
    const Vec3d area = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    for (const std::uint32_t v : t)
      normals[v] = normals[v] + area;
  }
  for (Vec3d& n : normals) {
    const double size = length(n);
    n = size > 0 ? n * (1 / size) : Vec3d{};
  }
  return normals;
}

struct Point {
  Vec3d position;
  Vec3d normal;
  std::array<float, kMaxChannels> attributes{};
};

/// Output numbers of one triangle's lattice points.
class LatticeNumbers {
 public:
  struct Starts {
    std::uint64_t edges;     ///< number of the first vertex on an edge
    std::uint64_t interior;  ///< number of the first vertex inside a triangle
  };

  LatticeNumbers(std::uint32_t cells, const Starts& starts) : cells_(cells), starts_(starts) {}

  std::uint64_t on_edge(std::uint32_t edge, std::uint32_t along) const {
    return starts_.edges + std::uint64_t{edge} * (cells_ - 1) + along - 1;
  }
  std::uint64_t per_triangle() const {
    return cells_ < 3 ? 0 : std::uint64_t{cells_ - 1} * (cells_ - 2) / 2;
  }
  /// Rows 1 .. m-2, each of m - 1 - row points, one after the other.
  std::uint64_t inside(std::uint64_t triangle, std::uint32_t column, std::uint32_t row) const {
    const std::uint64_t above = row - 1;
    return starts_.interior + triangle * per_triangle() + above * (cells_ - 1) -
           above * (above + 1) / 2 + column - 1;
  }

 private:
  std::uint32_t cells_;
  Starts starts_;
};

class Amplified final : public GeneratedMesh {
 public:
  Amplified(LoadedMesh mesh, const AmplifyOptions& options)
      : mesh_(std::move(mesh)),
        options_(options),
        cells_(1u << options.times),
        rules_(mesh_.attributes),
        table_(edge_table(mesh_.triangles)),
        normals_(vertex_normals(mesh_)),
        numbers_(cells_, {mesh_.positions.size(),
                          mesh_.positions.size() + table_.edges.size() * (cells_ - 1)}) {
    content_.vertex_count = mesh_.positions.size() + table_.edges.size() * (cells_ - 1) +
                            mesh_.triangles.size() * numbers_.per_triangle();
    content_.triangle_count = std::uint64_t{mesh_.triangles.size()} * cells_ * cells_;
    if (content_.vertex_count > 0xffffffffu) {
      throw Error(ErrorCode::usage, fmt::format("times {} makes {} vertices, more than 2^32 - 1; "
                                                "ask for fewer steps",
                                                options.times, content_.vertex_count));
    }
    content_.attributes = mesh_.attributes;
    content_.double_coordinates = mesh_.double_coordinates;
    content_.comments = {fmt::format("meshgen amplify: {} times, seed {}, displacement {}",
                                     options.times, options.seed, options.displacement)};
  }

  const mesh_io::PlyContent& content() const override { return content_; }

  void visit_vertices(std::size_t block_size, const VertexBlockVisitor& visit) const override {
    VertexCollector blocks(block_size, visit);
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v)
      add(original(v), blocks);
    std::vector<Point> points(cells_ + 1);
    for (std::uint32_t edge = 0; edge < table_.edges.size(); ++edge) {
      fill_edge(edge, points);
      for (std::uint32_t t = 1; t < cells_; ++t)
        add(points[t], blocks);
    }
    if (numbers_.per_triangle() > 0) {
      points.resize(std::size_t{cells_ + 1} * (cells_ + 1));
      for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
        fill_lattice(t, points);
        for (std::uint32_t row = 1; row + 1 < cells_; ++row) {
          for (std::uint32_t column = 1; column + row < cells_; ++column)
            add(points[slot(column, row)], blocks);
        }
      }
    }
    blocks.flush();
  }

  void visit_triangles(std::size_t block_size, const TriangleBlockVisitor& visit) const override {
    TriangleCollector blocks(block_size, visit);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto at = [&](std::uint32_t column, std::uint32_t row) {
        return static_cast<std::uint32_t>(number(t, column, row));
      };
      for (std::uint32_t row = 0; row < cells_; ++row) {
        for (std::uint32_t column = 0; column + row < cells_; ++column) {
          blocks.add({at(column, row), at(column + 1, row), at(column, row + 1)});
          if (column + row + 2 <= cells_)
            blocks.add({at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)});
        }
      }
    }
    blocks.flush();
  }

 private:
  std::size_t slot(std::uint32_t column, std::uint32_t row) const {
    return std::size_t{row} * (cells_ + 1) + column;
  }

  /// Edges are walked from their lower vertex, so that all triangles agree.
  std::uint64_t along(std::size_t triangle, std::size_t corner, std::uint32_t t) const {
    const std::uint32_t edge = table_.of_triangle[triangle][corner];
    const bool forward = mesh_.triangles[triangle][corner] == table_.edges[edge].low;
    return numbers_.on_edge(edge, forward ? t : cells_ - t);
  }

  std::uint64_t number(std::size_t triangle, std::uint32_t column, std::uint32_t row) const {
    const MeshTriangle& corners = mesh_.triangles[triangle];
    if (row == 0)
      return column == 0 ? corners[0] : column == cells_ ? corners[1] : along(triangle, 0, column);
    if (column == 0)
      return row == cells_ ? corners[2] : along(triangle, 2, cells_ - row);
    if (column + row == cells_)
      return along(triangle, 1, row);
    return numbers_.inside(triangle, column, row);
  }

  Point original(std::uint32_t vertex) const {
    Point point{mesh_.positions[vertex], normals_[vertex], {}};
    const auto channels = static_cast<std::size_t>(mesh_.attributes.channels());
    std::copy_n(mesh_.channels.begin() + static_cast<std::ptrdiff_t>(vertex * channels), channels,
                point.attributes.begin());
    return point;
  }

  /// The point between two others: exactly the same whichever comes first.
  Point between(const Point& a, const Point& b, std::uint64_t own_number) const {
    Point point;
    const Vec3d normal = a.normal + b.normal;
    const double size = length(normal);
    point.normal = size > 0 ? normal * (1 / size) : Vec3d{};
    const double shift = options_.displacement * length(b.position - a.position) *
                         signed_unit(random_at(options_.seed, own_number));
    point.position = (a.position + b.position) * 0.5 + point.normal * shift;
    average_attributes(a, b, point);
    return point;
  }

  void average_attributes(const Point& a, const Point& b, Point& point) const {
    for (std::size_t c = 0; c < rules_.channels(); ++c)
      point.attributes[c] = (a.attributes[c] + b.attributes[c]) * 0.5f;
    const std::span<float> all = std::span(point.attributes).first(rules_.channels());
    rules_.normalize(all);
    if (rules_.are_colours_whole()) {
      for (float& number : rules_.part(AttributeKind::colours).of(all))
        number = std::floor(number + 0.5f);
    }
  }

  void fill_edge(std::uint32_t edge, std::vector<Point>& points) const {
    points[0] = original(table_.edges[edge].low);
    points[cells_] = original(table_.edges[edge].high);
    for (std::uint32_t half = cells_ / 2; half > 0; half /= 2) {
      for (std::uint32_t t = half; t < cells_; t += 2 * half)
        points[t] = between(points[t - half], points[t + half], numbers_.on_edge(edge, t));
    }
  }

  void fill_lattice(std::size_t triangle, std::vector<Point>& points) const {
    const MeshTriangle& corners = mesh_.triangles[triangle];
    points[slot(0, 0)] = original(corners[0]);
    points[slot(cells_, 0)] = original(corners[1]);
    points[slot(0, cells_)] = original(corners[2]);
    for (std::uint32_t half = cells_ / 2; half > 0; half /= 2) {
      for (std::uint32_t row = 0; row <= cells_; row += half) {
        for (std::uint32_t column = 0; column + row <= cells_; column += half)
          refine(triangle, {column, row}, half, points);
      }
    }
  }

  /// Sets the point if it is new at this spacing; its parents lie `half` away on either side.
  void refine(std::size_t triangle, std::pair<std::uint32_t, std::uint32_t> at, std::uint32_t half,
              std::vector<Point>& points) const {
    const auto [column, row] = at;
    const bool odd_column = column / half % 2 == 1;
    const bool odd_row = row / half % 2 == 1;
    if (!odd_column && !odd_row)
      return;
    const std::size_t first = odd_column && odd_row ? slot(column + half, row - half)
                              : odd_column          ? slot(column - half, row)
                                                    : slot(column, row - half);
    const std::size_t second = odd_column && odd_row ? slot(column - half, row + half)
                               : odd_column          ? slot(column + half, row)
                                                     : slot(column, row + half);
    points[slot(column, row)] =
        between(points[first], points[second], number(triangle, column, row));
  }

  void add(const Point& point, VertexCollector& blocks) const {
    const auto channels = static_cast<std::size_t>(mesh_.attributes.channels());
    blocks.add(mesh_.double_coordinates ? point.position : rounded_to_float(point.position),
               std::span<const float>(point.attributes).first(channels));
  }

  LoadedMesh mesh_;
  AmplifyOptions options_;
  std::uint32_t cells_;  ///< m
  AttributeRules rules_;
  EdgeTable table_;
  std::vector<Vec3d> normals_;
  LatticeNumbers numbers_;
  mesh_io::PlyContent content_;
};

}  // namespace

std::unique_ptr<GeneratedMesh> amplify(LoadedMesh mesh, const AmplifyOptions& options) {
  if (options.times < 0 || options.times > kMostTimes) {
    throw Error(ErrorCode::usage,
                fmt::format("times must be from 0 to {}, found {}", kMostTimes, options.times));
  }
  if (!(options.displacement >= 0 && options.displacement <= 1)) {
    throw Error(ErrorCode::usage,
                fmt::format("displacement must be from 0 to 1, found {}", options.displacement));
  }
  return std::make_unique<Amplified>(std::move(mesh), options);
}

}  // namespace meshhier::bench
