#include "cluster_simplify/disc_gap.h"

#include "base/tangent_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Below this part of the largest squared coordinate a doubled area has no certain sign.
constexpr float kLeastFloatArea = 1e-6F;

// This part of the largest coordinate is more than the rounding of all sums and quotients here.
constexpr float kFloatRounding = 4e-6F;

FourFloats four_at(const EdgeStar::Row& row, std::uint32_t i) {
  return load_four(&row[i]);
}

/// The lanes of i, i + 1, ... that are below `end`.
FourInts lanes_below(std::uint32_t i, std::uint32_t end) {
  return first_lanes(static_cast<std::int32_t>(end) - static_cast<std::int32_t>(i));
}

}  // namespace

/// Turns everything so that the ring's normal points up. False if it has none.
bool DiscGapMeter::project(std::span<const Vec3f> positions, const EdgeStar& star, Vec3f place) {
  const std::uint32_t size = star.size();
  ring_.size = size;
  ring_.to_begin = star.to_begin();
  const std::uint32_t end = (size + 4) / 4 * 4;  // whole groups that hold the first once more
  const EdgeStar::Row& x = star.x();
  const EdgeStar::Row& y = star.y();
  const EdgeStar::Row& z = star.z();
  FourFloats nx{}, ny{}, nz{}, squared{};
  for (std::uint32_t i = 0; i < end; i += 4) {
    const FourFloats ax = four_at(x, i), ay = four_at(y, i), az = four_at(z, i);
    const FourFloats bx = four_at(x, i + 1), by = four_at(y, i + 1), bz = four_at(z, i + 1);
    nx += ay * bz - az * by;
    ny += az * bx - ax * bz;
    nz += ax * by - ay * bx;
    const FourFloats here = ax * ax + ay * ay + az * az;
    squared = larger_of(here, squared);
  }
  const Vec3f normal{sum_of(nx), sum_of(ny), sum_of(nz)};
  const float area = length(normal);
  if (!(area > 0))
    return false;
  const Vec3f n = normal * (1 / area);
  const auto [u, v] = TangentFrame(n);

  radius_ = largest_of(squared);
  for (const auto& [laid, vertex] : {std::pair(&from_, star.from()), std::pair(&to_, star.to())}) {
    const Vec3f p = positions[vertex] - place;
    laid->x = dot(p, u);
    laid->y = dot(p, v);
    laid->z = dot(p, n);
    radius_ = std::max(radius_, dot(p, p));
  }
  radius_ = std::sqrt(radius_);
  cross_ = from_.x * to_.y - from_.y * to_.x;
  for (std::uint32_t i = 0; i < end; i += 4) {
    const FourFloats ax = four_at(x, i), ay = four_at(y, i), az = four_at(z, i);
    const FourFloats flat_x = ax * u.x + ay * u.y + az * u.z;
    const FourFloats flat_y = ax * v.x + ay * v.y + az * v.z;
    store_four(&ring_.x[i], flat_x);
    store_four(&ring_.y[i], flat_y);
    store_four(&ring_.z[i], ax * n.x + ay * n.y + az * n.z);
    store_four(&from_.beside[i], flat_x * from_.y - flat_y * from_.x);
    store_four(&to_.beside[i], flat_x * to_.y - flat_y * to_.x);
  }
  for (std::uint32_t i = 0; i < size; i += 4) {
    store_four(&ring_.doubled[i], four_at(ring_.x, i) * four_at(ring_.y, i + 1) -
                                      four_at(ring_.y, i) * four_at(ring_.x, i + 1));
  }
  return true;
}

/// Returns, for links i, i + 1, ..., both their vertices x the end that they are opposite of.
std::array<FourFloats, 2> DiscGapMeter::beside_own_ends(std::uint32_t i) const {
  const FourInts of_from = lanes_below(i, ring_.to_begin);
  return {of_from ? four_at(from_.beside, i) : four_at(to_.beside, i),
          of_from ? four_at(from_.beside, i + 1) : four_at(to_.beside, i + 1)};
}

