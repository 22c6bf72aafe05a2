// Collapses edges in order of cost until few enough vertices are left.
#pragma once

#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/collapse_queue.h"
#include "cluster_simplify/contraction.h"
#include "cluster_simplify/drift_meter.h"
#include "cluster_simplify/link_condition.h"

#include <algorithm>
#include <array>
#include <cstddef>
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
///   costs(first, std::span<float>)           the costs of a run of edges
///   float price(edge, TopologyChange)        what it costs at least if it changes topology
///   bool keeps_shape(Collapse, Fans around_from, Fans around_to)
///   void collapsed(Collapse)
///   std::span<const Vec3f> positions()
/// An edge's cost is looked at again when its turn comes, not when a neighbour changes: collapses
/// make costs grow, hardly ever shrink.
template <class Costs>
class CollapseDriver {
 public:
  CollapseDriver(CollapseMesh& mesh, Costs& costs, DriftMeter& drift)
      : mesh_(mesh),
        costs_(costs),
        drift_(drift),
        queue_(static_cast<std::uint32_t>(mesh.edges().size())),
        link_(mesh.vertex_count()),
        changes_(mesh.edges().size(), TopologyChange::none),
        counted_(mesh.own_count(), 1),
        refused_(mesh.vertex_count()),
        left_(mesh.own_count()) {
    for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
      if (mesh.most_triangles(v) == 0)
        discount(v);
    }
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
    const auto count = static_cast<std::uint32_t>(mesh_.edges().size());
    std::array<float, kBlock> costs;
    for (std::uint32_t first = 0; first < count; first += kBlock) {
      const std::span<float> block(costs.data(), std::min(kBlock, count - first));
      costs_.costs(first, block);
      for (std::uint32_t i = 0; i < block.size(); ++i) {
        const std::uint32_t e = first + i;
        if (mesh_.edge(e).triangle_count > 0 && !queue_.contains(e) && mesh_.is_own_edge(e))
          push(e, care, changes_[e] == TopologyChange::none ? block[i] : cost(e, costs_.best(e)));
      }
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
    if (!queue_.contains(e) && mesh_.is_own_edge(e))
      push(e, care, cost(e, costs_.best(e)));
  }

  void push(std::uint32_t e, Care care, float today) {
    if (care == Care::none || today < std::numeric_limits<float>::infinity())
      queue_.push(e, today);
    else
      refuse(e);
  }

  void refuse(std::uint32_t e) {
    refused_[mesh_.edge(e).a] = 1;
    refused_[mesh_.edge(e).b] = 1;
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
    if (care == Care::all && !costs_.keeps_shape(collapse, around_from_, around_to_)) {
      refuse(e);
      return;
    }
    torn_ += changes_[e] == TopologyChange::none ? 0 : 1;
    carry_out(collapse, care);
  }

  void carry_out(const Collapse& collapse, Care care) {
    drift_.note(costs_.positions(),
                {collapse.from, collapse.to, collapse.place, around_from_, around_to_});
    mesh_.collapse(collapse.from, collapse.to, around_from_, around_to_, [&](std::uint32_t gone) {
      if (queue_.contains(gone))
        queue_.erase(gone);
    });
    costs_.collapsed(collapse);
    ++collapses_;
    discount(collapse.from);
    if (mesh_.most_triangles(collapse.to) == 0)
      discount_if_isolated(collapse.to);
    for (const CollapseMesh::Fan& fan : around_from_) {  // the edge to a vertex cut off is gone
      if (fan.next == collapse.to && mesh_.edge(fan.previous_edge).triangle_count == 0)
        discount_if_isolated(fan.previous);
      else if (fan.previous == collapse.to && mesh_.edge(fan.next_edge).triangle_count == 0)
        discount_if_isolated(fan.next);
    }
    if (refused_[collapse.from] != 0 || refused_[collapse.to] != 0)
      ask_again(collapse.to, care);
  }

  /// What was impossible may be possible now.
  void ask_again(std::uint32_t vertex, Care care) {
    refused_[vertex] = 0;
    mesh_.gather(vertex, around_to_);
    for (const CollapseMesh::Fan& fan : around_to_) {
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

  static constexpr std::uint32_t kBlock = 1024;  ///< edges whose costs are computed at a time

  CollapseMesh& mesh_;
  Costs& costs_;
  DriftMeter& drift_;
  CollapseQueue queue_;
  LinkCondition link_;
  std::vector<TopologyChange> changes_;  ///< as last seen at each edge
  std::vector<char> counted_;            ///< own vertices that count as left
  std::vector<char> refused_;            ///< vertices with edges that could not collapse
  std::uint32_t left_;
  std::uint32_t collapses_ = 0;
  std::uint32_t torn_ = 0;
  std::vector<CollapseMesh::Fan> around_from_, around_to_;
};

/// Collapses own edges of `mesh` while more than `target` own vertices have triangles, the cheapest
/// first. Fewer may remain when the last collapse takes a whole piece; more when no edge between
/// own vertices is left. `drift` follows.
template <class Costs>
FallbackCounts collapse_edges(CollapseMesh& mesh, Costs& costs, DriftMeter& drift,
                              std::uint32_t target) {
  return CollapseDriver<Costs>(mesh, costs, drift).run(target);
}

}  // namespace meshhier::cluster_simplify
