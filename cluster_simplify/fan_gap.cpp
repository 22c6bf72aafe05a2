#include "cluster_simplify/fan_gap.h"

#include "base/angle.h"
#include "base/closest_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace meshhier::cluster_simplify {
namespace {

// Below this part of the squared size a doubled area has no certain sign.
constexpr double kLeastFanArea = 1e-9;

// This part of the largest coordinate is more than the rounding of all sums and quotients here, and
// of the coordinates themselves.
constexpr double kFanRounding = 1e-7;

// An open fan is squeezed if it turns farther than this.
constexpr double kWidest = 1.8 * std::numbers::pi;

// How far along a border an end may be laid: at the next vertex its triangles would be flat.
constexpr double kAlongBorder = 0.98;

}  // namespace

/// Collects the links, the edges opposite the two ends. False if they cannot make a ring.
bool FanGapMeter::collect_links(const StarCollapse& c, Links& found) {
  size_ = 0;
  edge_triangle_count_ = 0;
  if (c.around_from.size() + c.around_to.size() > kMostLinks)
    return false;
  bool twice[2] = {false, false};
  // Triangles turn counter-clockwise, so a link that runs from next to previous does so around its
  // end, too. Two edge triangles with `to` on the same side of `from`: orientations disagree.
  // Around `from` the links run from apexes_[0] to apexes_[1], around `to` from there back.
  for (const CollapseMesh::Fan& fan : c.around_from) {
    if (!fan.is_at(c.to)) {
      found[size_++] = {fan.next, fan.previous, fan.triangle, 0};
      continue;
    }
    const std::size_t side = fan.next == c.to ? 0 : 1;
    if (std::exchange(twice[side], true))
      return false;
    apexes_[side] = side == 0 ? fan.previous : fan.next;
    edge_triangles_[side] = fan.triangle;
    ++edge_triangle_count_;
  }
  for (const CollapseMesh::Fan& fan : c.around_to) {
    if (!fan.is_at(c.from))
      found[size_++] = {fan.next, fan.previous, fan.triangle, 1};
  }
  if (edge_triangle_count_ == 1 && twice[1])  // the only one comes first
    swap_edge_triangles();
  return size_ > 0 && edge_triangle_count_ > 0;
}

/// Puts links in order along a closed or open ring. False if they make neither.
bool FanGapMeter::order_links(std::span<const Link> found) {
  // The link that starts there. A number beyond the links: none does, or several, which no ring
  // has.
  const auto starting_at = [&](std::uint32_t vertex) {
    std::uint32_t at = kMostLinks;
    for (std::uint32_t i = 0; i < size_; ++i) {
      if (found[i].start == vertex)
        at = at == kMostLinks ? i : kMostLinks + 1;
    }
    return at;
  };
  // A link that no other one ends at begins an open ring. Two of them, or two links that end at one
  // vertex, make no single ring.
  std::uint32_t at = 0;
  bool open = false;
  for (std::uint32_t i = 0; i < size_; ++i) {
    const auto ends = std::ranges::count(found, found[i].start, &Link::end);
    if (ends > 1 || (ends == 0 && open))
      return false;
    if (ends == 0) {
      at = i;
      open = true;
    }
  }
  // Follow the links. An open ring that ends too early left some out, another sheet at the same
  // edge. A closed one is walked again instead, and find_shape() sees its owners change too often.
  shape_ = open ? Shape::border_edge : Shape::closed;
  for (std::uint32_t length = 0; length < size_; ++length) {
    if (at >= size_)
      return false;
    vertices_[length] = found[at].start;
    vertices_[length + 1] = found[at].end;
    is_of_to_[length] = found[at].is_of_to;
    triangles_[length] = found[at].triangle;
    at = starting_at(found[at].end);
  }
  return open ? at == kMostLinks : at < size_ && found[at].start == vertices_[0];
}

void FanGapMeter::swap_edge_triangles() {
  std::swap(apexes_[0], apexes_[1]);
  std::swap(edge_triangles_[0], edge_triangles_[1]);
}

/// Returns where the run of links of one owner ends that begins at `i`.
std::uint32_t FanGapMeter::run_end(std::uint32_t i) const {
  std::uint32_t j = i;
  while (j < size_ && is_of_to_[j] == is_of_to_[i])
    ++j;
  return j;
}

void FanGapMeter::name_ends(const StarCollapse& c, bool first_is_to) {
  first_.vertex = first_is_to ? c.to : c.from;
  second_.vertex = first_is_to ? c.from : c.to;
  if (first_is_to && edge_triangle_count_ == 2)
    swap_edge_triangles();
}

