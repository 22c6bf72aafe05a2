#include "bench/comparison.h"

#include "bench/cell_mesh.h"
#include "bench/partitioners.h"
#include "cluster_simplify/kd_cells.h"
#include "hierarchy/bounds.h"
#include "hierarchy/error.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

using cluster_simplify::Representative;

/// What `make` returns, and the CPU time it took.
template <class Make>
auto timed(double& seconds, const Make& make) {
  const std::clock_t start = std::clock();
  auto result = make();
  seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return result;
}

void add_row(Comparison& comparison, std::string name, const PlainMesh& mesh, const Parts& parts,
             double seconds) {
  comparison.partitions.push_back({std::move(name), measure_parts(mesh, parts), seconds});
}

void compare_partitions(const PlainMesh& mesh, const ComparisonOptions& options,
                        storage::FileSystem& files, Comparison& comparison) {
  const auto kd = [&](const char* name, partition::Axis axis) {
    double seconds = 0;
    const Parts parts = timed(seconds, [&] { return kd_parts(mesh, options.parts, axis, files); });
    add_row(comparison, name, mesh, parts, seconds);
  };
  kd("kd-tree, longest axis", partition::Axis::longest);
  kd("kd-tree, compactness", partition::Axis::compactness);
  double seconds = 0;
  const Parts octree = timed(seconds, [&] { return octree_parts(mesh.positions, options.parts); });
  add_row(comparison, "octree", mesh, octree, seconds);
  const KMeansParts kmeans = timed(seconds, [&] {
    return kmeans_parts(mesh.positions, options.parts, options.kmeans_iterations);
  });
  add_row(comparison, "k-means", mesh, kmeans.parts, seconds);
  comparison.kmeans_iterations = kmeans.iterations;
}

SimplificationRow simplify(const PlainMesh& mesh, const SearchableSurface& surface,
                           const Parts& cells, Representative representative,
                           const ComparisonOptions& options) {
  const PlainMesh simplified = cell_mesh(mesh, cells, representative);
  if (simplified.triangles.empty()) {
    throw Error(ErrorCode::input, fmt::format("no triangle is left of {} when {} cells become "
                                              "vertices: cells of fewer vertices are needed",
                                              mesh.triangles.size(), cells.count));
  }
  SimplificationRow row;
  row.representative = representative == Representative::mean ? "mean" : "least quadric error";
  row.vertices = simplified.positions.size();
  row.triangles = simplified.triangles.size();
  row.forward = SearchableSurface(simplified).distances_from(mesh, options.samples);
  row.backward = surface.distances_from(simplified, options.samples);
  return row;
}

void compare_simplifications(const PlainMesh& mesh, const ComparisonOptions& options,
                             storage::FileSystem& files, Comparison& comparison) {
  const auto vertices = static_cast<double>(mesh.positions.size());
  const auto asked = static_cast<std::uint32_t>(
      std::clamp(std::round(vertices / options.cell_vertices), 1.0, vertices));
  const Parts octree = octree_parts(mesh.positions, asked);
  const Parts kd{cluster_simplify::kd_cells(mesh.positions, octree.count), octree.count};
  const Parts compact = kd_parts(mesh, octree.count, partition::Axis::compactness, files);
  const SearchableSurface surface(mesh);
  for (const Representative how : {Representative::mean, Representative::quadric}) {
    const auto add = [&](const char* name, const Parts& cells) {
      SimplificationRow row = simplify(mesh, surface, cells, how, options);
      row.cells = name;
      comparison.simplifications.push_back(std::move(row));
    };
    add("kd-tree, longest axis", kd);
    add("kd-tree, compactness", compact);
    add("octree", octree);
  }
}

/// Distances are told in parts of the diagonal times this, as is common.
constexpr double kDiagonalParts = 1e4;

std::string thousands(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3)
    text.insert(at - 3, 1, ',');
  return text;
}

std::string markdown(const PartitionRow& row) {
  const PartFigures& f = row.figures;
  return fmt::format("| {} | {} | {} | {:.1f} | {} | {:.3f} | {:.3f} | {:.2f} |\n", row.name,
                     f.count, thousands(f.least_vertices), f.mean_vertices,
                     thousands(f.most_vertices), f.mean_compactness, f.median_compactness,
                     row.cpu_seconds);
}

std::string markdown(const SimplificationRow& row, double diagonal) {
  const double scale = diagonal > 0 ? kDiagonalParts / diagonal : 0;
  return fmt::format(
      "| {} | {} | {} | {} | {:.4g} | {:.4g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} |\n", row.cells,
      row.representative, thousands(row.vertices), thousands(row.triangles), row.forward.mean,
      row.backward.mean, row.forward.mean * scale, row.backward.mean * scale,
      row.forward.max * scale, row.backward.max * scale);
}

}  // namespace

Comparison compare(const PlainMesh& mesh, const ComparisonOptions& options,
                   storage::FileSystem& files) {
  check_part_count(mesh.positions.size(), options.parts);
  Comparison comparison;
  comparison.vertices = mesh.positions.size();
  comparison.triangles = mesh.triangles.size();
  comparison.diagonal = diagonal(bounds_of(mesh.positions));
  compare_partitions(mesh, options, files, comparison);
  compare_simplifications(mesh, options, files, comparison);
  return comparison;
}

std::string markdown(const std::string& name, const Comparison& comparison) {
  std::string text = fmt::format("### {}: {} vertices, {} triangles\n\n", name,
                                 thousands(comparison.vertices), thousands(comparison.triangles));
  text +=
      "| partitions | parts | vertices, least | mean | most | compactness, mean | median | CPU s "
      "|\n|---|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const PartitionRow& row : comparison.partitions)
    text += markdown(row);
  text += fmt::format("\nk-means: {} iterations.\n", comparison.kmeans_iterations);
  text +=
      "\n| cells | representative | vertices | triangles | mean, forward | mean, backward "
      "| forward, 1e-4 diagonal | backward | max, forward | max, backward "
      "|\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const SimplificationRow& row : comparison.simplifications)
    text += markdown(row, comparison.diagonal);
  return text;
}

}  // namespace meshhier::bench
