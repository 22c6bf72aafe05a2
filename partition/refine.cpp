#include "partition/refine.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace meshhier::partition {
namespace {

// A search ends after so many moves without a better state: lines are 1 % shorter with 20, and
// splitting takes a tenth longer ...
constexpr std::size_t kStall = 12;
// ... or after this many for every vertex it started from: where each move is a small improvement.
constexpr std::size_t kMovesPerSeed = 8;

}  // namespace

RefineCounts& RefineCounts::operator+=(const RefineCounts& other) {
  pairs += other.pairs;
  moves += other.moves;
  kept_moves += other.kept_moves;
  return *this;
}

Refiner::Refiner(const Graph& graph, std::span<std::uint32_t> part_of,
                 std::span<const std::uint32_t> targets, std::span<const char> look_at)
    : graph_(graph),
      part_of_(part_of),
      targets_(targets),
      movable_(static_cast<std::uint32_t>(look_at.size())),
      size_(targets.size()),
      gain_(graph.size()),
      epoch_(graph.size()),
      is_candidate_(look_at.begin(), look_at.end()),
      is_stale_(graph.size()),
      links_(targets.size()) {
  assert(targets.size() <= kMostParts);
  is_candidate_.resize(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    size_[part_of[v]] += graph.weight[v];
    if (is_candidate_[v] != 0)
      candidates_.push_back(v);
  }
}

/// Notes that a vertex changed its part: its neighbours may be on a boundary now, and touches that
/// were gathered before are wrong about them.
void Refiner::look_around(std::uint32_t v) {
  is_stale_[v] = 1;
  for (const Graph::Arc& arc : graph_.arcs_of(v)) {
    is_stale_[arc.to] = 1;
    if (is_candidate_[arc.to] == 0) {
      is_candidate_[arc.to] = 1;
      candidates_.push_back(arc.to);
    }
  }
}

/// Forgets all gains and moves at once: what an epoch wrote is below the next one's numbers.
void Refiner::next_epoch() {
  now_ += 2;
  left_.heap.clear();
  right_.heap.clear();
  log_.clear();
}

/// The gain of moving v to another part: arcs to third parts are cut before and after.
std::int32_t Refiner::gain_of(std::uint32_t v, std::uint32_t other) const {
  const std::uint32_t own = part_of_[v];
  std::int32_t sum = 0;
  for (const Graph::Arc& arc : graph_.arcs_of(v)) {
    const std::uint32_t part = part_of_[arc.to];
    if (part == other)
      sum += static_cast<std::int32_t>(arc.weight);
    else if (part == own)
      sum -= static_cast<std::int32_t>(arc.weight);
  }
  return sum;
}

/// Puts a vertex of one of the two parts into its heap.
void Refiner::offer(std::uint32_t v, std::int32_t gain) {
  gain_[v] = gain;
  epoch_[v] = now_;
  std::vector<Key>& heap = part_of_[v] == left_.part ? left_.heap : right_.heap;
  heap.push_back(key(gain, v));
  std::push_heap(heap.begin(), heap.end());
}

/// Brings a heap's top up to date; false if nothing is left. A vertex has a key of its gain or a
/// higher one: keys are added when gains rise, and corrected here when they fell.
bool Refiner::has_top(Side& side) {
  std::vector<Key>& heap = side.heap;
  while (!heap.empty()) {
    const Key top = heap.front();
    const std::uint32_t v = vertex(top);
    if (!is_moved(v) && gain_[v] == gain(top))
      return true;
    std::pop_heap(heap.begin(), heap.end());
    if (!is_moved(v) && gain_[v] < gain(top)) {
      heap.back() = key(gain_[v], v);
      std::push_heap(heap.begin(), heap.end());
    } else {
      heap.pop_back();
    }
  }
  return false;
}