/// Finds which end has which links. False if the owner changes anywhere but at the third corners of
/// the edge's triangles: the old triangles of both ends fill one ring only if they meet there
/// alone.
bool FanGapMeter::find_shape(const StarCollapse& c) {
  if (shape_ == Shape::closed)
    return edge_triangle_count_ == 2 && find_closed(c);
  return edge_triangle_count_ == 1 ? find_border_edge(c) : find_border_end(c);
}

bool FanGapMeter::find_closed(const StarCollapse& c) {
  // The ring shall begin where the links of `from` do.
  std::uint32_t start = 0;
  while (start < size_ && !(is_of_to_[start] == 0 && is_of_to_[(start + size_ - 1) % size_] == 1))
    ++start;
  if (start == size_)
    return false;
  std::rotate(vertices_.begin(), vertices_.begin() + start, vertices_.begin() + size_);
  std::rotate(is_of_to_.begin(), is_of_to_.begin() + start, is_of_to_.begin() + size_);
  std::rotate(triangles_.begin(), triangles_.begin() + start, triangles_.begin() + size_);
  vertices_[size_] = vertices_[0];
  turn_ = run_end(0);
  head_ = 0;
  name_ends(c, false);
  return run_end(turn_) == size_ && apexes_[0] == vertices_[0] && apexes_[1] == vertices_[turn_];
}

bool FanGapMeter::find_border_edge(const StarCollapse& c) {
  // An end may have no other triangle: then its border goes on along the edge's one.
  shape_ = Shape::border_edge;
  head_ = 0;
  turn_ = apexes_[0] == vertices_[0] ? 0 : run_end(0);
  name_ends(c, (is_of_to_[0] == 1) == (turn_ > 0));
  return (turn_ == size_ || run_end(turn_) == size_) && apexes_[0] == vertices_[turn_];
}

/// Two edge triangles on an open ring: one end is inside, and its links are one run in the middle.
bool FanGapMeter::find_border_end(const StarCollapse& c) {
  shape_ = Shape::border_end;
  for (const bool inner_is_to : {false, true}) {
    std::uint32_t begin = 0;
    while (begin < size_ && (is_of_to_[begin] == 1) != inner_is_to)
      ++begin;
    if (begin == size_)
      continue;
    const std::uint32_t end = run_end(begin);
    const std::uint32_t rest = end == size_ ? size_ : run_end(end);
    const std::size_t side = inner_is_to ? 1 : 0;
    if (rest != size_ || apexes_[side] != vertices_[begin] || apexes_[1 - side] != vertices_[end])
      continue;
    head_ = begin;
    turn_ = end;
    name_ends(c, inner_is_to);
    return true;
  }
  return false;
}

/// Lays the new triangles into the plane, around the new vertex. False if one has no area there, or
/// more than half a turn at the new vertex.
bool FanGapMeter::unfold(std::span<const Vec3f> positions, const StarCollapse& c) {
  const Vec3d middle = to_double(c.place);
  std::array<double, kMostLinks + 1> lengths, angles;
  radius_ = 0;
  for (std::uint32_t i = 0; i <= size_; ++i) {
    ring_[i] = to_double(positions[vertices_[i]]) - middle;
    lengths[i] = length(ring_[i]);
    radius_ = std::max(radius_, lengths[i]);
  }
  angles[0] = 0;
  for (std::uint32_t i = 0; i < size_; ++i) {
    angles[i + 1] =
        angles[i] + angle_of(dot(ring_[i], ring_[i + 1]), length(cross(ring_[i], ring_[i + 1])));
  }
  const double total = angles[size_];
  if (!(total > 0))
    return false;
  // A closed fan must close in the plane: a peak's angles are less than a full turn, a saddle's are
  // more. An open one may keep its angles unless it would meet itself.
  const double scale = is_open() ? std::min(1.0, kWidest / total) : 2 * std::numbers::pi / total;
  for (std::uint32_t i = 0; i <= size_; ++i) {
    const UnitTurn turn = turn_by(angles[i] * scale);
    flat_[i] = {lengths[i] * turn.cosine, lengths[i] * turn.sine};
  }
  if (!is_open())
    flat_[size_] = flat_[0];
  const double least = kLeastFanArea * radius_ * radius_;
  for (std::uint32_t i = 0; i < size_; ++i) {
    if (!(turn(flat_[i], flat_[i + 1]) > least))
      return false;
  }
  return true;
}

