// Collapses edges in order of cost until few enough vertices are left.
//
// Problem. All edges of a tile wait in a queue, cheapest first. A collapse changes the costs of all
// edges around it, some ten or twenty: keeping the queue true after each would take most of the
// time.
//
// Idea. An edge's cost is looked at again when its turn comes, not when a neighbour changes:
//
//      queue, by cost
//      +----+----+----+----+--
//      | 16 edges of the   |      all looked up at once: the machine waits for memory once
//      | lowest bucket     |
//      +----+----+----+----+--
//         |  today's cost in a higher bucket, or an end has just moved? back into the queue
//         v
//      what would it do?   topology changes: back into the queue at the price of that
//         |                triangles turn over: refused, asked again when an end collapses
//         v
//      measured (DeviationMeter::note), then carried out
//
// Invariant. An edge in the queue stands there with a cost that it once had. Collapses make costs
// grow, hardly ever shrink, so what is taken from the queue is about the cheapest there is. An edge
// that vanishes leaves the queue; one that was refused is known by its ends (refused_), and comes
// back when one of them takes part in a collapse.
//
// When the queue is empty and too many vertices are left, the tile gives up care (Care): what was
// refused for its triangles may happen, then anything.
//
// Cost. Pushing and popping are O(1), as the queue has buckets (collapse_queue.h). An edge comes
// back only into a higher bucket, or when its ends change. A collapse goes through the triangles
// around its edge; vertices of more than 1,024 triangles do not collapse (decision 015). Decisions
// 005 and 007 tell about costs and speed.
#pragma once

#include "cluster_simplify/collapse_costs.h"
#include "cluster_simplify/collapse_mesh.h"
#include "cluster_simplify/collapse_queue.h"
#include "cluster_simplify/contraction.h"
#include "cluster_simplify/deviation_meter.h"
#include "cluster_simplify/edge_star.h"
#include "cluster_simplify/link_condition.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// A collapse to be: `from` goes into `to`.
struct Collapse {
  std::uint32_t from = 0, to = 0;
  float cost = 0;  ///< >= 0
  Vec3f place;     ///< where `to` comes to lie, tile-local
};

/// Steps of care; the next one is tried when a tile cannot reach its count with the one before.
enum class Care {
  all,       ///< no triangle turns over; topology changes at its price, no borders meet
  topology,  ///< triangles may turn over
  none,      ///< anything goes
};

