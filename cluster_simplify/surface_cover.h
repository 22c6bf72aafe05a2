// Maps a triangle onto a nearby surface, piece by piece, and so certifies that it is near.
//
// A *spot* is a point of the triangle and its image on the target, with the target triangles that
// hold the image. A polygon of spots whose images lie in one target triangle is mapped to it
// linearly, and no point of it moves farther than the farthest of the spots. A triangle is cut into
// such polygons: its edges are cut where they pass from one target triangle to the next; corners of
// that ring are cut off while three in a row have images in one target triangle; what remains
// around vertices of the target is joined to those. The pieces form a disk whose border is the
// triangle's, so they cover it wherever the cuts were made: finding cuts is a matter of luck, what
// is certified is certain.
#pragma once

#include "cluster_simplify/target_surface.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace meshhier::cluster_simplify {

/// A point and its image on the target.
struct Spot {
  Vec3d point;
  Vec3d image;
  std::array<std::uint32_t, 2> near{kNone, kNone};  ///< triangles that hold the image, [0] always;
                                                    ///< two if it is on an edge
  std::uint32_t vertex = kNone;  ///< the image is this vertex: all its triangles hold it

  bool found() const { return near[0] != kNone; }
  double squared_distance() const { return dot(point - image, point - image); }
};

/// The triangles around a vertex's key, not all if they are very many.
std::span<const std::uint32_t> candidates_around(const TargetSurface& target, std::uint32_t vertex);

/// The closest point of the triangles around a key (not all are looked at if they are very many).
/// Not found if there are none.
Spot nearest_around(const TargetSurface& target, std::uint32_t key, Vec3d point);

/// Goes from triangle to triangle around `start` while that brings it closer to the point.
Spot descend(const TargetSurface& target, std::uint32_t start, Vec3d point);

/// The point is a vertex of the target itself.
Spot spot_on_vertex(const TargetSurface& target, std::uint32_t vertex, std::uint32_t triangle);

/// The cuts of an edge, found once for both of its triangles.
struct Passage {
  enum State : std::uint8_t { unknown, found, failed };

  std::uint32_t begin = 0;  ///< in the memory of the SurfaceCover
  std::uint32_t count = 0;
  State state = unknown;
};

/// A piece of a mapped triangle: how much of a target triangle its image covers.
struct MappedPiece {
  std::uint32_t triangle = 0;
  double area = 0;  ///< product of the two triangles' normals, as long as twice their areas
};

class SurfaceCover {
 public:
  /// What follows is measured against `target`, which must outlive it; passages are forgotten.
  void start(const TargetSurface& target);

  /// Cuts the edge from a to b so that the images of neighbours lie in one target triangle.
  Passage find_passage(const Spot& a, const Spot& b, double squared_reach);

  /// One side of a triangle, in the triangle's order.
  struct Side {
    const Spot* from = nullptr;
    Passage passage;
    bool reversed = false;  ///< the passage runs against the triangle's order
  };

  /// True if the triangle was mapped and no point of it moves farther than the reach. `sides`: in
  /// the triangle's order; spots within reach.
  bool covers(const std::array<Side, 3>& sides, double squared_reach);

  /// The same for a triangle whose corners have their images in one target triangle: no passages
  /// are needed. False if they have not.
  bool covers_at_once(const Spot& a, const Spot& b, const Spot& c);

  /// The same for any triangle abc.
  bool covers(const Spot& a, const Spot& b, const Spot& c, double squared_reach);

  /// What the last triangle covered was mapped to.
  std::span<const MappedPiece> pieces() const { return pieces_; }

  /// The triangle holds the spot's image.
  bool holds(std::uint32_t triangle, const Spot& spot) const;

  /// Calls `visit` with the spots of an edge, cut by cut, from each to the next.
  template <class Visit>
  void for_each_step(const Spot& from, const Passage& passage, const Spot& to,
                     const Visit& visit) const {
    const Spot* before = &from;
    for (std::uint32_t i = 0; i < passage.count; ++i) {
      const Spot& next = passages_[passage.begin + i];
      visit(*before, next);
      before = &next;
    }
    visit(*before, to);
  }

 private:
  struct Exit {
    std::uint32_t triangle = kNone, next = kNone;
    unsigned edge = 0;
    Encounter meet;
  };

  bool link(std::vector<Spot>& out, const Spot& from, const Spot& to);
  bool step_across(std::vector<Spot>& out, const Spot& from, const Spot& to) const;
  bool walk(std::vector<Spot>& out, const Spot& from, const Spot& to) const;
  bool try_edge(const Segment& path, std::uint32_t triangle, unsigned edge, Exit& best) const;
  void leave_start(const Segment& path, std::uint32_t triangle, Exit& best) const;
  void leave_onwards(const Segment& path, std::uint32_t behind, std::uint32_t triangle,
                     Exit& best) const;
  void leave_fan(const Segment& path, std::uint32_t vertex, Exit& best) const;
  Spot spot_of(const Segment& path, const Exit& exit) const;
  bool cover_ring(std::size_t begin, const TriangleFrame& frame);
  bool cover_cone(std::size_t begin, const Spot& tip);
  void clip(std::size_t begin);
  Spot tip_of(std::size_t begin, const TriangleFrame& frame) const;
  bool add_piece(const Spot& a, const Spot& b, const Spot& c);
  std::uint32_t common(const Spot& a, const Spot& b, const Spot& c) const;
  bool common(const Spot& a, const Spot& b) const;
  std::uint32_t joining(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;

  const TargetSurface* target_ = nullptr;
  double reach_ = 0;  ///< squared
  int budget_ = 0;    ///< rings still allowed
  std::vector<Spot> ring_;
  std::vector<Spot> spokes_;  ///< passages from a ring to its tip
  std::vector<std::size_t> spoke_ends_;
  std::vector<Spot> passages_;
  std::vector<MappedPiece> pieces_;
};

}  // namespace meshhier::cluster_simplify