/// Lays an end on the nearest point of the fan between two ring vertices.
void FanGapMeter::lay_nearest(End& end, std::uint32_t begin, std::uint32_t until) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = begin; i < until; ++i) {
    const TriangleFrame frame({}, ring_[i], ring_[i + 1]);
    const ClosestPoint nearest = closest_point(end.place, frame);
    if (nearest.squared_distance >= least)
      continue;
    least = nearest.squared_distance;
    // The same shares of the ring's two vertices make the point in space and in the plane. Rounding
    // may push them out of the triangle; clamped and used for both, they still name one point of
    // the fan, so the distance is that of a real map, if not of the nearest point.
    const double xb = dot(nearest.point, frame.ab);
    const double xc = dot(nearest.point, frame.ac);
    const double area = frame.bb * frame.cc - frame.bc * frame.bc;
    const double on_b = area > 0 ? std::clamp((frame.cc * xb - frame.bc * xc) / area, 0.0, 1.0) : 0;
    const double on_c =
        area > 0 ? std::clamp((frame.bb * xc - frame.bc * xb) / area, 0.0, 1.0 - on_b) : 0;
    end.sector = i;
    end.image = ring_[i] * on_b + ring_[i + 1] * on_c;
    end.flat = {flat_[i].x * on_b + flat_[i + 1].x * on_c,
                flat_[i].y * on_b + flat_[i + 1].y * on_c};
  }
}

/// Lays an end on the new border, a ray: old border onto new border, or the discs would not fill
/// the same polygon.
void FanGapMeter::lay_on_ray(End& end, std::uint32_t ray, std::uint32_t sector) {
  const double squared = dot(ring_[ray], ring_[ray]);
  const double part =
      squared > 0 ? std::clamp(dot(end.place, ring_[ray]) / squared, 0.0, kAlongBorder) : 0;
  end.sector = sector;
  end.image = ring_[ray] * part;
  end.flat = {flat_[ray].x * part, flat_[ray].y * part};
}

bool FanGapMeter::lay_ends(std::span<const Vec3f> positions, const StarCollapse& c) {
  for (End* end : {&first_, &second_}) {
    end->place = to_double(positions[end->vertex]) - to_double(c.place);
    radius_ = std::max(radius_, length(end->place));
  }
  switch (shape_) {
    case Shape::closed:
      lay_nearest(first_, 0, size_);
      lay_nearest(second_, 0, size_);
      break;
    case Shape::border_edge:
      lay_on_ray(first_, 0, 0);
      lay_on_ray(second_, size_, size_ - 1);
      break;
    case Shape::border_end:
      lay_nearest(first_, head_, turn_);
      second_.flat = {};
      second_.image = {};
      break;
  }
  return lies_flat();
}

bool FanGapMeter::run_lies_flat(const End& end, std::uint32_t begin, std::uint32_t until) const {
  const double least = kLeastFanArea * radius_ * radius_;
  for (std::uint32_t i = begin; i < until; ++i) {
    if (!(turn(between(end.flat, flat_[i]), between(end.flat, flat_[i + 1])) > least))
      return false;
  }
  return true;
}

/// Whether no old triangle is turned over. All fill one polygon, so then none overlaps another.
bool FanGapMeter::lies_flat() const {
  const Flat a = first_.flat;
  const Flat b = second_.flat;
  const double least = kLeastFanArea * radius_ * radius_;
  switch (shape_) {
    case Shape::closed:
      return run_lies_flat(first_, 0, turn_) && run_lies_flat(second_, turn_, size_) &&
             turn(between(a, flat_[turn_]), between(a, b)) > least &&
             turn(between(a, b), between(a, flat_[0])) > least;
    case Shape::border_edge:  // the edge bends at the new vertex: its triangle becomes two there
      return run_lies_flat(first_, 0, turn_) && run_lies_flat(second_, turn_, size_) &&
             turn(a, flat_[turn_]) >= 0 && turn(flat_[turn_], b) >= 0;
    case Shape::border_end:
      break;
  }
  // b lies on the new vertex: its triangles beyond first_'s links lie on new ones, which unfold()
  // has found to have an area. The two at the edge may be flat: their corners lie on a new edge
  // then.
  return run_lies_flat(first_, head_, turn_) && turn(flat_[head_], a) >= 0 &&
         turn(a, flat_[turn_]) >= 0;
}

/// The largest deviation of the old triangles of links [begin, until).
double FanGapMeter::run_deviation(std::uint32_t begin, std::uint32_t until) const {
  double most = 0;
  for (std::uint32_t i = begin; i < until; ++i)
    most = std::max(most, deviation_[i]);
  return most;
}

