#include "cluster_simplify/edge_star.h"

#include <cstddef>

namespace meshhier::cluster_simplify {
void EdgeStar::gather(CollapseMesh& mesh, std::uint32_t from, std::uint32_t to) {
  from_ = from;
  to_ = to;
  if (place_.size() < mesh.vertex_count())
    place_.resize(mesh.vertex_count());
  around_from_ = mesh.star_of(from, from_room_);
  around_to_ = mesh.star_of(to, to_room_);
  is_disc_ = around_from_.size() + around_to_.size() <= kMostLinks && trace();
}

void EdgeStar::take(const EdgeStar& other, Fans around_from, Fans around_to) {
  from_ = other.from_;
  to_ = other.to_;
  place_.resize(other.place_.size());
  around_from_ = around_from;
  around_to_ = around_to;
  is_disc_ = around_from.size() + around_to.size() <= kMostLinks && trace();
}

bool EdgeStar::trace() {
  size_ = 0;
  if (!append_links(around_from_, to_, at_edge_))
    return false;
  to_begin_ = size_;
  std::array<const CollapseMesh::Fan*, 2> across;
  return append_links(around_to_, from_, across) && size_ > 2 &&
         across[0]->triangle == at_edge_[1]->triangle &&
         across[1]->triangle == at_edge_[0]->triangle && meets_all_once();
}

/// Appends the links of a closed fan from one triangle at the edge to the other; `ends`: these two,
/// the one whose next corner is `other` first. False unless there are two, and links between them.
bool EdgeStar::append_links(Fans fans, std::uint32_t other,
                            std::array<const CollapseMesh::Fan*, 2>& ends) {
  const auto count = static_cast<std::uint32_t>(fans.size());
  if (count < 3)
    return false;
  for (std::uint32_t i = 0; i < count; ++i)
    place_[fans[i].next] = static_cast<std::uint8_t>(i);
  std::uint32_t vertex = other;
  std::uint32_t met = 0;  // bit i for the i-th
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t i = place_[vertex];
    if (i >= count || fans[i].next != vertex)
      return false;  // left by another star
    met |= 1U << i;
    links_[size_ + k] = &fans[i];
    vertex = fans[i].previous;
  }
  // If two triangles have one next corner, only the last is met.
  if (vertex != other || met != (std::uint32_t{1} << count) - 1)
    return false;
  ends = {links_[size_], links_[size_ + count - 1]};
  for (std::uint32_t k = 1; k + 1 < count; ++k)
    links_[size_ + k - 1] = links_[size_ + k];
  size_ += count - 2;
  return true;
}

/// Whether no vertex is on the ring twice.
bool EdgeStar::meets_all_once() {
  for (std::uint32_t i = 0; i < size_; ++i)
    place_[vertex(i)] = static_cast<std::uint8_t>(i);
  bool once = true;
  for (std::uint32_t i = 0; i < size_; ++i)
    once &= place_[vertex(i)] == i;
  return once;
}

void EdgeStar::look_from(Vec3f place, std::span<const Vec3f> positions) {
  for (std::uint32_t i = 0; i < size_; ++i) {
    const Vec3f p = positions[vertex(i)] - place;
    x_[i] = p.x;
    y_[i] = p.y;
    z_[i] = p.z;
  }
  x_[size_] = x_[0];
  y_[size_] = y_[0];
  z_[size_] = z_[0];
  for (std::uint32_t i = size_ + 1; i <= size_ + 4; ++i)
    x_[i] = y_[i] = z_[i] = 0;
}

}  // namespace meshhier::cluster_simplify