/// Whether no triangle, old or new, shows its back, and the new ones go around once.
bool DiscGapMeter::faces_front() const {
  const std::uint32_t turn = ring_.to_begin;
  const float at_edge = std::min(to_.beside[turn] - from_.beside[turn] - cross_,
                                 from_.beside[0] - to_.beside[0] + cross_);
  FourFloats smallest = FourFloats{} + at_edge;
  FourInts rounds{};  // minus one each
  for (std::uint32_t i = 0; i < ring_.size; i += 4) {
    const FourInts exist = lanes_below(i, ring_.size);
    const FourFloats fresh = four_at(ring_.doubled, i);
    const auto [beside, behind] = beside_own_ends(i);
    // (p - e) x (q - e) = p x q - p x e + q x e: the old triangle's area from numbers at hand.
    const FourFloats old = fresh - beside + behind;
    const FourFloats least = fresh < old ? fresh : old;
    smallest = (exist & (least < smallest)) ? least : smallest;
    smallest = (exist & (least != least)) ? least : smallest;  // a NaN must not be overlooked
    // A fan may face front and still go around twice: one that does once passes y = 0 upwards once.
    rounds += exist & (four_at(ring_.y, i) < 0.0F) & (four_at(ring_.y, i + 1) >= 0.0F);
  }
  const FourInts large = smallest > kLeastFloatArea * radius_ * radius_;
  return !any_of(~large) && rounds[0] + rounds[1] + rounds[2] + rounds[3] == -1;
}

void DiscGapMeter::overlap(std::uint32_t link, float deviation, float gap) {
  deviations_[link] = std::max(deviations_[link], deviation);
  gaps_[link] = std::max(gaps_[link], gap);
}

void DiscGapMeter::overlap_all(float deviation, float gap) {
  all_deviation_ = std::max(all_deviation_, deviation);
  all_gap_ = std::max(all_gap_, gap);
}

/// Lays an end over the new disc, and all old triangles around it over the new one there. Returns
/// its height.
float DiscGapMeter::lay_over_new(End& end) {
  end.sector = -1;
  if (end.x == 0 && end.y == 0 && end.z == 0)
    return 0;  // it is the new vertex
  for (std::uint32_t i = 0; i < ring_.size; i += 4) {
    // The end is counter-clockwise of vertex i and clockwise of the next one.
    const FourInts over = lanes_below(i, ring_.size) & (four_at(end.beside, i) >= 0.0F) &
                          (four_at(end.beside, i + 1) < 0.0F);
    if (!any_of(over))
      continue;
    const std::uint32_t link = i + first_of(over);
    end.sector = static_cast<int>(link);
    const float height =
        end.z - (end.beside[link] * ring_.z[link + 1] - end.beside[link + 1] * ring_.z[link]) /
                    ring_.doubled[link];
    overlap(link, end.deviation, std::abs(height));
    return height;
  }
  // It lies over the new vertex itself, where all new triangles meet.
  overlap_all(end.deviation, std::abs(end.z));
  return end.z;
}

