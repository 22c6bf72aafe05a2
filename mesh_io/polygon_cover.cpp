#include "mesh_io/polygon_cover.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace meshhier::mesh_io {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Counts of a face: how often the polygon winds around it, and how often its edges run along each
/// of the face's edges with the face to their left, less those that have it to their right.
struct FaceInfo {
  std::int32_t winding = 0;
  bool is_known = false;
  std::array<std::int32_t, 3> along{};
};

/// A vertex knows its place's number.
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<
    Kernel, CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
    CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;

class Cover {
 public:
  Cover(std::span<const Point2> corners, int sign) : corners_(corners), sign_(sign) {
    number_places();
    insert_places();
  }

  /// Throws Triangulation::Intersection_of_constraints_exception if the polygon crosses itself.
  std::optional<std::vector<Triangle<std::uint32_t>>> triangles() {
    if (mesh_.dimension() < 2)
      return std::nullopt;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Vertex from = vertices_[places_[i]], to = vertices_[places_[next(i)]];
      if (from != to)
        mesh_.insert_constraint(from, to);
    }
    for (std::size_t i = 0; i < corners_.size(); ++i)
      count_along(vertices_[places_[i]], vertices_[places_[next(i)]]);
    if (!is_whole_)
      return std::nullopt;
    wind();
    return collect();
  }

 private:
  std::size_t next(std::size_t i) const { return i + 1 == corners_.size() ? 0 : i + 1; }
  std::size_t previous(std::size_t i) const { return i == 0 ? corners_.size() - 1 : i - 1; }

  /// Numbers the places: corners at one place have one number; those of a place follow one another
  /// in sorted_.
  void number_places() {
    sorted_.resize(corners_.size());
    std::iota(sorted_.begin(), sorted_.end(), 0U);
    std::ranges::sort(sorted_, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(corners_[a], a) < std::pair(corners_[b], b);
    });
    places_.resize(corners_.size());
    for (std::uint32_t i = 0; i < sorted_.size(); ++i) {
      if (i == 0 || corners_[sorted_[i]] != corners_[sorted_[i - 1]])
        firsts_.push_back(i);
      places_[sorted_[i]] = static_cast<std::uint32_t>(firsts_.size() - 1);
    }
  }

  void insert_places() {
    std::vector<std::pair<Kernel::Point_2, std::uint32_t>> points;
    points.reserve(firsts_.size());
    for (std::uint32_t place = 0; place < firsts_.size(); ++place) {
      const Point2& p = corners_[sorted_[firsts_[place]]];
      points.emplace_back(Kernel::Point_2(p[0], p[1]), place);
    }
    mesh_.insert(points.begin(), points.end());
    vertices_.resize(points.size());
    for (auto vertex = mesh_.finite_vertices_begin(); vertex != mesh_.finite_vertices_end();
         ++vertex)
      vertices_[vertex->info()] = vertex;
  }

  /// Counts an edge of the polygon on both of its sides. It consists of several edges of the
  /// triangulation where vertices lie on it.
  void count_along(Vertex from, Vertex to) {
    while (from != to) {
      Vertex behind;
      Face face;
      int edge = 0;
      if (!mesh_.includes_edge(from, to, behind, face, edge)) {
        is_whole_ = false;
        return;
      }
      const bool is_left = face->vertex(Triangulation::ccw(edge)) == from;
      const Face other = face->neighbor(edge);
      face->info().along[static_cast<std::size_t>(edge)] += is_left ? 1 : -1;
      other->info().along[static_cast<std::size_t>(mesh_.mirror_index(face, edge))] +=
          is_left ? -1 : 1;
      from = behind;
    }
  }

  /// Walks from the outside, around which nothing winds, over the faces. Any way to a face gives
  /// the same number, as the polygon is closed.
  void wind() {
    std::vector<Face> todo{mesh_.infinite_face()};
    todo.back()->info().is_known = true;
    while (!todo.empty()) {
      const Face face = todo.back();
      todo.pop_back();
      for (int edge = 0; edge < 3; ++edge) {
        const Face other = face->neighbor(edge);
        if (std::exchange(other->info().is_known, true))
          continue;
        other->info().winding =
            face->info().winding - face->info().along[static_cast<std::size_t>(edge)];
        todo.push_back(other);
      }
    }
  }

  std::optional<std::vector<Triangle<std::uint32_t>>> collect() const {
    std::vector<Triangle<std::uint32_t>> all;
    for (auto face = mesh_.finite_faces_begin(); face != mesh_.finite_faces_end(); ++face) {
      if (face->info().winding == 0)
        continue;
      // The polygon covers this face more than once, or the other way round.
      if (face->info().winding != sign_)
        return std::nullopt;
      std::array<std::uint32_t, 3> at{};
      for (int i = 0; i < 3; ++i)
        at[static_cast<std::size_t>(i)] = face->vertex(i)->info();
      if (sign_ < 0)
        std::swap(at[1], at[2]);
      all.push_back({corner_of(at[0], at[1], at[2]), corner_of(at[1], at[2], at[0]),
                     corner_of(at[2], at[0], at[1])});
    }
    // The triangulation's own order follows from how it was made.
    std::ranges::sort(all, [](const auto& a, const auto& b) {
      return std::array{a[0], a[1], a[2]} < std::array{b[0], b[1], b[2]};
    });
    return all;
  }

  /// Returns the corner at a place in whose angle a triangle lies; the triangle goes on to `second`
  /// and `third`.
  std::uint32_t corner_of(std::uint32_t place, std::uint32_t second, std::uint32_t third) const {
    const std::uint32_t end = place + 1 == firsts_.size()
                                  ? static_cast<std::uint32_t>(sorted_.size())
                                  : firsts_[place + 1];
    for (std::uint32_t i = firsts_[place]; i + 1 < end; ++i) {
      if (is_in_angle(sorted_[i], point_of(second), point_of(third)))
        return sorted_[i];
    }
    return sorted_[end - 1];
  }

  const Point2& point_of(std::uint32_t place) const { return corners_[sorted_[firsts_[place]]]; }

  bool is_in_angle(std::uint32_t corner, const Point2& second, const Point2& third) const {
    const Point2& at = corners_[corner];
    const Point2& before = corners_[previous(corner)];
    const Point2& behind = corners_[next(corner)];
    const auto turn = [&](const Point2& a, const Point2& b) { return sign_ * turn_of(at, a, b); };
    const bool follows = turn(behind, second) >= 0;  // the edge that leaves
    const bool precedes = turn(third, before) >= 0;  // the edge that arrives
    // In a convex corner the triangle lies beside both edges, in a reflex one beside either.
    return turn(behind, before) >= 0 ? follows && precedes : follows || precedes;
  }

  std::span<const Point2> corners_;
  int sign_;
  std::vector<std::uint32_t> sorted_;  ///< corners by place
  std::vector<std::uint32_t> firsts_;  ///< per place: its first corner in sorted_
  std::vector<std::uint32_t> places_;  ///< per corner: the number of its place
  Triangulation mesh_;
  std::vector<Vertex> vertices_;  ///< per place
  bool is_whole_ = true;          ///< all edges are there
};

}  // namespace

std::optional<std::vector<Triangle<std::uint32_t>>> cover_polygon(std::span<const Point2> corners,
                                                                  int sign) {
  try {
    return Cover(corners, sign).triangles();
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    return std::nullopt;
  }
}

}  // namespace meshhier::mesh_io
