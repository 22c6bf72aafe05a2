#include "cluster_simplify/representatives.h"

#include "cluster_simplify/kd_cells.h"
#include "cluster_simplify/nearest.h"

#include <limits>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

constexpr std::uint32_t kNone = CollapseMesh::kNone;

std::vector<Vec3f> positions_of(const VertexArray& vertices,
                                const std::vector<std::uint32_t>& chosen) {
  std::vector<Vec3f> positions;
  positions.reserve(chosen.size());
  for (const std::uint32_t v : chosen)
    positions.push_back(vertices.positions[v]);
  return positions;
}

/// For each of `group` the one of its cell that is nearest to the cell's mean.
std::vector<std::uint32_t> join_neighbours(const VertexArray& vertices,
                                           const std::vector<std::uint32_t>& group,
                                           std::uint32_t cell_count) {
  const std::vector<Vec3f> positions = positions_of(vertices, group);
  const std::vector<std::uint32_t> cell_of = kd_cells(positions, cell_count);
  std::vector<Vec3d> means(cell_count);
  std::vector<double> counts(cell_count);
  for (std::size_t i = 0; i < group.size(); ++i) {
    means[cell_of[i]] = means[cell_of[i]] + to_double(positions[i]);
    ++counts[cell_of[i]];
  }
  std::vector<std::uint32_t> best(cell_count, kNone);
  std::vector<double> least(cell_count, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < group.size(); ++i) {
    const std::uint32_t cell = cell_of[i];
    const Vec3d offset = to_double(positions[i]) - means[cell] * (1 / counts[cell]);
    if (best[cell] == kNone || dot(offset, offset) < least[cell]) {
      best[cell] = group[i];
      least[cell] = dot(offset, offset);
    }
  }
  std::vector<std::uint32_t> into(group.size());
  for (std::size_t i = 0; i < group.size(); ++i)
    into[i] = best[cell_of[i]];
  return into;
}

}  // namespace

Contraction choose_representatives(CollapseMesh& mesh, const VertexArray& vertices,
                                   std::uint32_t target) {
  std::vector<std::uint32_t> shown;
  std::vector<std::uint32_t> isolated;
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    if (mesh.representative(v) == v)
      (mesh.is_isolated(v) ? isolated : shown).push_back(v);
  }
  std::vector<std::uint32_t> into(mesh.own_count(), kNone);
  const auto absorb = [&](const std::vector<std::uint32_t>& group,
                          const std::vector<std::uint32_t>& targets) {
    for (std::size_t i = 0; i < group.size(); ++i)
      into[group[i]] = targets[i];
  };
  Contraction result;
  if (shown.size() > target) {
    result.fallbacks.joined = static_cast<std::uint32_t>(shown.size()) - target;
    absorb(shown, join_neighbours(vertices, shown, target));
  } else {
    absorb(shown, shown);
  }
  const std::uint32_t room = target - std::min(target, static_cast<std::uint32_t>(shown.size()));
  if (!isolated.empty()) {
    std::vector<std::uint32_t> kept;
    if (room > 0)
      kept = join_neighbours(vertices, isolated, room);
    std::vector<std::uint32_t> around = shown;
    around.insert(around.end(), kept.begin(), kept.end());
    absorb(isolated, nearest_of(vertices.positions, around, isolated));
    absorb(kept, kept);  // whatever lies at the same point
  }

  std::vector<std::uint32_t> number(mesh.own_count(), kNone);
  result.representatives.channels = vertices.channels;
  result.representatives.reserve(target);
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    if (into[v] != v)
      continue;
    number[v] = static_cast<std::uint32_t>(result.representatives.size());
    result.representatives.append(vertices, v, v + 1);
  }
  result.parent_of.resize(mesh.own_count());
  for (std::uint32_t v = 0; v < mesh.own_count(); ++v) {
    // An isolated vertex may have gone into a shown one that was then joined with another.
    std::uint32_t root = into[mesh.representative(v)];
    root = into[root];
    result.parent_of[v] = number[root];
  }
  return result;
}

}  // namespace meshhier::cluster_simplify
