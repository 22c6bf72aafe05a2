#include "texture/chart_growing.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace meshhier::texture {
namespace {

/// The surroundings of a triangle turn from its chart's normal by at most 46 degrees, itself by 66.
constexpr double kLeastSmooth = 0.7;
constexpr double kLeastOwn = 0.4;
/// How many rings of neighbours the surroundings are.
constexpr int kRings = 5;

std::vector<Vec3d> smooth_normals(const Faces& faces) {
  const auto count = static_cast<std::uint32_t>(faces.normals.size());
  std::vector<Vec3d> smooth(count + 1), next(count + 1);  // the last is what lies across no edge
  for (std::size_t t = 0; t < count; ++t)
    smooth[t] = faces.normals[t] * faces.areas[t];
  for (int ring = 0; ring < kRings; ++ring) {
    for (std::size_t t = 0; t < count; ++t) {
      const auto across = [&](std::size_t k) {
        return smooth[std::min(faces.across[t][k], count)];
      };
      next[t] = smooth[t] + across(0) + across(1) + across(2);
    }
    smooth.swap(next);
  }
  smooth.pop_back();
  for (Vec3d& normal : smooth)
    normal = direction_of(normal);
  return smooth;
}

class Grower {
 public:
  explicit Grower(const Faces& faces)
      : faces_(faces), smooth_(smooth_normals(faces)), chart_of_(faces.normals.size(), kNoFace) {}

  SurfaceCharts operator()() && {
    for (std::uint32_t t = 0; t < chart_of_.size(); ++t) {
      if (chart_of_[t] == kNoFace)
        grow(t);
    }
    join_small();
    return collected();
  }

 private:
  bool may_have(const Vec3d& normal, std::uint32_t t) const {
    return faces_.areas[t] == 0 ||
           (dot(normal, smooth_[t]) >= kLeastSmooth && dot(normal, faces_.normals[t]) >= kLeastOwn);
  }

  void grow(std::uint32_t seed) {
    const auto chart = static_cast<std::uint32_t>(sums_.size());
    Vec3d sum = faces_.normals[seed] * faces_.areas[seed];
    Vec3d normal = dot(smooth_[seed], faces_.normals[seed]) >= kLeastOwn ? smooth_[seed]
                                                                         : faces_.normals[seed];
    queue_.assign(1, seed);
    chart_of_[seed] = chart;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      for (const std::uint32_t other : faces_.across[queue_[i]]) {
        if (other == kNoFace || chart_of_[other] != kNoFace || !may_have(normal, other))
          continue;
        chart_of_[other] = chart;
        queue_.push_back(other);
        sum = sum + faces_.normals[other] * faces_.areas[other];
        if (queue_.size() > kSteady)
          normal = direction_of(sum);
      }
    }
    sums_.push_back(sum);
    members_.push_back(queue_);
  }

  /// The charts across the edges of a chart, that with most edges first.
  std::vector<std::uint32_t> neighbours(std::uint32_t chart) const {
    std::vector<std::uint32_t> edges;
    for (const std::uint32_t t : members_[chart]) {
      for (const std::uint32_t other : faces_.across[t]) {
        if (other != kNoFace && chart_of_[other] != chart)
          edges.push_back(chart_of_[other]);
      }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<std::pair<std::size_t, std::uint32_t>> counted;
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
      while (end < edges.size() && edges[end] == edges[i])
        ++end;
      counted.push_back({end - i, edges[i]});
    }
    std::sort(counted.begin(), counted.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<std::uint32_t> charts;
    for (const auto& [count, other] : counted)
      charts.push_back(other);
    return charts;
  }

  bool may_join(std::uint32_t chart, std::uint32_t other) const {
    const Vec3d normal = direction_of(sums_[chart] + sums_[other]);
    return std::ranges::all_of(members_[chart], [&](std::uint32_t t) {
      return faces_.areas[t] == 0 || dot(normal, faces_.normals[t]) >= kLeastOwn;
    });
  }

  void join(std::uint32_t chart, std::uint32_t other) {
    for (const std::uint32_t t : members_[chart])
      chart_of_[t] = other;
    members_[other].insert(members_[other].end(), members_[chart].begin(), members_[chart].end());
    members_[chart].clear();
    sums_[other] = sums_[other] + sums_[chart];
  }

  /// The smallest first.
  void join_small() {
    std::vector<std::uint32_t> order;
    for (std::uint32_t c = 0; c < members_.size(); ++c) {
      if (members_[c].size() <= kSmall)
        order.push_back(c);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return members_[a].size() < members_[b].size();
    });
    for (const std::uint32_t chart : order) {
      if (members_[chart].size() > kSmall)
        continue;
      for (const std::uint32_t other : neighbours(chart)) {
        if (may_join(chart, other)) {
          join(chart, other);
          break;
        }
      }
    }
  }

  SurfaceCharts collected() const {
    SurfaceCharts charts;
    for (const std::vector<std::uint32_t>& members : members_) {
      if (members.empty())
        continue;
      charts.triangles.insert(charts.triangles.end(), members.begin(), members.end());
      charts.ends.push_back(static_cast<std::uint32_t>(charts.triangles.size()));
    }
    return charts;
  }

  /// Triangles after which the mean normal is steadier than the first one's.
  static constexpr std::size_t kSteady = 16;
  static constexpr std::size_t kSmall = 200;

  const Faces& faces_;
  std::vector<Vec3d> smooth_;
  std::vector<std::uint32_t> chart_of_;
  std::vector<Vec3d> sums_;  ///< of each chart's normals, by area
  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::uint32_t> queue_;
};

}  // namespace

SurfaceCharts grow_charts(const Faces& faces) {
  return Grower(faces)();
}

}  // namespace meshhier::texture
