#include "drawing/line_store.h"

#include "base/error.h"

#include <algorithm>

namespace meshhier::drawing {
namespace {

constexpr std::uint64_t kStretchBytes = 32;
constexpr std::size_t kSpoolBytes = std::size_t{1} << 20;
constexpr std::size_t kReadPoints = 4096;

}  // namespace

LineStore::LineStore(storage::ScratchFile& scratch, std::uint64_t memory_bytes,
                     const execution::CancelToken& cancel)
    : cancel_(cancel),
      most_stretches_(
          std::min<std::uint64_t>(memory_bytes / 2 / kStretchBytes, LineChains::kNone / 2)),
      points_(scratch, kSpoolBytes),
      ends_(scratch, memory_bytes / 2) {}

void LineStore::add(const TileLines& lines) {
  if (stretches_.size() + lines.stretches.size() > most_stretches_) {
    throw Error(
        ErrorCode::budget,
        "the lines cross the borders of tiles so often that joining them exceeds the memory "
        "budget: give more, or fewer heights, a smaller --box or a larger --error");
  }
  std::uint64_t first = points_.size();
  for (const TileStretch& stretch : lines.stretches) {
    const auto begin = static_cast<std::uint32_t>(2 * stretches_.size());
    if (!stretch.is_closed) {
      ends_.add(End{stretch.level, begin, stretch.first});
      ends_.add(End{stretch.level, begin + 1, stretch.last});
    }
    stretches_.push_back({first, stretch.points, stretch.level});
    is_ring_.push_back(stretch.is_closed);
    first += stretch.points;
  }
  points_.append(lines.points);
}

void LineStore::pair_ends() {
  ends_.sort();
  std::vector<std::uint32_t> met;
  End last;
  const auto settle = [&] {
    chains_->meet(met);
    met.clear();
  };
  ends_.for_each_block([&](std::span<const End> block) {
    cancel_.check();
    for (const End& end : block) {
      if (PointOf()(end) != PointOf()(last))
        settle();
      met.push_back(end.end);
      last = end;
    }
  });
  settle();
}

void LineStore::join() {
  chains_.emplace(stretches_.size());
  for (std::uint32_t i = 0; i < stretches_.size(); ++i) {
    if (is_ring_[i])
      chains_->meet(std::array{2 * i, 2 * i + 1});
  }
  pair_ends();
  chains_->for_each_chain([&](std::uint32_t entry, bool) {
    heads_.push_back({stretches_[entry / 2].level, entry});
  });
  std::ranges::stable_sort(heads_, {}, &Head::level);
}

/// Of points that follow each other and are equal the first is visited.
template <class Visit>
void LineStore::for_each_point(const Head& head, const Visit& visit) const {
  std::vector<Vec3d> points;
  std::optional<Vec3d> last;
  const auto pass = [&](Vec3d point) {
    if (point != last)
      visit(point);
    last = point;
  };
  chains_->for_each_stretch(head.entry, [&](std::uint32_t entry) {
    const Stretch& stretch = stretches_[entry / 2];
    for (std::uint32_t done = 0; done < stretch.points;) {
      cancel_.check();
      const auto count =
          static_cast<std::uint32_t>(std::min<std::size_t>(kReadPoints, stretch.points - done));
      const bool is_backwards = entry % 2 == 1;
      const std::uint32_t from = is_backwards ? stretch.points - done - count : done;
      points.resize(count);
      points_.read(stretch.first + from, points);
      if (is_backwards)
        std::ranges::reverse(points);
      std::ranges::for_each(points, pass);
      done += count;
    }
  });
}

JoinedLine LineStore::measured(const Head& head) const {
  JoinedLine line{.level = head.level,
                  .is_closed = chains_->other(head.entry) != LineChains::kNone};
  Vec3d first{}, last{};
  for_each_point(head, [&](Vec3d point) {
    line.length += line.points > 0 ? length(point - last) : 0;
    if (line.points++ == 0)
      first = point;
    last = point;
  });
  if (line.is_closed && line.points > 1 && first == last)
    --line.points;
  else if (line.is_closed)
    line.length += length(first - last);
  return line;
}

void LineStore::for_each_line(LineSink& sink) const {
  for (const Head& head : heads_) {
    const JoinedLine line = measured(head);
    if (line.points < 2)
      continue;
    sink.begin(line);
    std::uint64_t given = 0;
    for_each_point(head, [&](Vec3d point) {
      if (given++ < line.points)
        sink.point(point);
    });
    sink.end();
  }
}

}  // namespace meshhier::drawing
