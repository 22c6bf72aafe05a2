#include "cluster_simplify/edge_star.h"

#include "cluster_simplify/four_floats.h"

#include <bit>
#include <cstddef>

namespace meshhier::cluster_simplify {
namespace {

/// Vertices, and where among them one is found: bit i for the i-th.
class Wanted {
 public:
  template <class VertexOf>
  Wanted(std::size_t count, const VertexOf& vertex_of) : count_(count) {
    for (std::size_t i = 0; i < count; ++i)
      vertices_[i] = vertex_of(i);
    store_four(&vertices_[count], FourInts{} + static_cast<std::int32_t>(CollapseMesh::kNone));
  }
  std::uint32_t places_of(std::uint32_t vertex) const {
    FourInts places{};
    FourInts bits{1, 2, 4, 8};
    for (std::size_t i = 0; i < count_; i += 4, bits <<= 4)
      places |= (load_four<FourInts>(&vertices_[i]) == static_cast<std::int32_t>(vertex)) & bits;
    return static_cast<std::uint32_t>(places[0] | places[1] | places[2] | places[3]);
  }

 private:
  /// After the last, none up to a whole group of four.
  alignas(16) std::array<std::uint32_t, EdgeStar::kMostLinks + 4> vertices_;
  std::size_t count_;
};

/// Neither none nor several.
bool is_one(std::uint32_t places) {
  return places != 0 && (places & (places - 1)) == 0;
}

}  // namespace

void EdgeStar::gather(CollapseMesh& mesh, std::uint32_t from, std::uint32_t to) {
  from_ = from;
  to_ = to;
  mesh.gather(from, around_from_);
  mesh.gather(to, around_to_);
  is_disc_ = around_from_.size() + around_to_.size() <= kMostLinks && trace();
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
  if (fans.size() < 3)
    return false;
  const Wanted next(fans.size(), [&](std::size_t i) { return fans[i].next; });
  std::uint32_t vertex = other;
  for (std::size_t k = 0; k < fans.size(); ++k) {
    const std::uint32_t places = next.places_of(vertex);
    if (!is_one(places))
      return false;
    const CollapseMesh::Fan* fan = &fans[static_cast<std::size_t>(std::countr_zero(places))];
    if (k == 0)
      ends[0] = fan;
    else
      links_[size_++] = fan;
    vertex = fan->previous;
  }
  ends[1] = links_[--size_];
  return vertex == other;
}

/// Whether no vertex is on the ring twice.
bool EdgeStar::meets_all_once() const {
  const Wanted ring(size_, [&](std::size_t i) { return links_[i]->next; });
  bool once = true;
  for (std::uint32_t i = 0; i < size_; ++i)
    once &= is_one(ring.places_of(vertex(i)));
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