/// `costs` says what edges cost and takes note of collapses:
///   best(edges, std::span<Collapse>)         the best ways to collapse some, at today's cost
///   costs(first, std::span<float>)           the costs of a run of edges
///   float price(edge, TopologyChange)        what it costs at least if it changes topology
///   void collapsed(Collapse)
///   std::span<const Vec3f> positions()
template <class Costs>
class CollapseDriver {
 public:
  CollapseDriver(CollapseMesh& mesh, Costs& costs, DeviationMeter& deviation)
      : mesh_(mesh),
        costs_(costs),
        deviation_(deviation),
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
    // Later collapses may have made possible what was refused: as long as a round gets a fair part
    // of the way, there is another.
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
    const bool any_high_valence = recount_high_valences();
    const auto count = static_cast<std::uint32_t>(mesh_.edges().size());
    std::array<float, kBlock> costs;
    for (std::uint32_t first = 0; first < count; first += kBlock) {
      const std::span<float> block(costs.data(), std::min(kBlock, count - first));
      costs_.costs(first, block);
      for (std::uint32_t i = 0; i < block.size(); ++i) {
        const std::uint32_t e = first + i;
        if (mesh_.edge(e).triangle_count > 0 && !queue_.contains(e) && mesh_.is_own_edge(e) &&
            !(any_high_valence && has_high_valence(e)))
          push(e, care, cost(e, block[i]));
      }
    }
  }

  bool has_high_valence(std::uint32_t e) const {
    return mesh_.has_high_valence(mesh_.edge(e).a) || mesh_.has_high_valence(mesh_.edge(e).b);
  }

  /// Counts the triangles that are left at high-valence vertices: the mesh knows an upper bound
  /// only. Returns whether there are any such vertices.
  bool recount_high_valences() {
    bool any = false;
    for (std::uint32_t v = 0; v < mesh_.own_count(); ++v) {
      if (mesh_.has_high_valence(v)) {
        mesh_.star_of(v, around_);
        any = any || mesh_.has_high_valence(v);
      }
    }
    return any;
  }

  /// `plain`: without what a change of topology costs.
  float cost(std::uint32_t e, float plain) const {
    if (changes_[e] == TopologyChange::none)
      return plain;
    if (changes_[e] == TopologyChange::vanishes)
      return costs_.price(e, changes_[e]);  // no border is left to be held
    return std::max(plain, costs_.price(e, changes_[e]));
  }

  void push(std::uint32_t e, Care care) {
    if (queue_.contains(e) || !mesh_.is_own_edge(e) || has_high_valence(e))
      return;
    Collapse collapse;
    costs_.best({&e, 1}, {&collapse, 1});
    push(e, care, cost(e, collapse.cost));
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

  /// Edges are looked at a few at a time: the machine waits for the data of all of them at once.
  void drain(std::uint32_t target, Care care) {
    std::array<std::uint32_t, kAtOnce> room;
    std::array<Collapse, kAtOnce> collapses;
    for (auto edges = queue_.pop(room); !edges.empty(); edges = queue_.pop(room)) {
      const std::uint32_t bucket = queue_.lowest();
      for (const std::uint32_t e : edges)
        mesh_.fetch_edge(e);
      costs_.best(edges, collapses);
      fetch(std::span(collapses).first(edges.size()), bucket);
      moved_.clear();
      for (std::size_t i = 0; i < edges.size(); ++i) {
        if (left_ <= target)
          return;
        take_turn(edges[i], collapses[i], bucket, care);
      }
    }
  }

  /// Asks for what those whose turn it is will need.
  void fetch(std::span<const Collapse> collapses, std::uint32_t bucket) const {
    const auto is_dearer = [&](const Collapse& collapse) {
      return CollapseQueue::bucket_of(collapse.cost) > bucket;
    };
    for (const Collapse& collapse : collapses) {
      if (is_dearer(collapse))
        continue;
      mesh_.fetch_star(collapse.from);
      mesh_.fetch_star(collapse.to);
    }
    for (const Collapse& collapse : collapses) {
      if (is_dearer(collapse))
        continue;
      mesh_.fetch_faces(collapse.from);
      mesh_.fetch_faces(collapse.to);
    }
  }

  void take_turn(std::uint32_t e, const Collapse& collapse, std::uint32_t bucket, Care care) {
    if (mesh_.edge(e).triangle_count == 0 || queue_.contains(e) || has_high_valence(e))
      return;  // by what became of others looked at together with it, or before
    const float today = cost(e, collapse.cost);
    if (CollapseQueue::bucket_of(today) > bucket || has_moved(mesh_.edge(e)))
      queue_.push(e, today);
    else
      attempt(e, collapse, care);
  }

  bool has_moved(const CollapseMesh::Edge& edge) const {
    return std::any_of(moved_.begin(), moved_.end(),
                       [&](std::uint32_t v) { return v == edge.a || v == edge.b; });
  }

  void attempt(std::uint32_t e, const Collapse& collapse, Care care) {
    star_.gather(mesh_, collapse.from, collapse.to);
    if (star_.is_disc()) {  // a disc becomes a disc: no topology changes
      changes_[e] = TopologyChange::none;
      star_.look_from(collapse.place, costs_.positions());
    } else if (care != Care::none) {
      const TopologyChange change =
          link_.change(mesh_, star_.from(), star_.to(), star_.around_from(), star_.around_to());
      // The edge stood in the queue without this price: it goes back and waits for its turn.
      const bool known = change <= changes_[e];
      changes_[e] = change;
      if (!known) {
        push(e, care);
        return;
      }
    }
    if (care == Care::all && !keeps_sides(costs_.positions(), star_, collapse.place)) {
      refuse(e);
      return;
    }
    torn_ += changes_[e] == TopologyChange::none ? 0 : 1;
    carry_out(collapse, care);
  }

  void carry_out(const Collapse& collapse, Care care) {
    deviation_.note(costs_.positions(), star_, collapse.place);
    if (star_.is_disc())
      collapse_disc();
    else
      collapse_any();
    costs_.collapsed(collapse);
    moved_.push_back(collapse.to);
    ++collapses_;
    discount(collapse.from);
    if (refused_[collapse.from] != 0 || refused_[collapse.to] != 0)
      ask_again(collapse.to, care);
  }

  void collapse_disc() {
    for (const std::uint32_t gone : mesh_.collapse_disc(star_))
      queue_.erase(gone);
  }

  void collapse_any() {
    mesh_.collapse(star_.from(), star_.to(), star_.around_from(), star_.around_to(),
                   [&](std::uint32_t gone) { queue_.erase(gone); });
    discount_if_isolated(star_.to());
    for (const CollapseMesh::Fan& fan : star_.around_from()) {
      if (fan.is_at(star_.to()))
        discount_if_isolated(fan.next == star_.to() ? fan.previous : fan.next);
    }
  }

  /// Gives the edges around a vertex that just changed another turn: some had been refused.
  void ask_again(std::uint32_t vertex, Care care) {
    refused_[vertex] = 0;
    for (const CollapseMesh::Fan& fan : mesh_.star_of(vertex, around_)) {
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

  static constexpr std::size_t kAtOnce = 16;     ///< edges looked at together
  static constexpr std::uint32_t kBlock = 1024;  ///< edges whose costs are computed at a time

  CollapseMesh& mesh_;
  Costs& costs_;
  DeviationMeter& deviation_;
  CollapseQueue queue_;
  LinkCondition link_;
  std::vector<TopologyChange> changes_;  ///< as last seen at each edge
  std::vector<char> counted_;            ///< own vertices that count as left
  std::vector<char> refused_;            ///< vertices with edges that could not collapse
  std::uint32_t left_;
  std::uint32_t collapses_ = 0;
  std::uint32_t torn_ = 0;
  EdgeStar star_;
  std::vector<std::uint32_t> moved_;  ///< of those looked at together
  std::vector<CollapseMesh::Fan> around_;
};

/// Collapses own edges of `mesh` while more than `target` own vertices have triangles, the cheapest
/// first. Fewer may remain when the last collapse takes a whole piece; more when no edge between
/// own vertices is left. `deviation` follows.
template <class Costs>
FallbackCounts collapse_edges(CollapseMesh& mesh, Costs& costs, DeviationMeter& deviation,
                              std::uint32_t target) {
  return CollapseDriver<Costs>(mesh, costs, deviation).run(target);
}

}  // namespace meshhier::cluster_simplify