/// From which side the next vertex moves: where the better one is, as far as sizes allow.
/// `imbalance`: excess of the left side over that of the right.
Refiner::Side* Refiner::choose_side(std::int64_t imbalance, std::int64_t explored) {
  const auto allowed = [&](Side& side, std::int64_t sign) {
    if (!has_top(side))
      return false;
    const std::int64_t after =
        std::abs(imbalance - 2 * sign * graph_.weight[vertex(side.heap.front())]);
    return after <= explored || after < std::abs(imbalance);
  };
  const bool from_left = allowed(left_, 1), from_right = allowed(right_, -1);
  if (!from_left || !from_right)
    return from_left ? &left_ : from_right ? &right_ : nullptr;
  const std::int32_t left_gain = gain(left_.heap.front());
  const std::int32_t right_gain = gain(right_.heap.front());
  if (left_gain != right_gain)
    return left_gain > right_gain ? &left_ : &right_;
  return imbalance >= 0 ? &left_ : &right_;
}

void Refiner::move(std::uint32_t v, std::uint32_t from, std::uint32_t to) {
  part_of_[v] = to;
  size_[from] -= graph_.weight[v];
  size_[to] += graph_.weight[v];
}

void Refiner::update_neighbours(std::uint32_t v, std::uint32_t from, std::uint32_t to) {
  for (const Graph::Arc& arc : graph_.arcs_of(v)) {
    const std::uint32_t u = arc.to;
    const std::uint32_t part = part_of_[u];
    if ((part != from && part != to) || is_moved(u))
      continue;
    // An arc that counted against u's move counts for it now, or the other way round. A gain that
    // rises needs a new key; one that falls waits until has_top() meets the old key.
    const auto change = static_cast<std::int32_t>(2 * arc.weight);
    if (!is_seen(u)) {
      if (!is_fixed(u))
        offer(u, gain_of(u, part == from ? to : from));
    } else if (part == from) {
      offer(u, gain_[u] + change);
    } else {
      gain_[u] -= change;
    }
  }
}

/// Refines parts a and b, from seeds that touch the other; true if anything changed.
bool Refiner::refine_pair(std::uint32_t a, std::uint32_t b, std::span<const Touch> seeds,
                          Slack slack) {
  next_epoch();
  ++counts_.pairs;
  left_.part = a;
  right_.part = b;
  // Seeds were gathered for all pairs at once: pairs before this one may have moved some.
  for (const Touch& seed : seeds) {
    const std::uint32_t v = seed.vertex;
    if (is_stale_[v] == 0)
      offer(v, seed.gain);
    else if (part_of_[v] == a || part_of_[v] == b)
      offer(v, gain_of(v, part_of_[v] == a ? b : a));
  }
  std::int64_t imbalance = excess(a) - excess(b);
  const auto beyond = [&] { return std::max<std::int64_t>(0, std::abs(imbalance) - slack.kept); };
  std::int64_t best_beyond = beyond(), best_gain = 0, total = 0;
  std::size_t best_moves = 0;
  std::size_t most = kMovesPerSeed * seeds.size() + kStall;
  for (;;) {
    // Far off their sizes, every move brings the parts nearer: those do not count.
    if (std::abs(imbalance) > slack.explored)
      ++most;
    else if (log_.size() >= std::min(best_moves + kStall, most))
      break;
    const Side* const from = choose_side(imbalance, slack.explored);
    if (from == nullptr)
      break;
    const std::uint32_t v = vertex(from->heap.front());
    const Side& to = from == &left_ ? right_ : left_;
    total += gain_[v];
    imbalance -= (from == &left_ ? 2 : -2) * static_cast<std::int64_t>(graph_.weight[v]);
    epoch_[v] = now_ + 1;
    move(v, from->part, to.part);
    update_neighbours(v, from->part, to.part);
    log_.push_back(v);
    // Only strictly better states count: so equal ones do not keep the search alive.
    const std::int64_t left = beyond();
    if (left < best_beyond || (left == best_beyond && total > best_gain)) {
      best_beyond = left;
      best_gain = total;
      best_moves = log_.size();
    }
  }
  counts_.moves += log_.size();
  counts_.kept_moves += best_moves;
  for (std::size_t i = log_.size(); i > best_moves; --i) {  // take back what led nowhere
    const std::uint32_t v = log_[i - 1];
    move(v, part_of_[v], part_of_[v] == a ? b : a);
  }
  for (std::size_t i = 0; i < best_moves; ++i)
    look_around(log_[i]);
  return best_moves > 0;
}