/// Lays the new vertex over the old disc. False if rounding hides where. All new triangles meet at
/// it, so all are told.
bool DiscGapMeter::lay_middle() {
  const std::uint32_t turn = ring_.to_begin;
  // Barycentric: each corner's height counts with the area of the triangle opposite to it.
  const auto lay = [&](float deviation, float wa, float a, float wb, float b, float wc, float c) {
    overlap_all(deviation, std::abs((wa * a + wb * b + wc * c) / (wa + wb + wc)));
    return true;
  };
  for (const End* end : {&from_, &to_}) {
    if (end->x == 0 && end->y == 0 && end->z == 0)
      return true;
  }
  if (cross_ <= 0 && from_.beside[turn] <= 0 && to_.beside[turn] >= 0) {
    return lay(ring_.turn_deviation, to_.beside[turn], from_.z, -cross_, ring_.z[turn],
               -from_.beside[turn], to_.z);
  }
  if (cross_ >= 0 && to_.beside[0] <= 0 && from_.beside[0] >= 0) {
    return lay(ring_.first_deviation, -to_.beside[0], from_.z, from_.beside[0], to_.z, cross_,
               ring_.z[0]);
  }
  for (std::uint32_t i = 0; i < ring_.size; i += 4) {
    const auto [beside, behind] = beside_own_ends(i);
    const FourInts holds = lanes_below(i, ring_.size) & (beside <= 0.0F) & (behind >= 0.0F);
    if (!any_of(holds))
      continue;
    const std::uint32_t lane = first_of(holds);
    const std::uint32_t link = i + lane;
    return lay(ring_.deviation[link], ring_.doubled[link], link < turn ? from_.z : to_.z,
               behind[lane], ring_.z[link], -beside[lane], ring_.z[link + 1]);
  }
  return false;
}

/// An old edge crosses a ray, the new edge to a ring vertex. `beside`, `behind`: the ray's
/// direction x the old edge's start and end. Both lines' parts have one divisor.
void DiscGapMeter::cross_ray(std::uint32_t ray, const Way& way, float beside, float behind) {
  const float scale = 1 / (beside - behind);
  const float part = std::clamp(beside * scale, 0.0F, 1.0F);
  const float along = -way.turned * scale;
  const float gap = std::abs(way.start + part * way.rise - along * ring_.z[ray]);
  overlap(ray, way.deviation, gap);
  overlap(ring_.previous(ray), way.deviation, gap);
}

/// Visits all rays that the old edge from `end` to a ring vertex crosses.
void DiscGapMeter::cross_rays(const End& end, std::uint32_t target, float deviation) {
  if (end.sector < 0)
    return;  // it starts where all new edges start
  // A straight edge turns less than half around, seen from the new vertex: the shorter way to its
  // target leads past exactly the rays that it crosses.
  const bool forth = end.beside[target] < 0;
  auto ray = static_cast<std::uint32_t>(end.sector);
  if (forth)
    ray = ring_.next(ray);
  const float x = ring_.x[target];
  const float y = ring_.y[target];
  const Way way{end.z, ring_.z[target] - end.z, -end.beside[target], deviation};
  for (std::uint32_t steps = 0; ray != target && steps < ring_.size; ++steps) {
    cross_ray(ray, way, end.beside[ray], ring_.x[ray] * y - ring_.y[ray] * x);
    ray = forth ? ring_.next(ray) : ring_.previous(ray);
  }
}

/// Visits all rays that the collapsing edge crosses.
void DiscGapMeter::cross_rays() {
  if (from_.sector < 0 || to_.sector < 0)
    return;
  const bool forth = cross_ > 0;
  const Way way{from_.z, to_.z - from_.z, cross_,
                std::max(ring_.first_deviation, ring_.turn_deviation)};
  auto ray = static_cast<std::uint32_t>(from_.sector);
  const auto last = static_cast<std::uint32_t>(to_.sector);
  while (ray != last) {
    if (forth)
      ray = ring_.next(ray);
    cross_ray(ray, way, from_.beside[ray], to_.beside[ray]);
    if (!forth)
      ray = ring_.previous(ray);
  }
}

/// Starts the books: a new triangle shares its link with an old one, and lies over that at least.
void DiscGapMeter::look_up(std::span<const float> deviations, const EdgeStar& star) {
  ring_.first_deviation = deviations[star.at_edge()[0]->triangle];
  ring_.turn_deviation = deviations[star.at_edge()[1]->triangle];
  for (std::uint32_t i = 0; i < ring_.size; ++i) {
    triangles_[i] = star.links()[i]->triangle;
    ring_.deviation[i] = deviations[triangles_[i]];
  }
  FourFloats from = FourFloats{} + std::max(ring_.first_deviation, ring_.turn_deviation);
  FourFloats to = from;
  for (std::uint32_t i = 0; i < ring_.size; i += 4) {
    const FourFloats deviation = four_at(ring_.deviation, i);
    const FourInts of_from = lanes_below(i, ring_.to_begin);
    const FourInts of_to = lanes_below(i, ring_.size) & ~of_from;
    from = larger_of(of_from ? deviation : from, from);
    to = larger_of(of_to ? deviation : to, to);
    store_four(&deviations_[i], deviation);
    store_four(&gaps_[i], FourFloats{});
  }
  from_.deviation = largest_of(from);
  to_.deviation = largest_of(to);
  all_deviation_ = all_gap_ = 0;
}

