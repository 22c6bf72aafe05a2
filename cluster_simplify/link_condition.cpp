#include "cluster_simplify/link_condition.h"

#include <algorithm>

namespace meshhier::cluster_simplify {
namespace {

bool is_border(const CollapseMesh& mesh, std::uint32_t e) {
  return mesh.edge(e).triangle_count == 1;
}

bool touches_border(const CollapseMesh& mesh, Fans fans) {
  return std::any_of(fans.begin(), fans.end(), [&](const CollapseMesh::Fan& fan) {
    return is_border(mesh, fan.next_edge) || is_border(mesh, fan.previous_edge);
  });
}

/// A triangle at the edge that hangs on its corners only: it would be gone without a trace.
bool loses_wing(const CollapseMesh& mesh, Fans around_a, Fans around_b, std::uint32_t a,
                std::uint32_t b) {
  const auto is_free = [&](const CollapseMesh::Fan& fan, std::uint32_t other) {
    return fan.is_at(other) &&
           is_border(mesh, fan.next == other ? fan.previous_edge : fan.next_edge);
  };
  return std::any_of(around_a.begin(), around_a.end(), [&](const CollapseMesh::Fan& fan) {
    return is_free(fan, b) && std::any_of(around_b.begin(), around_b.end(), [&](const auto& same) {
             return same.triangle == fan.triangle && is_free(same, a);
           });
  });
}

bool edge_is_border(const CollapseMesh& mesh, Fans around_a, std::uint32_t b) {
  return std::any_of(around_a.begin(), around_a.end(), [&](const CollapseMesh::Fan& fan) {
    return (fan.next == b && is_border(mesh, fan.next_edge)) ||
           (fan.previous == b && is_border(mesh, fan.previous_edge));
  });
}

}  // namespace

void LinkCondition::mark_neighbours(std::uint32_t b, Fans around_a) {
  stamp_ += 2;
  const std::uint32_t opposite = stamp_ + 1;
  for (const CollapseMesh::Fan& fan : around_a) {
    for (const std::uint32_t other : {fan.next, fan.previous})
      marks_[other] = std::max(marks_[other], stamp_);
    if (fan.is_at(b))
      marks_[fan.next == b ? fan.previous : fan.next] = opposite;
  }
}

TopologyChange LinkCondition::change(const CollapseMesh& mesh, std::uint32_t a, std::uint32_t b,
                                     Fans around_a, Fans around_b) {
  if (all_at(around_a, b) && all_at(around_b, a))
    return TopologyChange::vanishes;
  if (touches_border(mesh, around_a) && touches_border(mesh, around_b) &&
      !edge_is_border(mesh, around_a, b))
    return TopologyChange::pinches;
  if (loses_wing(mesh, around_a, around_b, a, b))
    return TopologyChange::tears;
  mark_neighbours(b, around_a);
  const std::uint32_t opposite = stamp_ + 1;
  const auto joins_opposites = [&](const CollapseMesh::Fan& fan, std::uint32_t other) {
    return !fan.is_at(other) && marks_[fan.next] == opposite && marks_[fan.previous] == opposite;
  };
  bool folds = false;  // a triangle of b that would lie on one of a, or on its back
  for (const CollapseMesh::Fan& fan : around_b) {
    if (fan.is_at(a))
      continue;
    if (marks_[fan.next] == stamp_ || marks_[fan.previous] == stamp_)
      return TopologyChange::tears;  // a neighbour of both that is not opposite the edge
    folds = folds || joins_opposites(fan, a);
  }
  folds = folds && std::any_of(around_a.begin(), around_a.end(), [&](const CollapseMesh::Fan& fan) {
            return joins_opposites(fan, b);
          });
  return folds ? TopologyChange::tears : TopologyChange::none;
}

}  // namespace meshhier::cluster_simplify
