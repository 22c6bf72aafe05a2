#include "cluster_simplify/disc_gap.h"

#include "cluster_simplify/meeting_point.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

// Below this part of the largest squared coordinate a doubled area has no certain sign.
constexpr float kLeastArea = 1e-6F;

// Of the largest coordinate: more than the rounding of all sums and quotients here.
constexpr float kRounding = 4e-6F;

FourFloats four_at(const DiscGapMeter::Row& row, std::uint32_t i) {
  FourFloats four;
  std::memcpy(&four, &row[i], sizeof four);
  return four;
}

void put_four(DiscGapMeter::Row& row, std::uint32_t i, FourFloats four) {
  std::memcpy(&row[i], &four, sizeof four);
}

float sum_of(FourFloats four) {
  return (four[0] + four[1]) + (four[2] + four[3]);
}

}  // namespace

/// Puts the links (edges opposite the two vertices) in order, those of `from` first. False unless
/// they make one ring that changes from one to the other at the two triangles of the edge.
bool DiscGapMeter::trace(const StarCollapse& c) {
  std::array<std::uint32_t, kMostLinks> starts, ends, triangles;
  std::uint32_t count = 0;
  std::uint32_t first = CollapseMesh::kNone;
  std::uint32_t turn = CollapseMesh::kNone;
  std::uint32_t dying = 0;
  if (c.around_from.size() + c.around_to.size() > kMostLinks)
    return false;
  for (const CollapseMesh::Fan& fan : c.around_from) {
    if (fan.next == c.to || fan.previous == c.to) {
      (fan.next == c.to ? first : turn) = fan.next == c.to ? fan.previous : fan.next;
      edge_triangles_[fan.next == c.to ? 0 : 1] = fan.triangle;
      ++dying;
      continue;
    }
    triangles[count] = fan.triangle;
    starts[count] = fan.next;
    ends[count++] = fan.previous;
  }
  const std::uint32_t own_links = count;
  if (dying != 2 || first == CollapseMesh::kNone || turn == CollapseMesh::kNone || own_links == 0)
    return false;
  for (const CollapseMesh::Fan& fan : c.around_to) {
    if (fan.next == c.from || fan.previous == c.from)
      continue;
    triangles[count] = fan.triangle;
    starts[count] = fan.next;
    ends[count++] = fan.previous;
  }
  if (own_links == count)
    return false;

  bool simple = true;
  for (std::uint32_t i = 0; i < count; ++i) {
    simple = simple && link_at_[starts[i]] == kNone;
    link_at_[starts[i]] = static_cast<std::uint8_t>(i);
  }
  std::uint32_t vertex = first;
  std::uint32_t length = 0;
  for (; simple && length < count; ++length) {
    const std::uint8_t link = link_at_[vertex];
    if (link == kNone || (link < own_links) != (length < own_links))
      break;
    ring_.vertices[length] = vertex;
    links_[length].triangle = triangles[link];
    link_at_[vertex] = kNone;
    vertex = ends[link];
  }
  for (std::uint32_t i = 0; i < count; ++i)
    link_at_[starts[i]] = kNone;
  ring_.size = count;
  ring_.to_begin = own_links;
  return simple && length == count && vertex == first && ring_.vertices[own_links] == turn;
}

