// All triangles around an edge; in order around it where they are a plain disc.
#pragma once

#include "base/vec.h"
#include "cluster_simplify/collapse_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// An edge about to collapse: `from` and `to` become one vertex at `place`.
struct StarCollapse {
  std::uint32_t from = 0, to = 0;
  Vec3f place;
  Fans around_from, around_to;
};

/// The triangles around an edge. Keeps its memory from one edge to the next.
///
/// A disc: every vertex around the edge is met once, on one ring of at least three links. Link i is
/// the edge from ring vertex i to the next, opposite one end of the edge; those of `from` come
/// first. At ring vertices 0 and to_begin() are the two triangles of the edge itself.
class EdgeStar {
 public:
  static constexpr std::uint32_t kMostLinks = 32;
  /// One number per ring vertex, the first once more, and room for groups of four.
  using Row = std::array<float, kMostLinks + 6>;

  EdgeStar() = default;
  EdgeStar(const EdgeStar&) = delete;  // links lead into its own fans
  EdgeStar& operator=(const EdgeStar&) = delete;

  /// Collects the triangles around both ends of an edge. O(triangles).
  void gather(CollapseMesh& mesh, std::uint32_t from, std::uint32_t to);

  /// Takes some of the triangles of another star, which must stay where they are.
  void take(const EdgeStar& other, Fans around_from, Fans around_to);

  std::uint32_t from() const { return from_; }
  std::uint32_t to() const { return to_; }
  Fans around_from() const { return around_from_; }
  Fans around_to() const { return around_to_; }
  bool is_disc() const { return is_disc_; }

  // The rest is for discs only.
  std::uint32_t size() const { return size_; }
  std::uint32_t to_begin() const { return to_begin_; }
  /// One per link.
  std::span<const CollapseMesh::Fan* const> links() const { return {links_.data(), size_}; }
  /// As seen from `from`: the triangle at ring vertex 0, that at to_begin().
  const std::array<const CollapseMesh::Fan*, 2>& at_edge() const { return at_edge_; }
  std::uint32_t vertex(std::uint32_t i) const { return links_[i]->next; }

  /// Looks up where the ring's vertices lie as seen from `place`.
  void look_from(Vec3f place, std::span<const Vec3f> positions);
  /// The places that look_from() found; then the first once more, then zeros up to a whole group of
  /// four.
  const Row& x() const { return x_; }
  const Row& y() const { return y_; }
  const Row& z() const { return z_; }

 private:
  bool trace();
  bool append_links(Fans fans, std::uint32_t other, std::array<const CollapseMesh::Fan*, 2>& ends);
  bool meets_all_once();

  std::uint32_t from_ = 0, to_ = 0;
  std::vector<CollapseMesh::Fan> from_room_, to_room_;
  Fans around_from_, around_to_;
  std::vector<std::uint8_t> place_;  ///< per vertex: where it was last seen in a star or ring
  bool is_disc_ = false;
  std::uint32_t size_ = 0, to_begin_ = 0;
  std::array<const CollapseMesh::Fan*, kMostLinks> links_;
  std::array<const CollapseMesh::Fan*, 2> at_edge_;
  Row x_, y_, z_;
};

}  // namespace meshhier::cluster_simplify