/// Starts the books: a new triangle shares its link with an old one, and lies over that at least.
void FanGapMeter::look_up(std::span<const float> deviations) {
  for (std::uint32_t i = 0; i < size_; ++i) {
    deviation_[i] = fresh_[i] = double{deviations[triangles_[i]]};
    gap_[i] = 0;
  }
  edge_deviation_ = {0, 0};
  for (std::size_t side = 0; side < edge_triangle_count_; ++side)
    edge_deviation_[side] = double{deviations[edge_triangles_[side]]};
  const double at_edge = std::max(edge_deviation_[0], edge_deviation_[1]);
  first_.deviation = std::max(at_edge, run_deviation(head_, turn_));
  second_.deviation = std::max({at_edge, run_deviation(0, head_), run_deviation(turn_, size_)});
}

/// Enters a corner of the overlay: the new triangle of `link` has it, old triangles of that
/// deviation meet there, and the two discs are `gap` apart.
void FanGapMeter::overlap(std::uint32_t link, double deviation, double gap) {
  fresh_[link] = std::max(fresh_[link], deviation);
  gap_[link] = std::max(gap_[link], gap);
}

void FanGapMeter::overlap_all(double deviation, double gap) {
  for (std::uint32_t i = 0; i < size_; ++i)
    overlap(i, deviation, gap);
}

/// Where an old edge from `end` crosses the new edge to a ring vertex.
void FanGapMeter::cross_ray(std::uint32_t ray, const End& end, Flat to, Vec3d to_place,
                            double deviation) {
  // The old edge's ends lie `beside` and `behind` the ray, in proportion to their distances from
  // it. An edge along the ray crosses it nowhere: what is entered then is more than needed.
  const double beside = turn(flat_[ray], end.flat);
  const double behind = turn(flat_[ray], to);
  const double divisor = beside - behind;
  const double part = divisor != 0 ? std::clamp(beside / divisor, 0.0, 1.0) : 0;
  const double along = divisor != 0 ? std::clamp(-turn(end.flat, to) / divisor, 0.0, 1.0) : 0;
  const double gap = length(end.place + (to_place - end.place) * part - ring_[ray] * along);
  if (is_open()) {
    overlap(ray, deviation, gap);  // inner rays only: there is a link on both sides
    overlap(ray - 1, deviation, gap);
    return;
  }
  overlap(ray == size_ ? 0 : ray, deviation, gap);
  overlap((ray == 0 ? size_ : ray) - 1, deviation, gap);
}

/// Visits all crossings of the old edge from an end to a ring vertex, which is no crossing itself.
void FanGapMeter::cross_rays(const End& end, std::uint32_t target, double deviation) {
  // Seen from the new vertex a straight edge turns less than half around: the shorter way leads
  // past all rays that it crosses. On an open ring there is one way only.
  const bool forth = is_open() ? target > end.sector : turn(end.flat, flat_[target]) > 0;
  std::uint32_t ray = forth ? ray_after(end.sector) : end.sector;
  for (std::uint32_t steps = 0; ray != target && steps <= size_; ++steps) {
    cross_ray(ray, end, flat_[target], ring_[target], deviation);
    ray = forth ? ray_after(ray) : (ray == 0 ? size_ : ray) - 1;
  }
}

/// Visits all crossings of the collapsing edge, which ends inside the ring on both sides.
void FanGapMeter::cross_between_ends() {
  const bool forth = turn(first_.flat, second_.flat) > 0;
  const double deviation = std::max(edge_deviation_[0], edge_deviation_[1]);
  // `ray` counts sectors here, and a sector begins at the ray of its number. Forth, the ray that is
  // crossed begins the sector that is entered; back, the one that is left.
  std::uint32_t ray = first_.sector;
  for (std::uint32_t steps = 0; ray != second_.sector && steps <= size_; ++steps) {
    if (forth)
      ray = ray_after(ray);
    cross_ray(ray, first_, second_.flat, second_.place, deviation);
    if (!forth)
      ray = (ray == 0 ? size_ : ray) - 1;
  }
}