/// Notes with which parts a vertex has neighbours, each once.
void Refiner::add_touches(std::uint32_t v, std::vector<Touch>& touches) {
  const std::uint32_t own = part_of_[v];
  const auto parts = static_cast<std::uint32_t>(targets_.size());
  const auto arcs = graph_.arcs_of(v);
  if (std::all_of(arcs.begin(), arcs.end(),
                  [&](const Graph::Arc& arc) { return part_of_[arc.to] == own; }))
    return;
  for (const Graph::Arc& arc : arcs)
    links_[part_of_[arc.to]] += static_cast<std::int32_t>(arc.weight);
  const std::int32_t held = links_[own];
  links_[own] = 0;
  for (const Graph::Arc& arc : arcs) {
    const std::uint32_t other = part_of_[arc.to];
    if (links_[other] == 0)  // noted by an arc before, and cleared for the next vertex
      continue;
    touches.push_back(
        {std::min(own, other) * parts + std::max(own, other), v, links_[other] - held});
    links_[other] = 0;
  }
}

/// Returns all touches by pair, by counting sort: within a pair they stay in the candidates' order.
std::vector<Refiner::Touch> Refiner::sorted_touches() {
  std::vector<Touch> touches;
  for (const std::uint32_t v : candidates_) {
    is_stale_[v] = 0;
    if (!is_fixed(v))
      add_touches(v, touches);
  }
  std::vector<std::uint32_t> next(targets_.size() * targets_.size() + 1);
  for (const Touch& touch : touches)
    ++next[touch.pair + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Touch> sorted(touches.size());
  for (const Touch& touch : touches)
    sorted[next[touch.pair]++] = touch;
  return sorted;
}

void Refiner::refine_all(int rounds, Slack slack) {
  const std::size_t parts = targets_.size();
  std::vector<char> active(parts, 1);
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Touch> touches = sorted_touches();
    std::vector<char> changed(parts);
    for (std::size_t begin = 0, end = 0; begin < touches.size(); begin = end) {
      const std::uint32_t pair = touches[begin].pair;
      while (end < touches.size() && touches[end].pair == pair)
        ++end;
      const auto a = static_cast<std::uint32_t>(pair / parts);
      const auto b = static_cast<std::uint32_t>(pair % parts);
      if ((active[a] != 0 || active[b] != 0) &&
          refine_pair(a, b, std::span(touches).subspan(begin, end - begin), slack))
        changed[a] = changed[b] = 1;
    }
    if (std::find(changed.begin(), changed.end(), 1) == changed.end())
      return;
    active = std::move(changed);
  }
}

bool Refiner::balance_exactly(Reach reach) {
  first_of_.assign(targets_.size() + 1, 0);
  for (const std::uint32_t v : candidates_)
    ++first_of_[part_of_[v] + 1];
  std::partial_sum(first_of_.begin(), first_of_.end(), first_of_.begin());
  std::vector<std::uint32_t> next(first_of_.begin(), first_of_.end() - 1);
  by_part_.resize(candidates_.size());
  for (const std::uint32_t v : candidates_)
    by_part_[next[part_of_[v]]++] = v;
  return balance(0, static_cast<std::uint32_t>(targets_.size()), reach);
}

