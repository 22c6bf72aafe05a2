#include "compare/farthest_bound.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace meshhier::comparing {

FarthestBound::Candidate FarthestBound::candidate(const std::array<Vec3d, 3>& corners,
                                                  const std::array<double, 3>& distances,
                                                  double most) {
  const auto& [a, b, c] = corners;
  const double edge = std::max({length(b - a), length(c - b), length(a - c)});
  const double bound = *std::ranges::max_element(distances) + edge / std::numbers::sqrt3;
  return {corners, distances, std::min(bound, most)};
}

double FarthestBound::enough() const {
  return std::max(kEnough * known_, settled_);
}

void FarthestBound::add(const std::array<Vec3d, 3>& corners, const std::array<double, 3>& distances,
                        double most) {
  add(*std::ranges::max_element(distances));
  const Candidate added = candidate(corners, distances, most);
  if (added.bound <= enough()) {
    settled_ = std::max(settled_, added.bound);
    return;
  }
  candidates_.push_back(added);
  if (candidates_.size() < 2 * kMostCandidates)
    return;
  drop_settled();
  if (candidates_.size() > kMostCandidates)
    drop_nearest(kMostCandidates);
}

void FarthestBound::drop_settled() {
  const double limit = enough();
  std::erase_if(candidates_, [&](const Candidate& candidate) {
    const bool is_settled = candidate.bound <= limit;
    settled_ = is_settled ? std::max(settled_, candidate.bound) : settled_;
    return is_settled;
  });
}

/// Gives up the triangles with the smallest bounds. Of equal ones any may go: the bound is the
/// same.
void FarthestBound::drop_nearest(std::size_t kept) {
  const auto end = candidates_.begin() + static_cast<std::ptrdiff_t>(kept);
  std::ranges::nth_element(candidates_, end, std::greater<>(), &Candidate::bound);
  settled_ = std::max(settled_, end->bound);
  candidates_.erase(end, candidates_.end());
}

std::vector<Vec3d> FarthestBound::middles() const {
  std::vector<Vec3d> points;
  points.reserve(3 * candidates_.size());
  for (const Candidate& candidate : candidates_) {
    for (std::size_t i = 0; i < 3; ++i)
      points.push_back((candidate.corners[i] + candidate.corners[(i + 1) % 3]) * 0.5);
  }
  return points;
}

/// Splits each triangle into four; `distances` are those of middles().
void FarthestBound::split(std::span<const double> distances) {
  const std::vector<Candidate> whole = std::exchange(candidates_, {});
  for (const double distance : distances)
    add(distance);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const auto& [a, b, c] = whole[i].corners;
    const auto& [da, db, dc] = whole[i].distances;
    const Vec3d ab = (a + b) * 0.5, bc = (b + c) * 0.5, ca = (c + a) * 0.5;
    const double dab = distances[3 * i], dbc = distances[3 * i + 1], dca = distances[3 * i + 2];
    const double most = whole[i].bound;
    for (const Candidate& part : {candidate({a, ab, ca}, {da, dab, dca}, most),
                                  candidate({ab, b, bc}, {dab, db, dbc}, most),
                                  candidate({ca, bc, c}, {dca, dbc, dc}, most),
                                  candidate({ab, bc, ca}, {dab, dbc, dca}, most)})
      candidates_.push_back(part);
  }
}

double FarthestBound::refine(const Measure& measure) {
  std::size_t points = 0;
  for (drop_settled(); !candidates_.empty(); drop_settled()) {
    // A triangle takes three distances. Too many triangles, or too few distances left: those with
    // the smallest bounds are given up, and the answer is no better than theirs.
    const std::size_t left = (kMostPoints - points) / 3;
    if (candidates_.size() > std::min(left, kMostCandidates))
      drop_nearest(std::min(left, kMostCandidates));
    drop_settled();
    if (candidates_.empty() || left == 0)
      break;
    const std::vector<Vec3d> middle = middles();
    points += middle.size();
    split(measure(middle));
  }
  return std::max(known_, settled_);
}

}  // namespace meshhier::comparing
