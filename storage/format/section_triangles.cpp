#include "storage/format/section_triangles.h"

#include <algorithm>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// The elements of one triangle.
struct ShadedTriangle {
  TileTriangle places;
  CornerWedges wedges;
  TileTriangle shaded;
  friend auto operator<=>(const ShadedTriangle&, const ShadedTriangle&) = default;
};

/// Returns a triangle turned so that the smallest corner comes first. Requires that no vertex is
/// there twice.
ShadedTriangle smallest_first(const TriangleLists& lists, std::size_t t) {
  Triangle<std::uint64_t> corners;
  for (std::size_t c = 0; c < 3; ++c) {
    const Wedge corner = lists.corner(t, c);
    corners[c] = std::uint64_t{corner.place} << 32 | corner.wedge;
  }
  const std::size_t first = smallest_corner(corners);
  return {turned(lists.places[t], first), turned(lists.wedges_at(t), first),
          turned(lists.shaded[t], first)};
}

/// Does what normalize_triangles() does, and turns and moves all lists alike.
void normalize(const TriangleLists& lists) {
  if (lists.shaded.empty())
    return normalize_triangles(lists.places, lists.wedges, false);
  std::vector<ShadedTriangle> sorted;
  for (std::size_t t = 0; t < lists.places.size(); ++t)
    sorted.push_back(smallest_first(lists, t));
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t t = 0; t < sorted.size(); ++t) {
    lists.places[t] = sorted[t].places;
    lists.shaded[t] = sorted[t].shaded;
    if (!lists.wedges.empty())
      lists.wedges[t] = sorted[t].wedges;
  }
}

/// Reads the triangles of one part.
class TriangleReader : SectionReader {
 public:
  TriangleReader(const SectionReader& sections, TilePart part, const VertexNumbers& numbers,
                 std::span<const std::uint32_t> split_of)
      : SectionReader(sections), part_(part), numbers_(numbers), split_of_(split_of) {}

  void read(const TriangleLists& lists) const {
    lists.shaded = numbered_triangles();
    lists.places = without_splits(lists.shaded);
    if (split_of_.empty())
      lists.shaded.clear();
    if (plan_.shape().copies > 0)
      lists.wedges = numbers_.split(lists.places);
    if (is_packed_)
      normalize(lists);
    for (std::size_t t = 0; t < lists.places.size(); ++t) {
      check_order(t, lists);
      check_corners(t, lists.places[t]);
    }
  }

 private:
  /// Returns triangles whose corners are numbers of vertices and splits.
  std::vector<TileTriangle> numbered_triangles() const {
    const Section& section = plan_[part_];
    std::vector<TileTriangle> triangles(section.count / 3);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t index = number(section, 3 * t + c);
        if (index >= plan_.shape().with_splits()) {
          fail(fmt::format("index {} of {} triangle {} is not below the {} vertices", index,
                           key_of(part_), t, plan_.shape().with_splits()));
        }
        triangles[t][c] = static_cast<TileVertex>(index);
      }
    }
    return triangles;
  }

  /// Returns the triangles with the vertices of splits; checks that each has three different ones.
  std::vector<TileTriangle> without_splits(std::vector<TileTriangle> triangles) const {
    const std::uint64_t vertex_count = plan_.shape().vertices();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (TileVertex& corner : triangles[t]) {
        if (raw(corner) >= vertex_count)
          corner = static_cast<TileVertex>(split_of_[raw(corner) - vertex_count]);
      }
      if (is_degenerate(triangles[t]))
        fail_triangle(t, triangles[t], "has a vertex twice");
    }
    return triangles;
  }

  void check_order(std::size_t t, const TriangleLists& lists) const {
    if (lists.corner(t, 1) < lists.corner(t, 0) || lists.corner(t, 2) < lists.corner(t, 0) ||
        (t > 0 && lists.key(t) < lists.key(t - 1)))
      fail_triangle(t, lists.places[t], "is turned or out of order");
    if (t > 0 && !lists.shaded.empty() && lists.key(t) == lists.key(t - 1) &&
        lists.shaded[t] != lists.shaded[t - 1])
      fail_triangle(t, lists.places[t], "has other splits than the equal one before it");
  }

  void check_corners(std::size_t t, const TileTriangle& triangle) const {
    if (is_degenerate(triangle) && !tree_.is_partition(plan_.shape().node))
      fail_triangle(t, triangle, "has a place twice, above the partitions");
    std::uint64_t own = 0, boundary = 0;
    for (const TileVertex corner : triangle) {
      own += raw(corner) < plan_.shape().own ? 1 : 0;
      boundary += raw(corner) < plan_.shape().boundary ? 1 : 0;
    }
    const bool fits =
        part_ == TilePart::interior ? own == 3 : own == boundary && (own == 1 || own == 2);
    if (!fits) {
      fail(fmt::format("{} triangle {} has {} own corners, {} of them on the boundary",
                       key_of(part_), t, own, boundary));
    }
  }

  [[noreturn]] void fail_triangle(std::size_t t, const TileTriangle& triangle,
                                  const char* what) const {
    fail(fmt::format("{} triangle {} ({}, {}, {}) {}", key_of(part_), t, raw(triangle[0]),
                     raw(triangle[1]), raw(triangle[2]), what));
  }

  TilePart part_;
  const VertexNumbers& numbers_;
  std::span<const std::uint32_t> split_of_;
};

}  // namespace

void read_triangles(const SectionReader& sections, TilePart part, const VertexNumbers& numbers,
                    std::span<const std::uint32_t> split_of, const TriangleLists& lists) {
  TriangleReader(sections, part, numbers, split_of).read(lists);
}

}  // namespace meshhier::storage
