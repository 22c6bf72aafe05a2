#include "cluster_simplify/deviation_meter.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

// Little is gained by knowing exactly what is small against the largest deviation around, or
// against the largest so far: with a tenth of that, bounds of scans are up to 7 % tighter, and the
// build of a rough mesh takes a fifth longer.
constexpr double kSmallBeside = 0.5;
constexpr double kSmallAnywhere = 0.5;

// The same part for discs, whose deviations are cheap to know.
constexpr float kSmallDisc = 0.2F;

// A fan's deviation is believed up to this part of the largest so far: unfolding makes long ways
// longer.
constexpr float kLargeFan = 0.5F;

// Stars of more triangles are not compared all with all, which takes their number squared in time
// and memory: at this one half a millisecond.
constexpr std::size_t kHighValence = 128;

/// Whether nothing is left around the edge once it is gone.
bool is_lost(const StarCollapse& c) {
  return all_at(c.around_from, c.to) && all_at(c.around_to, c.from);
}

/// A float that is not below `value`.
float rounded_up(double value) {
  return static_cast<float>(value * (1 + 0x1p-22));
}

}  // namespace

DeviationMeter::DeviationMeter(const CollapseMesh& mesh, std::span<const float> weights)
    : deviations_(mesh.faces().size()),
      weights_(weights.begin(), weights.end()),
      moved_(weights.size()) {
  for (std::uint32_t v = 0; v < weights_.size(); ++v) {
    if (mesh.most_triangles(v) == 0)
      weights_[v] = 0;
    weight_sum_ += double{weights_[v]};
  }
  if (is_two_sided(mesh))
    one_side_.emplace();
}

void DeviationMeter::note(std::span<const Vec3f> positions, const EdgeStar& star, Vec3f place) {
  const StarCollapse c{star.from(), star.to(), place, star.around_from(), star.around_to()};
  if (one_side_ && !is_lost(c) && one_side_->find(star))
    note_one_side(positions, c);
  else
    note_star(positions, star, c);
  weights_[c.to] += weights_[c.from];
}

/// A triangle and its reverse are off alike: by what the one is that is off by more.
void DeviationMeter::note_one_side(std::span<const Vec3f> positions, const StarCollapse& whole) {
  const auto level = [&] {
    for (const auto& [triangle, reverse] : one_side_->pairs()) {
      const float more = std::max(deviations_[triangle], deviations_[reverse]);
      deviations_[triangle] = deviations_[reverse] = more;
    }
  };
  level();
  EdgeStar& star = one_side_->star();
  if (star.is_disc())
    star.look_from(whole.place, positions);
  note_star(positions, star,
            {whole.from, whole.to, whole.place, star.around_from(), star.around_to()});
  for (const auto& [triangle, reverse] : one_side_->pairs())
    deviations_[reverse] = deviations_[triangle];
}

void DeviationMeter::note_star(std::span<const Vec3f> positions, const EdgeStar& star,
                               const StarCollapse& c) {
  if (const std::optional<DiscGap> disc = measure(positions, star, c)) {
    for (std::size_t i = 0; i < disc->triangles.size(); ++i)
      set_deviation(disc->triangles[i], disc->deviations[i]);
    add_square(c.from, disc->from);
    add_square(c.to, disc->to);
  } else if (is_lost(c)) {
    note_lost(positions, c);
  } else if (c.around_from.size() + c.around_to.size() <= kHighValence) {
    note_any(positions, c);
  } else {
    note_high_valence(positions, c);
  }
}

/// The deviations on a disc, if they can be told and are not worth a closer look.
std::optional<DiscGap> DeviationMeter::measure(std::span<const Vec3f> positions,
                                               const EdgeStar& star, const StarCollapse& c) {
  if (star.is_disc()) {
    const float enough = kSmallDisc * largest_;
    if (const auto disc = discs_.measure(positions, deviations_, star, c.place, enough))
      return disc;
  }
  std::optional<DiscGap> fan = fans_.measure(positions, deviations_, c);
  if (fan &&
      *std::max_element(fan->deviations.begin(), fan->deviations.end()) > kLargeFan * largest_)
    return std::nullopt;
  return fan;
}

void DeviationMeter::set_deviation(std::uint32_t triangle, float deviation) {
  deviations_[triangle] = deviation;
  largest_ = std::max(largest_, deviation);
}

void DeviationMeter::add_square(std::uint32_t vertex, float distance) {
  squared_sum_ += double{weights_[vertex]} * double{distance} * double{distance};
  moved_[vertex] = std::max(moved_[vertex], distance);
}

/// All triangles around the edge are at the edge.
void DeviationMeter::note_lost(std::span<const Vec3f> positions, const StarCollapse& c) {
  for (const CollapseMesh::Fan& fan : c.around_from) {
    lost_triangles_.push_back({{positions[c.from], positions[fan.next], positions[fan.previous]},
                               deviations_[fan.triangle]});
  }
  lose(positions, c.from);
  lose(positions, c.to);
}

void DeviationMeter::lose(std::span<const Vec3f> positions, std::uint32_t vertex) {
  lost_vertices_.push_back({vertex, positions[vertex], std::exchange(weights_[vertex], 0.0F)});
}

