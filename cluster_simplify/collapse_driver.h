// Collapses edges in order of cost until few enough vertices are left.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/collapse_queue.h"
#include "cluster_simplify/contraction.h"
#include "cluster_simplify/link_condition.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace meshhier::cluster_simplify {

/// A collapse to be: `from` goes into `to`.
struct Collapse {
  std::uint32_t from = 0, to = 0;
  float cost = 0;  ///< >= 0
  Vec3f place;     ///< where `to` comes to lie, tile-local
};

/// What is given up, step by step, when a tile cannot reach its count otherwise.
enum class Care {
  all,       ///< no triangle turns over; topology changes at its price, no borders meet
  topology,  ///< triangles may turn over
  none,      ///< anything goes
};

/// `costs` says what edges cost and takes note of collapses:
///   Collapse best(edge)                      the best way to collapse it, at today's cost
///   float price(edge, TopologyChange)        what it costs at least if it changes topology
///   bool keeps_shape(Collapse, Fans around_from, Fans around_to)
///   void collapsed(Collapse)
/// An edge's cost is looked at again when its turn comes, not when a neighbour changes: collapses
/// make costs grow, hardly ever shrink.
template <class Costs>
class CollapseDriver {
 public:
  CollapseDriver(CollapseMesh& mesh, Costs& costs)
      : mesh_(mesh),
        costs_(costs),
        queue_(static_cast<std::uint32_t>(mesh.edges().size())),
        link_(mesh.vertex_count()),
        changes_(mesh.edges().size(), TopologyChange::none),
        counted_(mesh.own_count(), 1),
        left_(mesh.own_count()) {
    for (std::uint32_t v = 0; v < mesh.own_count(); ++v)
      discount_if_isolated(v);
  }

  FallbackCounts run(std::uint32_t target) {
    FallbackCounts counts;
    reach(target, Care::all);
    counts.torn = torn_;
    collapses_ = 0;
    reach(target, Care::topology);
    counts.turned = collapses_;
    collapses_ = 0;
    reach(target, Care::none);
    counts.forced = collapses_;
    return counts;
  }

 private:
  void reach(std::uint32_t target, Care care) {
    // What was impossible may have become possible by later collapses next to it: as long as a
    // round gets a fair part of the way, there is another.
    constexpr std::uint64_t kFairPart = 16;
    while (left_ > target) {
      const std::uint32_t before = left_;
      push_all(care);
      drain(target, care);
      if ((before - left_) * kFairPart < left_ - target)
        return;
    }
  }

  void push_all(Care care) {
    for (std::uint32_t e = 0; e < mesh_.edges().size(); ++e) {
      if (mesh_.edge(e).triangle_count > 0)
        push(e, care);
    }
  }

  float cost(std::uint32_t e, const Collapse& collapse) const {
    if (changes_[e] == TopologyChange::none)
      return collapse.cost;
    if (changes_[e] == TopologyChange::vanishes)
      return costs_.price(e, changes_[e]);  // no border is left to be held
    return std::max(collapse.cost, costs_.price(e, changes_[e]));
  }

  void push(std::uint32_t e, Care care) {
    if (queue_.contains(e) || !mesh_.is_own_edge(e))
      return;
    const float today = cost(e, costs_.best(e));
    if (care == Care::none || today < std::numeric_limits<float>::infinity())
      queue_.push(e, today);
  }

  void drain(std::uint32_t target, Care care) {
    for (std::uint32_t e = queue_.top(); left_ > target && e != CollapseQueue::kNone;
         e = queue_.top()) {
      const Collapse collapse = costs_.best(e);
      const float today = cost(e, collapse);
      const bool in_turn = CollapseQueue::bucket_of(today) <= queue_.bucket(e);
      queue_.erase(e);
      if (in_turn)
        attempt(e, collapse, care);
      else
        queue_.push(e, today);
    }
  }

  void attempt(std::uint32_t e, const Collapse& collapse, Care care) {
    mesh_.gather(collapse.from, around_from_);
    mesh_.gather(collapse.to, around_to_);
    if (care != Care::none) {
      const TopologyChange change =
          link_.change(mesh_, collapse.from, collapse.to, around_from_, around_to_);
      const bool known = change <= changes_[e];
      changes_[e] = change;
      if (!known) {
        push(e, care);
        return;
      }
    }
    if (care == Care::all && !costs_.keeps_shape(collapse, around_from_, around_to_))
      return;
    torn_ += changes_[e] == TopologyChange::none ? 0 : 1;
    carry_out(collapse, care);
  }

  void carry_out(const Collapse& collapse, Care care) {
    mesh_.collapse(collapse.from, collapse.to, around_from_, around_to_, [&](std::uint32_t gone) {
      if (queue_.contains(gone))
        queue_.erase(gone);
    });
    costs_.collapsed(collapse);
    ++collapses_;
    discount(collapse.from);
    discount_if_isolated(collapse.to);
    for (const CollapseMesh::Fan& fan : around_from_) {
      if (fan.next == collapse.to)
        discount_if_isolated(fan.previous);
      else if (fan.previous == collapse.to)
        discount_if_isolated(fan.next);
    }
    mesh_.gather(collapse.to, around_to_);
    for (const CollapseMesh::Fan& fan : around_to_) {  // what was impossible may be possible now
      push(fan.next_edge, care);
      push(fan.previous_edge, care);
    }
  }

  void discount_if_isolated(std::uint32_t vertex) {
    if (vertex < mesh_.own_count() && mesh_.is_isolated(vertex))
      discount(vertex);
  }

  void discount(std::uint32_t vertex) {
    left_ -= static_cast<std::uint32_t>(counted_[vertex]);
    counted_[vertex] = 0;
  }

  CollapseMesh& mesh_;
  Costs& costs_;
  CollapseQueue queue_;
  LinkCondition link_;
  std::vector<TopologyChange> changes_;  ///< as last seen at each edge
  std::vector<char> counted_;            ///< own vertices that count as left
  std::uint32_t left_;
  std::uint32_t collapses_ = 0;
  std::uint32_t torn_ = 0;
  std::vector<CollapseMesh::Fan> around_from_, around_to_;
};

/// Collapses own edges of `mesh` while more than `target` own vertices have triangles, the cheapest
/// first. Fewer may remain when the last collapse takes a whole piece; more when no edge between
/// own vertices is left.
template <class Costs>
FallbackCounts collapse_edges(CollapseMesh& mesh, Costs& costs, std::uint32_t target) {
  return CollapseDriver<Costs>(mesh, costs).run(target);
}

}  // namespace meshhier::cluster_simplify
