#include "compare/object_distances.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace meshhier::comparing {
namespace {

void add_corner(DistanceSums& sums, double distance, double weight, bool is_first) {
  sums.least = is_first ? distance : std::min(sums.least, distance);
  sums.largest = is_first ? distance : std::max(sums.largest, distance);
  sums.area += weight;
  sums.sum += weight * distance;
  sums.sum_of_sizes += weight * std::abs(distance);
  sums.sum_of_squares += weight * distance * distance;
}

void join(DistanceSums& sums, const DistanceSums& more) {
  sums.least = std::min(sums.least, more.least);
  sums.largest = std::max(sums.largest, more.largest);
  sums.area += more.area;
  sums.sum += more.sum;
  sums.sum_of_sizes += more.sum_of_sizes;
  sums.sum_of_squares += more.sum_of_squares;
}

bool is_farther(const ObjectDistance& a, const ObjectDistance& b) {
  const double x = a.distances.farthest(), y = b.distances.farthest();
  return x != y ? x > y : a.object < b.object;
}

Vec3d middle_of(const BoundsD& box) {
  return (box.min + box.max) * 0.5;
}

void note(LoneObjects& side, const std::string& name, std::size_t most) {
  ++side.lone;
  if (side.names.size() < most)
    side.names.push_back(name);
}

/// Finds the names that one of two tables has alone; both ascend.
void find_lone(const storage::ObjectTable& from, const storage::ObjectTable& to, std::size_t most,
               LoneObjects& of_from, LoneObjects& of_to, const execution::CancelToken& cancel) {
  std::uint32_t i = 0, j = 0;
  while (i < from.size() || j < to.size()) {
    cancel.check();
    const std::string a = i < from.size() ? from.row(i).name : "";
    const std::string b = j < to.size() ? to.row(j).name : "";
    const bool is_from = j == to.size() || (i < from.size() && a < b);
    const bool is_to = i == from.size() || (j < to.size() && b < a);
    if (is_from)
      note(of_from, a, most);
    else if (is_to)
      note(of_to, b, most);
    i += is_to ? 0 : 1;
    j += is_from ? 0 : 1;
  }
}

}  // namespace

double DistanceSums::rms() const {
  return area > 0 ? std::sqrt(sum_of_squares / area) : 0;
}

double DistanceSums::farthest() const {
  return std::max(std::abs(least), std::abs(largest));
}

void ObjectDistances::add(std::uint32_t position, const PlacedTile& tile,
                          std::span<const Vec3d> points, std::span<const double> distances) {
  std::map<std::uint32_t, DistanceSums> all;
  for (std::size_t i = 0; i < tile.triangles.size(); ++i) {
    const Triangle<std::uint32_t>& t = tile.triangles[i];
    const Vec3d a = points[t[0]], b = points[t[1]], c = points[t[2]];
    const double third = length(cross(b - a, c - a)) / 6;
    auto [found, is_first] = all.try_emplace(tile.facts.objects[i]);
    for (const std::uint32_t corner : t) {
      add_corner(found->second, distances[corner], third, is_first);
      is_first = false;
    }
  }
  for (const auto& [object, sums] : all)
    sums_.add(ObjectTileSums{object, position, sums});
}

std::vector<ObjectDistance> ObjectDistances::farthest(std::size_t most, std::uint32_t& compared) {
  std::vector<ObjectDistance> kept;  // a heap, the nearest of them first
  std::optional<ObjectDistance> now;
  const auto end_object = [&] {
    if (!now)
      return;
    ++compared;
    kept.push_back(std::move(*now));
    std::ranges::push_heap(kept, is_farther);
    if (kept.size() > most) {
      std::ranges::pop_heap(kept, is_farther);
      kept.pop_back();
    }
  };
  sums_.sort();
  sums_.for_each_block([&](std::span<const ObjectTileSums> block) {
    for (const ObjectTileSums& sums : block) {
      if (now && now->object == sums.object) {
        join(now->distances, sums.distances);
        continue;
      }
      end_object();
      now = ObjectDistance{.object = sums.object, .distances = sums.distances};
    }
  });
  end_object();
  std::ranges::sort_heap(kept, is_farther);
  return kept;
}

ObjectComparison ObjectDistances::finish(const storage::ObjectTable& from,
                                         const storage::ObjectTable* to,
                                         const std::optional<PlaceTransform>& transform,
                                         std::size_t most, const execution::CancelToken& cancel) {
  ObjectComparison found;
  found.from.objects = from.size();
  found.farthest = farthest(most, found.compared);
  if (to != nullptr) {
    found.to.emplace().objects = to->size();
    find_lone(from, *to, most, found.from, *found.to, cancel);
  }
  for (ObjectDistance& one : found.farthest) {
    const ObjectRow row = one.object < from.size() ? from.row(one.object) : ObjectRow{};
    one.name = row.name;
    const auto other = to != nullptr ? to->find(row.name) : std::nullopt;
    if (!other)
      continue;
    const ObjectRow there = to->row(*other);
    one.other_area = there.area;
    if (row.box && there.box)
      one.moved = length(middle_of(*there.box) - moved(transform, middle_of(*row.box)));
  }
  return found;
}

}  // namespace meshhier::comparing