/// Visits all crossings. An old edge brings the larger deviation of the triangles on its two sides,
/// since both reach over the ray there.
void DiscGapMeter::lay_edges() {
  const std::uint32_t turn = ring_.to_begin;
  const auto at_link = [&](std::uint32_t i) { return ring_.deviation[i]; };
  cross_rays();
  cross_rays(from_, 0, std::max(ring_.first_deviation, at_link(0)));
  for (std::uint32_t i = 1; i < turn; ++i)
    cross_rays(from_, i, std::max(at_link(i - 1), at_link(i)));
  cross_rays(from_, turn, std::max(at_link(turn - 1), ring_.turn_deviation));
  cross_rays(to_, turn, std::max(ring_.turn_deviation, at_link(turn)));
  for (std::uint32_t i = turn + 1; i < ring_.size; ++i)
    cross_rays(to_, i, std::max(at_link(i - 1), at_link(i)));
  cross_rays(to_, 0, std::max(at_link(ring_.size - 1), ring_.first_deviation));
}

/// Whether all deviations and heights together are no more than that; then they are what every link
/// gets.
bool DiscGapMeter::is_thin(float enough) {
  FourFloats lowest = FourFloats{} + std::min({0.0F, from_.z, to_.z});
  FourFloats highest = FourFloats{} + std::max({0.0F, from_.z, to_.z});
  for (std::uint32_t i = 0; i < ring_.size; i += 4) {
    const FourFloats z = lanes_below(i, ring_.size) ? four_at(ring_.z, i) : FourFloats{};
    lowest = z < lowest ? z : lowest;
    highest = larger_of(z, highest);
  }
  const float range = largest_of(highest) + largest_of(-lowest);
  const float deviation = std::max(from_.deviation, to_.deviation);
  if (!(deviation + range <= enough))
    return false;
  overlap_all(deviation, range);
  return true;
}

/// Deviation and gap of every link. False if they are beyond all numbers.
bool DiscGapMeter::add_up() {
  const float rounding = kFloatRounding * radius_;
  FourInts fails{};
  for (std::uint32_t i = 0; i < ring_.size; i += 4) {
    const FourFloats deviation = larger_of(four_at(deviations_, i), FourFloats{} + all_deviation_);
    const FourFloats gap = larger_of(four_at(gaps_, i), FourFloats{} + all_gap_);
    const FourFloats sum = (deviation + gap + rounding) * (1 + 0x1p-22F);
    store_four(&deviations_[i], sum);
    fails |= lanes_below(i, ring_.size) & ~(sum < kInfinity);
  }
  return !any_of(fails);
}

std::optional<DiscGap> DiscGapMeter::measure(std::span<const Vec3f> positions,
                                             std::span<const float> deviations,
                                             const EdgeStar& star, Vec3f place, float enough) {
  if (!project(positions, star, place) || !faces_front())
    return std::nullopt;
  look_up(deviations, star);
  DiscGap result;
  result.from = lay_over_new(from_);
  result.to = lay_over_new(to_);
  if (!is_thin(enough)) {
    if (!lay_middle())
      return std::nullopt;
    lay_edges();
  }
  if (!add_up())
    return std::nullopt;
  result.triangles = {triangles_.data(), ring_.size};
  result.deviations = {deviations_.data(), ring_.size};
  return result;
}

}  // namespace meshhier::cluster_simplify
