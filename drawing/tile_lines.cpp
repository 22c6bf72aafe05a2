#include "drawing/tile_lines.h"

#include "drawing/line_chains.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <numeric>
#include <tuple>

namespace meshhier::drawing {
namespace {

/// Returns a coordinate's bits, ordered as the numbers are; both zeros are one.
std::uint32_t ordered_bits(float coordinate) {
  const auto bits = std::bit_cast<std::uint32_t>(coordinate + 0.0F);
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
}

std::array<std::uint32_t, 3> place_bits(Vec3f p) {
  return {ordered_bits(p.x), ordered_bits(p.y), ordered_bits(p.z)};
}

/// The places of a tile's vertices: those with equal coordinates have one number, in the order of
/// coordinates.
std::vector<std::uint32_t> place_numbers(const std::vector<Vec3f>& positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) { return place_bits(positions[v]); };
  std::ranges::sort(order, {}, key);
  std::vector<std::uint32_t> numbers(positions.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::uint32_t before = order[i - 1];
    numbers[order[i]] = numbers[before] + (key(before) == key(order[i]) ? 0 : 1);
  }
  return numbers;
}

struct Segment {
  std::uint32_t level = 0;
  std::array<PassedEdge, 2> edges{};  ///< where it begins and ends
};

/// An end of a segment, by what it has in common with those that meet it.
struct SegmentEnd {
  std::uint64_t edge = 0;
  std::uint32_t level = 0;
  std::uint32_t end = 0;

  auto point() const { return std::tuple(level, edge); }
  friend bool operator<(const SegmentEnd& a, const SegmentEnd& b) {
    return std::tuple(a.level, a.edge, a.end) < std::tuple(b.level, b.edge, b.end);
  }
};

class TileJoiner {
 public:
  TileJoiner(const SlicedPart& part, const CutLevels& levels)
      : part_(part), levels_(levels), places_(place_numbers(part.part().vertices.positions)) {
    part.for_each_segment(levels,
                          [&](std::uint32_t level, const PassedEdge& down, const PassedEdge& up) {
                            if (key_of(down) != key_of(up))  // else two corners are one place
                              segments_.push_back({level, {down, up}});
                          });
  }

  TileLines lines() {
    const LineChains chains = joined();
    TileLines made;
    chains.for_each_chain([&](std::uint32_t entry, bool is_closed) {
      const Segment& first = segments_[entry / 2];
      std::vector<Vec3d> points{point(first.level, first.edges[entry % 2])};
      std::uint32_t last = entry;
      chains.for_each_stretch(entry, [&](std::uint32_t at) {
        last = at ^ 1;
        const Vec3d next = point(first.level, segments_[last / 2].edges[last % 2]);
        if (next != points.back())
          points.push_back(next);
      });
      if (is_closed && points.size() > 1 && points.back() == points.front())
        points.pop_back();
      if (is_closed && points.size() == 1)
        return;  // all around a corner that is on the level
      made.stretches.push_back({first.level, static_cast<std::uint32_t>(points.size()), is_closed,
                                name_of(first.edges[entry % 2]),
                                name_of(segments_[last / 2].edges[last % 2])});
      made.points.insert(made.points.end(), points.begin(), points.end());
    });
    return made;
  }

 private:
  LineChains joined() const {
    std::vector<SegmentEnd> ends;
    ends.reserve(2 * segments_.size());
    for (std::uint32_t end = 0; end < 2 * segments_.size(); ++end) {
      const Segment& segment = segments_[end / 2];
      ends.push_back({key_of(segment.edges[end % 2]), segment.level, end});
    }
    std::ranges::sort(ends, std::less{});
    LineChains chains(segments_.size());
    std::vector<std::uint32_t> met;
    for (std::size_t i = 0; i < ends.size(); i += met.size()) {
      met.clear();
      for (std::size_t k = i; k < ends.size() && ends[k].point() == ends[i].point(); ++k)
        met.push_back(ends[k].end);
      chains.meet(met);
    }
    return chains;
  }

  std::uint64_t key_of(const PassedEdge& edge) const {
    const auto [low, high] = std::minmax(places_[edge.below], places_[edge.above]);
    return std::uint64_t{low} << 32 | high;
  }

  EdgeName name_of(const PassedEdge& edge) const {
    const std::vector<Vec3f>& positions = part_.part().vertices.positions;
    const auto a = place_bits(positions[edge.below]), b = place_bits(positions[edge.above]);
    const auto& [low, high] = std::minmax(a, b);
    EdgeName name;
    std::ranges::copy(low, name.bits.begin());
    std::ranges::copy(high, name.bits.begin() + 3);
    return name;
  }

  Vec3d point(std::uint32_t level, const PassedEdge& edge) const {
    return part_.point_at(edge, levels_[level].height);
  }

  const SlicedPart& part_;
  const CutLevels& levels_;
  std::vector<std::uint32_t> places_;
  std::vector<Segment> segments_;
};

}  // namespace

TileLines tile_lines(const SlicedPart& part, const CutLevels& levels) {
  return TileJoiner(part, levels).lines();
}

}  // namespace meshhier::drawing
