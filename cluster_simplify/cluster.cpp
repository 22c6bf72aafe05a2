#include "cluster_simplify/cluster.h"

#include "cluster_simplify/kd_cells.h"
#include "cluster_simplify/motion.h"
#include "cluster_simplify/quadric.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace meshhier::cluster_simplify {
namespace {

// Pull towards the mean as a part of the quadric's curvature: small enough to keep sharp features,
// large enough that noise on flat ground does not throw points sideways.
constexpr double kMeanPull = 1e-3;

/// Weighted means of positions and attributes, one per cell, over the original vertices.
struct CellMeans {
  std::vector<Vec3d> positions;
  std::vector<double> attributes;
};

CellMeans means_of(const BuildTile& joined, const std::vector<std::uint32_t>& cell_of,
                   std::uint32_t cell_count, const AttributeRules& rules) {
  const auto channels = static_cast<std::size_t>(joined.mesh.vertices.channels);
  CellMeans means{std::vector<Vec3d>(cell_count), std::vector<double>(cell_count * channels)};
  std::vector<double> weights(cell_count);
  for (std::size_t i = 0; i < cell_of.size(); ++i) {
    const double weight = joined.history.weights[i];
    const std::uint32_t cell = cell_of[i];
    weights[cell] += weight;
    means.positions[cell] =
        means.positions[cell] + to_double(joined.mesh.vertices.positions[i]) * weight;
    const auto values = joined.mesh.vertices.attributes_of(i);
    for (std::size_t k = 0; k < channels; ++k)
      means.attributes[cell * channels + k] += weight * rules.summand(k, values[k]);
  }
  for (std::uint32_t cell = 0; cell < cell_count; ++cell) {
    means.positions[cell] = means.positions[cell] * (1 / weights[cell]);
    for (std::size_t k = 0; k < channels; ++k)
      means.attributes[cell * channels + k] /= weights[cell];
  }
  return means;
}

/// Each cell's quadric relative to its mean: a triangle counts once in every cell it touches.
std::vector<Quadric> quadrics_of(const BuildTile& joined, const std::vector<std::uint32_t>& cell_of,
                                 const std::vector<Vec3d>& means) {
  constexpr std::uint32_t kNoCell = std::numeric_limits<std::uint32_t>::max();
  std::vector<Quadric> quadrics(means.size());
  const TileMesh& mesh = joined.mesh;
  const auto add = [&](const TileTriangle& t) {
    std::array<Vec3d, 3> p;
    std::array<std::uint32_t, 3> cell;
    for (int k = 0; k < 3; ++k) {
      p[k] = to_double(mesh.vertices.positions[raw(t[k])]);
      cell[k] = mesh.is_own(t[k]) ? cell_of[raw(t[k])] : kNoCell;
    }
    const Vec3d doubled = cross(p[1] - p[0], p[2] - p[0]);
    const double doubled_area = length(doubled);
    if (!(doubled_area > 0))
      return;
    const Vec3d normal = doubled * (1 / doubled_area);
    for (int k = 0; k < 3; ++k) {
      const bool repeated = (k > 0 && cell[k] == cell[0]) || (k > 1 && cell[k] == cell[1]);
      if (cell[k] != kNoCell && !repeated)
        quadrics[cell[k]].add_plane(normal, doubled_area / 2, p[0] - means[cell[k]]);
    }
  };
  for (const TileTriangle& t : mesh.interior)
    add(t);
  for (const TileTriangle& t : mesh.border)
    add(t);
  return quadrics;
}

std::vector<Vec3d> least_error_points(const BuildTile& joined,
                                      const std::vector<std::uint32_t>& cell_of,
                                      const std::vector<Vec3d>& means) {
  std::vector<double> radii(means.size());
  for (std::size_t i = 0; i < cell_of.size(); ++i) {
    const double distance =
        length(to_double(joined.mesh.vertices.positions[i]) - means[cell_of[i]]);
    radii[cell_of[i]] = std::max(radii[cell_of[i]], distance);
  }
  const std::vector<Quadric> quadrics = quadrics_of(joined, cell_of, means);
  std::vector<Vec3d> points(means.size());
  for (std::size_t cell = 0; cell < means.size(); ++cell) {
    const Vec3d offset = quadrics[cell].minimum({}, kMeanPull);
    const double size = length(offset);
    points[cell] = means[cell] + (size > radii[cell] ? offset * (radii[cell] / size) : offset);
  }
  return points;
}

std::vector<Vec3d> least_error_vertices(const BuildTile& joined,
                                        const std::vector<std::uint32_t>& cell_of,
                                        const std::vector<Vec3d>& means) {
  const std::vector<Quadric> quadrics = quadrics_of(joined, cell_of, means);
  std::vector<double> best(means.size(), std::numeric_limits<double>::infinity());
  std::vector<Vec3d> points(means.size());
  for (std::size_t i = 0; i < cell_of.size(); ++i) {
    const std::uint32_t cell = cell_of[i];
    const Vec3d position = to_double(joined.mesh.vertices.positions[i]);
    const Vec3d offset = position - means[cell];
    // Where planes do not decide, the vertex nearest to the mean wins, as in the regularized
    // minimum.
    const Quadric& q = quadrics[cell];
    const double planes = q.xx + q.yy + q.zz;
    const double error = planes > 0 ? q.at(offset) + kMeanPull * planes / 3 * dot(offset, offset)
                                    : dot(offset, offset);
    if (error < best[cell]) {
      best[cell] = error;
      points[cell] = position;
    }
  }
  return points;
}

/// Gives the representatives the means of values, likewise weighted.
void put_values(const BuildTile& joined, const ValueMixer& values, Contraction& contraction) {
  if (!values.has_values())
    return;
  std::vector<std::vector<WeightedVertex>> cells(contraction.representatives.size());
  for (std::size_t i = 0; i < contraction.parent_of.size(); ++i)
    cells[contraction.parent_of[i]].push_back(
        {joined.mesh.vertices.attributes_of(i).data(), joined.history.weights[i]});
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    values.mix(cells[cell],
               contraction.representatives.attributes.data() +
                   cell * static_cast<std::size_t>(contraction.representatives.channels));
  }
}

}  // namespace

Contraction cluster(const BuildTile& joined, std::uint32_t target, const AttributeRules& rules,
                    Representative representative) {
  Contraction result;
  result.parent_of =
      kd_cells({joined.mesh.vertices.positions.data(), joined.mesh.own_count}, target);
  const CellMeans means = means_of(joined, result.parent_of, target, rules);
  std::vector<Vec3d> points;
  switch (representative) {
    case Representative::mean:
      points = means.positions;
      break;
    case Representative::quadric:
      points = least_error_points(joined, result.parent_of, means.positions);
      break;
    case Representative::vertex:
      points = least_error_vertices(joined, result.parent_of, means.positions);
      break;
  }
  const auto channels = static_cast<std::size_t>(joined.mesh.vertices.channels);
  result.representatives.channels = joined.mesh.vertices.channels;
  result.representatives.reserve(target);
  std::vector<float> attributes(channels);
  for (std::uint32_t cell = 0; cell < target; ++cell) {
    for (std::size_t k = 0; k < channels; ++k)
      attributes[k] = static_cast<float>(rules.number(k, means.attributes[cell * channels + k]));
    rules.normalize(attributes);
    result.representatives.append(to_float(points[cell]), attributes);
  }
  put_values(joined, rules.values(), result);
  result.deviation = motion_of(joined, result);
  return result;
}

}  // namespace meshhier::cluster_simplify
