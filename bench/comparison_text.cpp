// A comparison as text: Markdown and JSON.
#include "bench/comparison.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::bench {
namespace {

using Json = nlohmann::ordered_json;

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

Json json(const Distances& distances) {
  return {{"mean", distances.mean}, {"rms", distances.rms}, {"max", distances.max}};
}

Json json(const PartitionRow& row) {
  const PartFigures& f = row.figures;
  return {{"name", row.name},
          {"parts", f.count},
          {"vertices",
           {{"min", f.least_vertices}, {"mean", f.mean_vertices}, {"max", f.most_vertices}}},
          {"compactness",
           {{"mean", f.mean_compactness},
            {"median", f.median_compactness},
            {"parts_without_area", f.without_area}}},
          {"cpu_seconds", row.cpu_seconds}};
}

Json json(const SimplificationRow& row) {
  return {{"cells", row.cells},           {"representative", row.representative},
          {"vertices", row.vertices},     {"triangles", row.triangles},
          {"forward", json(row.forward)}, {"backward", json(row.backward)}};
}

}  // namespace

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

std::string json(const std::string& name, const Comparison& comparison) {
  Json object{{"name", name},
              {"vertices", comparison.vertices},
              {"triangles", comparison.triangles},
              {"diagonal", comparison.diagonal},
              {"kmeans_iterations", comparison.kmeans_iterations},
              {"partitions", Json::array()},
              {"simplifications", Json::array()}};
  for (const PartitionRow& row : comparison.partitions)
    object["partitions"].push_back(json(row));
  for (const SimplificationRow& row : comparison.simplifications)
    object["simplifications"].push_back(json(row));
  return object.dump(2);
}

}  // namespace meshhier::bench