/// Balances the two halves of the parts first, over the line between them, where vertices cost
/// least; then each half within itself.
bool Refiner::balance(std::uint32_t begin, std::uint32_t end, Reach reach) {
  if (end - begin < 2)
    return true;
  const std::uint32_t middle = begin + (end - begin + 1) / 2;
  std::int64_t left = 0;
  for (std::uint32_t part = begin; part < middle; ++part)
    left += excess(part);
  if (left > 0)
    left = shift(begin, middle, middle, end, left, reach);
  if (left < 0)
    left = shift(middle, end, begin, middle, -left, reach);
  return left == 0 && balance(begin, middle, reach) && balance(middle, end, reach);
}

/// Moves vertices of so much weight from parts [begin, end) into parts [to_begin, to_end); returns
/// the weight that is missing.
std::int64_t Refiner::shift(std::uint32_t begin, std::uint32_t end, std::uint32_t to_begin,
                            std::uint32_t to_end, std::int64_t weight, Reach reach) {
  next_epoch();
  const auto inside = [&](std::uint32_t v) { return part_of_[v] >= begin && part_of_[v] < end; };
  // Returns the part that a vertex gains most by going to; `to_end` if it has no neighbour there.
  const auto is_target = [&](const Graph::Arc& arc) {
    return part_of_[arc.to] >= to_begin && part_of_[arc.to] < to_end;
  };
  const auto best_target = [&](std::uint32_t v) {
    const auto arcs = graph_.arcs_of(v);
    if (std::none_of(arcs.begin(), arcs.end(), is_target))
      return to_end;
    for (const Graph::Arc& arc : arcs)
      links_[part_of_[arc.to]] += static_cast<std::int32_t>(arc.weight);
    std::uint32_t target = to_end;
    for (const Graph::Arc& arc : graph_.arcs_of(v)) {
      const std::uint32_t part = part_of_[arc.to];
      if (!is_target(arc))
        continue;
      if (target == to_end || links_[part] > links_[target] ||
          (links_[part] == links_[target] && part < target))
        target = part;
    }
    gain_[v] = links_[target] - links_[part_of_[v]];
    for (const Graph::Arc& arc : graph_.arcs_of(v))
      links_[part_of_[arc.to]] = 0;
    return target;
  };
  std::vector<Key>& heap = left_.heap;
  const auto offer_for_shift = [&](std::uint32_t v) {
    if (!inside(v) || is_fixed(v) || best_target(v) == to_end)
      return;
    heap.push_back(key(gain_[v], v));
    std::push_heap(heap.begin(), heap.end());
  };
  for (std::uint32_t i = first_of_[begin]; i < first_of_[end]; ++i)
    offer_for_shift(by_part_[i]);
  while (weight > 0 && !heap.empty()) {
    const Key top = heap.front();
    const std::uint32_t v = vertex(top);
    std::pop_heap(heap.begin(), heap.end());
    heap.pop_back();
    if (!inside(v) || gain_[v] != gain(top))
      continue;  // it went already, or has another key since a neighbour went
    const std::uint32_t target = best_target(v);
    move(v, part_of_[v], target);
    ++counts_.moves;
    --weight;
    for (const Graph::Arc& arc : graph_.arcs_of(v))
      offer_for_shift(arc.to);
    look_around(v);
  }
  if (reach == Reach::neighbours)
    return weight;
  // No edge leads to any more: the last vertices go, wherever they are.
  for (std::uint32_t v = movable_; weight > 0 && v > 0; --v) {
    if (!inside(v - 1))
      continue;
    move(v - 1, part_of_[v - 1], to_begin);
    ++counts_.moves;
    --weight;
  }
  return weight;
}

std::vector<char> Refiner::boundary() const {
  std::vector<char> found(graph_.size());
  for (const std::uint32_t v : candidates_) {
    const auto arcs = graph_.arcs_of(v);
    found[v] = std::any_of(arcs.begin(), arcs.end(),
                           [&](const Graph::Arc& arc) { return part_of_[arc.to] != part_of_[v]; });
  }
  return found;
}

}  // namespace meshhier::partition