/// Turns everything so that the ring's normal points up. False if it has none.
bool DiscGapMeter::project(std::span<const Vec3f> positions, const StarCollapse& c) {
  const std::uint32_t size = ring_.size;
  const std::uint32_t end = (size + 4) / 4 * 4;  // whole groups that hold the first once more
  alignas(16) Row x, y, z;
  for (std::uint32_t i = 0; i < size; ++i) {
    const Vec3f p = positions[ring_.vertices[i]] - c.place;
    x[i] = p.x;
    y[i] = p.y;
    z[i] = p.z;
  }
  x[size] = x[0];
  y[size] = y[0];
  z[size] = z[0];
  for (std::uint32_t i = size + 1; i <= end; ++i)
    x[i] = y[i] = z[i] = 0;  // adds nothing to sums

  FourFloats nx{}, ny{}, nz{}, squared{};
  for (std::uint32_t i = 0; i < end; i += 4) {
    const FourFloats ax = four_at(x, i), ay = four_at(y, i), az = four_at(z, i);
    const FourFloats bx = four_at(x, i + 1), by = four_at(y, i + 1), bz = four_at(z, i + 1);
    nx += ay * bz - az * by;
    ny += az * bx - ax * bz;
    nz += ax * by - ay * bx;
    const FourFloats here = ax * ax + ay * ay + az * az;
    squared = here > squared ? here : squared;
  }
  const Vec3f normal{sum_of(nx), sum_of(ny), sum_of(nz)};
  const float area = length(normal);
  if (!(area > 0))
    return false;
  const Vec3f n = normal * (1 / area);
  // A frame without roots or branches (Duff et al., Building an Orthonormal Basis, Revisited,
  // 2017).
  const float sign = std::copysign(1.0F, n.z);
  const float a = -1 / (sign + n.z);
  const float b = n.x * n.y * a;
  const Vec3f u{1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  const Vec3f v{b, sign + n.y * n.y * a, -n.y};

  radius_ = std::max({squared[0], squared[1], squared[2], squared[3]});
  for (const auto& [place, vertex] : {std::pair(&from_, c.from), std::pair(&to_, c.to)}) {
    const Vec3f p = positions[vertex] - c.place;
    place->x = dot(p, u);
    place->y = dot(p, v);
    place->z = dot(p, n);
    radius_ = std::max(radius_, dot(p, p));
  }
  radius_ = std::sqrt(radius_);
  cross_ = from_.x * to_.y - from_.y * to_.x;
  for (std::uint32_t i = 0; i < end; i += 4) {
    const FourFloats ax = four_at(x, i), ay = four_at(y, i), az = four_at(z, i);
    const FourFloats flat_x = ax * u.x + ay * u.y + az * u.z;
    const FourFloats flat_y = ax * v.x + ay * v.y + az * v.z;
    put_four(ring_.x, i, flat_x);
    put_four(ring_.y, i, flat_y);
    put_four(ring_.z, i, ax * n.x + ay * n.y + az * n.z);
    put_four(from_.beside, i, flat_x * from_.y - flat_y * from_.x);
    put_four(to_.beside, i, flat_x * to_.y - flat_y * to_.x);
  }
  for (std::uint32_t i = 0; i < size; i += 4) {
    put_four(ring_.doubled, i,
             four_at(ring_.x, i) * four_at(ring_.y, i + 1) -
                 four_at(ring_.y, i) * four_at(ring_.x, i + 1));
  }
  return true;
}

/// Whether no triangle, old or new, shows its back, and the new ones go around once.
bool DiscGapMeter::faces_front() const {
  const float least = kLeastArea * radius_ * radius_;
  const std::uint32_t turn = ring_.to_begin;
  float smallest = std::min(to_.beside[turn] - from_.beside[turn] - cross_,
                            from_.beside[0] - to_.beside[0] + cross_);
  int rounds = 0;
  for (std::uint32_t i = 0; i < ring_.size; ++i) {
    const End& end = i < turn ? from_ : to_;
    smallest = std::min(
        {smallest, ring_.doubled[i], ring_.doubled[i] - end.beside[i] + end.beside[i + 1]});
    rounds += static_cast<int>(ring_.y[i] < 0 && ring_.y[i + 1] >= 0);
  }
  return smallest > least && rounds == 1;
}

void DiscGapMeter::overlap(std::uint32_t link, float drift, float gap) {
  links_[link].drift = std::max(links_[link].drift, drift);
  gaps_[link] = std::max(gaps_[link], gap);
}

void DiscGapMeter::overlap_all(float drift, float gap) {
  for (std::uint32_t i = 0; i < ring_.size; ++i)
    overlap(i, drift, gap);
}

/// Lays an end over the new disc, and all old triangles around it over the new one there. Returns
/// its height.
float DiscGapMeter::lay_over_new(End& end) {
  end.sector = -1;
  if (end.x == 0 && end.y == 0 && end.z == 0)
    return 0;  // it is the new vertex
  for (std::uint32_t i = 0; i < ring_.size; ++i) {
    if (end.beside[i] >= 0 && end.beside[i + 1] < 0) {
      end.sector = static_cast<int>(i);
      const float height =
          end.z -
          (end.beside[i] * ring_.z[i + 1] - end.beside[i + 1] * ring_.z[i]) / ring_.doubled[i];
      overlap(i, end.drift, std::abs(height));
      return height;
    }
  }
  overlap_all(end.drift, std::abs(end.z));
  return end.z;
}

/// Lays the new vertex over the old disc. False if rounding hides where.
bool DiscGapMeter::lay_middle() {
  const std::uint32_t turn = ring_.to_begin;
  const auto lay = [&](float drift, float wa, float a, float wb, float b, float wc, float c) {
    overlap_all(drift, std::abs((wa * a + wb * b + wc * c) / (wa + wb + wc)));
    return true;
  };
  for (const End* end : {&from_, &to_}) {
    if (end->x == 0 && end->y == 0 && end->z == 0)
      return true;
  }
  if (cross_ <= 0 && from_.beside[turn] <= 0 && to_.beside[turn] >= 0) {
    return lay(ring_.turn_drift, to_.beside[turn], from_.z, -cross_, ring_.z[turn],
               -from_.beside[turn], to_.z);
  }
  if (cross_ >= 0 && to_.beside[0] <= 0 && from_.beside[0] >= 0) {
    return lay(ring_.first_drift, -to_.beside[0], from_.z, from_.beside[0], to_.z, cross_,
               ring_.z[0]);
  }
  for (std::uint32_t i = 0; i < ring_.size; ++i) {
    const End& end = i < turn ? from_ : to_;
    if (end.beside[i] <= 0 && end.beside[i + 1] >= 0) {
      return lay(ring_.drift[i], ring_.doubled[i], end.z, end.beside[i + 1], ring_.z[i],
                 -end.beside[i], ring_.z[i + 1]);
    }
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
  overlap(ray, way.drift, gap);
  overlap(ring_.previous(ray), way.drift, gap);
}

/// The old edge from `end` to a ring vertex.
void DiscGapMeter::cross_rays(const End& end, std::uint32_t target, float drift) {
  if (end.sector < 0)
    return;  // it starts where all new edges start
  const bool forth = end.beside[target] < 0;
  auto ray = static_cast<std::uint32_t>(end.sector);
  if (forth)
    ray = ring_.next(ray);
  const float x = ring_.x[target];
  const float y = ring_.y[target];
  const Way way{end.z, ring_.z[target] - end.z, -end.beside[target], drift};
  for (std::uint32_t steps = 0; ray != target && steps < ring_.size; ++steps) {
    cross_ray(ray, way, end.beside[ray], ring_.x[ray] * y - ring_.y[ray] * x);
    ray = forth ? ring_.next(ray) : ring_.previous(ray);
  }
}

/// The collapsing edge.
void DiscGapMeter::cross_rays() {
  if (from_.sector < 0 || to_.sector < 0)
    return;
  const bool forth = cross_ > 0;
  const Way way{from_.z, to_.z - from_.z, cross_, std::max(ring_.first_drift, ring_.turn_drift)};
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

void DiscGapMeter::look_up(std::span<const float> drifts) {
  ring_.first_drift = drifts[edge_triangles_[0]];
  ring_.turn_drift = drifts[edge_triangles_[1]];
  from_.drift = to_.drift = std::max(ring_.first_drift, ring_.turn_drift);
  for (std::uint32_t i = 0; i < ring_.size; ++i) {
    ring_.drift[i] = drifts[links_[i].triangle];
    links_[i].drift = ring_.drift[i];
    gaps_[i] = 0;
    End& end = i < ring_.to_begin ? from_ : to_;
    end.drift = std::max(end.drift, ring_.drift[i]);
  }
}

void DiscGapMeter::lay_edges() {
  const std::uint32_t turn = ring_.to_begin;
  const auto at_link = [&](std::uint32_t i) { return ring_.drift[i]; };
  cross_rays();
  cross_rays(from_, 0, std::max(ring_.first_drift, at_link(0)));
  for (std::uint32_t i = 1; i < turn; ++i)
    cross_rays(from_, i, std::max(at_link(i - 1), at_link(i)));
  cross_rays(from_, turn, std::max(at_link(turn - 1), ring_.turn_drift));
  cross_rays(to_, turn, std::max(ring_.turn_drift, at_link(turn)));
  for (std::uint32_t i = turn + 1; i < ring_.size; ++i)
    cross_rays(to_, i, std::max(at_link(i - 1), at_link(i)));
  cross_rays(to_, 0, std::max(at_link(ring_.size - 1), ring_.first_drift));
}

/// Whether all drifts and heights together are no more than that; then they are what every link
/// gets.
bool DiscGapMeter::is_thin(float enough) {
  float lowest = std::min({0.0F, from_.z, to_.z});
  float highest = std::max({0.0F, from_.z, to_.z});
  for (std::uint32_t i = 0; i < ring_.size; ++i) {
    lowest = std::min(lowest, ring_.z[i]);
    highest = std::max(highest, ring_.z[i]);
  }
  const float drift = std::max(from_.drift, to_.drift);
  if (!(drift + (highest - lowest) <= enough))
    return false;
  overlap_all(drift, highest - lowest);
  return true;
}

std::optional<DiscGap> DiscGapMeter::measure(std::span<const Vec3f> positions,
                                             std::span<const float> drifts,
                                             const StarCollapse& collapse, float enough) {
  if (!trace(collapse) || !project(positions, collapse) || !faces_front())
    return std::nullopt;
  look_up(drifts);
  DiscGap result;
  result.from = lay_over_new(from_);
  result.to = lay_over_new(to_);
  if (!is_thin(enough)) {
    if (!lay_middle())
      return std::nullopt;
    lay_edges();
  }
  const float rounding = kRounding * radius_;
  for (std::uint32_t i = 0; i < ring_.size; ++i) {
    links_[i].drift = (links_[i].drift + gaps_[i] + rounding) * (1 + 0x1p-22F);
    if (!std::isfinite(links_[i].drift))
      return std::nullopt;
  }
  result.links = {links_.data(), ring_.size};
  return result;
}

}  // namespace meshhier::cluster_simplify