/// Lays the new vertex over the old disc. False if rounding hides where.
bool FanGapMeter::lay_middle() {
  if (shape_ == Shape::border_end) {
    // second_ lies there. Its triangles outside of first_'s links are each under one new triangle,
    // and are booked. The two at the edge may lie under any between r[head] and r[turn].
    const double gap = length(second_.place);
    overlap_all(0, gap);
    for (std::uint32_t i = head_; i < turn_; ++i)
      overlap(i, std::max(edge_deviation_[0], edge_deviation_[1]), gap);
    return true;
  }
  if (shape_ == Shape::border_edge) {
    // The old edge may bend anywhere; at its nearest point the gap is least.
    const Vec3d along = second_.place - first_.place;
    const double squared = dot(along, along);
    const double part = squared > 0 ? std::clamp(-dot(first_.place, along) / squared, 0.0, 1.0) : 0;
    overlap_all(edge_deviation_[0], length(first_.place + along * part));
    return true;
  }
  // The new vertex is the origin: what the corners of a triangle turn around it are, doubled, its
  // barycentric coordinates there. All new triangles have that corner, so all get the distance.
  const auto lay = [&](double deviation, Flat a, Vec3d at_a, Flat b, Vec3d at_b, Flat c,
                       Vec3d at_c) {
    const double wa = turn(b, c);
    const double wb = turn(c, a);
    const double wc = turn(a, b);
    const double sum = wa + wb + wc;
    if (wa < 0 || wb < 0 || wc < 0 || !(sum > 0))
      return false;
    overlap_all(deviation, length((at_a * wa + at_b * wb + at_c * wc) * (1 / sum)));
    return true;
  };
  const End& a = first_;
  const End& b = second_;
  if (lay(edge_deviation_[1], a.flat, a.place, flat_[turn_], ring_[turn_], b.flat, b.place) ||
      lay(edge_deviation_[0], a.flat, a.place, b.flat, b.place, flat_[0], ring_[0]))
    return true;
  for (std::uint32_t i = 0; i < size_; ++i) {
    const End& end = i < turn_ ? a : b;
    if (lay(deviation_[i], end.flat, end.place, flat_[i], ring_[i], flat_[i + 1], ring_[i + 1]))
      return true;
  }
  return false;
}

/// Visits the other corners: the edge's ends, and all crossings.
void FanGapMeter::lay_edges() {
  // An old edge brings the larger deviation of the triangles on its two sides: both cross there.
  const auto beside = [&](std::uint32_t i, std::uint32_t begin, std::uint32_t until,
                          double at_begin, double at_end) {
    return std::max(i == begin ? at_begin : deviation_[i - 1], i == until ? at_end : deviation_[i]);
  };
  const bool closed = shape_ == Shape::closed;
  overlap(first_.sector, first_.deviation, length(first_.place - first_.image));
  // At the edge a border has a triangle on one side only, edge_triangles_[0], which is at r[turn].
  const double first_edge = shape_ == Shape::border_edge ? 0 : edge_deviation_[0];
  const double last_edge = shape_ == Shape::border_edge ? edge_deviation_[0] : edge_deviation_[1];
  // Along the border the old edge to r[0] lies on a ray and crosses none.
  const std::uint32_t begin = shape_ == Shape::border_edge ? 1 : head_;
  for (std::uint32_t i = begin; i <= turn_; ++i)
    cross_rays(first_, i, beside(i, head_, turn_, first_edge, last_edge));
  if (shape_ == Shape::border_end)
    return;  // all other old edges start at the new vertex, as all rays do
  overlap(second_.sector, second_.deviation, length(second_.place - second_.image));
  for (std::uint32_t i = turn_; i < size_; ++i)
    cross_rays(second_, i, beside(i, turn_, size_, last_edge, first_edge));
  if (closed) {
    cross_rays(second_, 0, std::max(deviation_[size_ - 1], edge_deviation_[0]));
    cross_between_ends();
  }
}

std::optional<DiscGap> FanGapMeter::measure(std::span<const Vec3f> positions,
                                            std::span<const float> deviations,
                                            const StarCollapse& collapse) {
  Links links;
  if (!collect_links(collapse, links) || !order_links(std::span(links).first(size_)) ||
      !find_shape(collapse) || !unfold(positions, collapse) || !lay_ends(positions, collapse))
    return std::nullopt;
  look_up(deviations);
  if (!lay_middle())
    return std::nullopt;
  lay_edges();
  DiscGap result;
  for (std::uint32_t i = 0; i < size_; ++i) {
    // A point of the new triangle is at most gap_ from a point of an old one, whose deviation is at
    // most fresh_.
    const double deviation = fresh_[i] + gap_[i] + kFanRounding * radius_;
    // The cast may round down, by at most 2^-24 of the number: made larger first, it stays a bound.
    deviations_[i] = static_cast<float>(deviation * (1 + 0x1p-22));
    if (!std::isfinite(deviations_[i]))
      return std::nullopt;
  }
  const auto distance = [](const End& end) {
    return static_cast<float>(length(end.place - end.image));
  };
  const bool first_is_from = first_.vertex == collapse.from;
  result.from = distance(first_is_from ? first_ : second_);
  result.to = distance(first_is_from ? second_ : first_);
  result.triangles = {triangles_.data(), size_};
  result.deviations = {deviations_.data(), size_};
  return result;
}

}  // namespace meshhier::cluster_simplify