/// Gives the triangles around the edge as places among points: 0 and 1 its ends, 2 the new vertex.
void DeviationMeter::collect(std::span<const Vec3f> positions, const StarCollapse& c) {
  before_.clear();
  after_.clear();
  points_ = {to_double(positions[c.from]), to_double(positions[c.to]), to_double(c.place)};
  ring_.clear();
  const auto place = [&](std::uint32_t v) {
    const auto found = std::find(ring_.begin(), ring_.end(), v);
    if (found == ring_.end()) {
      ring_.push_back(v);
      points_.push_back(to_double(positions[v]));
      return points_.size() - 1;
    }
    return static_cast<std::size_t>(found - ring_.begin()) + 3;
  };
  const auto add = [&](const CollapseMesh::Fan& fan, std::uint32_t other, std::size_t end) {
    const bool next_is_end = fan.next == other;
    const bool previous_is_end = fan.previous == other;
    const std::size_t next = next_is_end ? 1 - end : place(fan.next);
    const std::size_t previous = previous_is_end ? 1 - end : place(fan.previous);
    before_.push_back({{end, next, previous}, fan.triangle});
    if (!next_is_end && !previous_is_end)
      after_.push_back({{2, next, previous}, fan.triangle});
  };
  for (const CollapseMesh::Fan& fan : c.around_from)
    add(fan, c.to, 0);
  for (const CollapseMesh::Fan& fan : c.around_to) {
    if (!fan.is_at(c.from))
      add(fan, c.from, 1);
  }
}

void DeviationMeter::cover(std::span<const StarTriangle> triangles, bool with_deviation) {
  covers_.clear();
  for (const auto& [corners, triangle] : triangles) {
    covers_.push_back({{points_[corners[0]], points_[corners[1]], points_[corners[2]]},
                       with_deviation ? double{deviations_[triangle]} : 0});
  }
  cover_distance_.begin(covers_, points_);
}

/// Whatever there is around the edge: sheets that meet, folds.
void DeviationMeter::note_any(std::span<const Vec3f> positions, const StarCollapse& c) {
  collect(positions, c);
  const double small = kSmallAnywhere * double{largest_};
  double enough = small;
  fresh_.clear();
  cover(before_, true);
  for (const auto& [corners, triangle] : after_) {
    fresh_.push_back(cover_distance_.triangle(corners, enough));
    enough = std::max(enough, kSmallBeside * fresh_.back());
  }
  cover(after_, false);
  for (const auto& [corners, triangle] : before_) {
    const auto deviation = double{deviations_[triangle]};
    cover_distance_.triangle(corners, std::max(enough - deviation, small));
    for (std::size_t i = 0; i < after_.size(); ++i) {
      const double landed = cover_distance_.landings()[i];
      if (landed >= 0)
        fresh_[i] = std::max(fresh_[i], deviation + landed);
    }
  }
  add_square(c.from, static_cast<float>(cover_distance_.nearest(0)));
  add_square(c.to, static_cast<float>(cover_distance_.nearest(1)));
  for (std::size_t i = 0; i < after_.size(); ++i)
    set_deviation(after_[i].triangle, rounded_up(fresh_[i]));
}

/// A triangle that stays is as near to its image as its corner is. One at the edge shrinks to an
/// edge of those that stay, or, if it hung on the edge alone, into the new vertex.
void DeviationMeter::note_high_valence(std::span<const Vec3f> positions, const StarCollapse& c) {
  constexpr int kMostAsked = 4;  // each looks through all others
  const auto moved = [&](std::uint32_t v) {
    return length(to_double(positions[v]) - to_double(c.place));
  };
  const auto staying = [&](Fans fans, std::uint32_t other, const auto& visit) {
    for (const CollapseMesh::Fan& fan : fans) {
      if (!fan.is_at(other))
        visit(fan);
    }
  };
  const auto holds = [&](std::uint32_t apex) {
    bool found = false;
    const auto look = [&](const CollapseMesh::Fan& fan) { found = found || fan.is_at(apex); };
    staying(c.around_from, c.to, look);
    staying(c.around_to, c.from, look);
    return found;
  };
  const double from = moved(c.from);
  const double to = moved(c.to);
  double shrunk = 0;
  int asked = 0;
  for (const CollapseMesh::Fan& fan : c.around_from) {
    if (!fan.is_at(c.to))
      continue;
    const std::uint32_t apex = fan.next == c.to ? fan.previous : fan.next;
    double farthest = std::max(from, to);
    if (++asked > kMostAsked || !holds(apex))
      farthest = std::max(farthest, moved(apex));
    shrunk = std::max(shrunk, double{deviations_[fan.triangle]} + farthest);
  }
  const auto take = [&](double end) {
    return [this, end, shrunk](const CollapseMesh::Fan& fan) {
      const auto deviation = double{deviations_[fan.triangle]};
      set_deviation(fan.triangle, rounded_up(std::max(deviation + end, shrunk)));
    };
  };
  staying(c.around_from, c.to, take(from));
  staying(c.around_to, c.from, take(to));
  add_square(c.from, static_cast<float>(from));
  add_square(c.to, static_cast<float>(to));
}

}  // namespace meshhier::cluster_simplify
