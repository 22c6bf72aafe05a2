// Tells a comparison in words.
#include "base/plain_text.h"
#include "compare/compare.h"
#include "compare/difference_ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::comparing {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kParts{0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99};
constexpr std::array kSizeParts{0.5, 0.9, 0.95, 0.99};
/// The part of the surface that lies beyond each end of the histogram.
constexpr double kBeyond = 0.005;
constexpr std::size_t kTextBins = 15;
constexpr std::size_t kJsonBins = 60;
constexpr std::size_t kBarWidth = 40;
constexpr std::size_t kShownNameBytes = 80;
/// Names of objects that one side has alone.
constexpr std::size_t kShownLone = 5;

struct Range {
  double from = 0, to = 0;
};

Range range_of(const DistanceTally& distances) {
  return {distances.quantile(kBeyond), distances.quantile(1 - kBeyond)};
}

std::string name_of_part(double part) {
  return fmt::format("{:g}", 100 * part);
}

std::string line_of(const ComparedSurface& surface) {
  std::string text =
      fmt::format("{}: {}, {}, {}", surface.name, counted(surface.tiles, "tiles"),
                  counted(surface.vertices, "vertices"), counted(surface.triangles, "triangles"));
  if (surface.error_bound > 0)
    text += fmt::format("; at most {:.6g} from its original", surface.error_bound);
  return text + "\n";
}

std::string histogram_text(const DistanceTally& distances) {
  const auto [from, to] = range_of(distances);
  if (!(to > from))
    return {};
  const std::vector<double> weights = distances.histogram(from, to, kTextBins);
  const double most = *std::ranges::max_element(weights);
  const double step = (to - from) / static_cast<double>(kTextBins);
  std::string text;
  for (std::size_t i = 0; i < kTextBins; ++i) {
    const auto bar = static_cast<std::size_t>(static_cast<double>(kBarWidth) * weights[i] / most);
    text +=
        fmt::format("  {:>12.5g} .. {:<12.5g} {:>6.2f} %  {}\n",
                    from + static_cast<double>(i) * step, from + static_cast<double>(i + 1) * step,
                    100 * weights[i] / distances.weight(), std::string(bar, '#'));
  }
  return text;
}

Json surface_json(const ComparedSurface& surface) {
  return {{"name", surface.name},
          {"tiles", surface.tiles},
          {"vertices", surface.vertices},
          {"triangles", surface.triangles},
          {"error_bound", surface.error_bound}};
}

Json histogram_json(const DistanceTally& distances) {
  const auto [from, to] = range_of(distances);
  return {{"from", from}, {"to", to}, {"areas", distances.histogram(from, to, kJsonBins)}};
}

Json distances_json(const DistanceTally& distances) {
  if (distances.empty())
    return {};
  Json parts = Json::object(), size_parts = Json::object();
  for (const double part : kParts)
    parts[name_of_part(part)] = distances.quantile(part);
  for (const double part : kSizeParts)
    size_parts[name_of_part(part)] = distances.size_quantile(part);
  return {{"mean", distances.mean()},       {"rms", distances.rms()},
          {"least", distances.least()},     {"largest", distances.largest()},
          {"percentiles", parts},           {"mean_size", distances.mean_size()},
          {"size_percentiles", size_parts}, {"histogram", histogram_json(distances)}};
}

std::string tolerance_text(const SurfaceComparison& comparison) {
  const DistanceTally& distances = comparison.distances;
  std::string text =
      fmt::format("{} the tolerance of {:.6g}", comparison.is_within() ? "within" : "NOT within",
                  *comparison.tolerance);
  if (!distances.empty()) {
    text += fmt::format(": {:.4f} % of the surface is",
                        100 * distances.weight_within() / distances.weight());
  }
  return text + "\n";
}

std::string lone_text(const LoneObjects& lone, std::string_view which) {
  if (lone.lone == 0)
    return {};
  std::string text = fmt::format("  {} only in the {} one: ", counted(lone.lone, "objects"), which);
  const std::size_t shown = std::min(lone.names.size(), kShownLone);
  for (std::size_t i = 0; i < shown; ++i)
    text += (i > 0 ? ", " : "") + plain_text(lone.names[i], kShownNameBytes);
  return text + (lone.lone > shown ? " and others\n" : "\n");
}

std::string objects_text(const ObjectComparison& objects) {
  std::string text =
      fmt::format("objects: {} of the first one compared, the farthest first\n", objects.compared);
  text += "      farthest         mean          rms         area        moved  name\n";
  for (const ObjectDistance& one : objects.farthest) {
    const DistanceSums& sums = one.distances;
    text +=
        fmt::format("  {:>12.6g} {:>12.6g} {:>12.6g} {:>12.6g} {:>12}  {}\n",
                    std::abs(sums.least) > sums.largest ? sums.least : sums.largest, sums.mean(),
                    sums.rms(), sums.area, one.moved ? fmt::format("{:.6g}", *one.moved) : "-",
                    one.name.empty() ? "-" : plain_text(one.name, kShownNameBytes));
  }
  text += lone_text(objects.from, "first");
  return text + (objects.to ? lone_text(*objects.to, "second") : "");
}

Json lone_json(const LoneObjects& lone) {
  return {{"objects", lone.objects}, {"lone", lone.lone}, {"lone_names", lone.names}};
}

Json objects_json(const ObjectComparison& objects) {
  Json json{{"compared", objects.compared}, {"from", lone_json(objects.from)}};
  json["to"] = objects.to ? lone_json(*objects.to) : Json();
  json["farthest"] = Json::array();
  for (const ObjectDistance& one : objects.farthest) {
    const DistanceSums& sums = one.distances;
    Json row{{"object", one.object},
             {"name", one.name},
             {"area", sums.area},
             {"mean", sums.mean()},
             {"mean_size", sums.mean_size()},
             {"rms", sums.rms()},
             {"least", sums.least},
             {"largest", sums.largest},
             {"farthest", sums.farthest()}};
    row["other_area"] = one.other_area ? Json(*one.other_area) : Json();
    row["moved"] = one.moved ? Json(*one.moved) : Json();
    json["farthest"].push_back(std::move(row));
  }
  return json;
}

}  // namespace

ModelView view_of(const SurfaceComparison& comparison) {
  constexpr double kShownPart = 0.99;
  const DistanceTally& distances = comparison.distances;
  // Where less than the other part moved, all that did is shown. Beyond the band the ramp has as
  // much room as half of that has, however few are there.
  const double part = distances.empty() ? 0 : distances.size_quantile(kShownPart);
  const double all =
      distances.empty() ? 0 : std::max(std::abs(distances.least()), std::abs(distances.largest()));
  const double shown =
      std::max(part > 0 ? part : all, 2 * std::max(comparison.tolerance.value_or(0), 0.0));
  // Four digits: people read it.
  const double most = std::strtod(fmt::format("{:.3e}", shown).c_str(), nullptr);
  ModelView view;
  view.colours = "attribute";
  view.attribute = kDistance;
  view.ramp = "coolwarm";
  if (most > 0)
    view.range = {-most, most};
  if (comparison.tolerance > 0)
    view.tolerance = comparison.tolerance;
  view.light = "studio";
  return view;
}

std::string comparison_text(const SurfaceComparison& comparison) {
  const DistanceTally& distances = comparison.distances;
  std::string text = "from " + line_of(comparison.from) + "to   " + line_of(comparison.to);
  if (!distances.empty()) {
    text += fmt::format("distance: mean {:.6g}, rms {:.6g}, from {:.6g} to {:.6g}\n",
                        distances.mean(), distances.rms(), distances.least(), distances.largest());
    if (comparison.is_signed)
      text += "  (negative: inside of the second one)\n";
    text += "percentiles:";
    for (const double part : kParts)
      text += fmt::format("  {} % {:.6g}", name_of_part(part), distances.quantile(part));
    text += "\nwithout sign: mean " + fmt::format("{:.6g}", distances.mean_size());
    for (const double part : kSizeParts)
      text += fmt::format("  {} % {:.6g}", name_of_part(part), distances.size_quantile(part));
    text += "\n" + histogram_text(distances);
  }
  if (comparison.lone_vertices > 0) {
    text += fmt::format("left out: {} of the first one that no triangle has\n",
                        counted(comparison.lone_vertices, "vertices"));
  }
  if (comparison.unknown_sides > 0) {
    text += fmt::format(
        "{} nearest to a border of the second one: their side is not known, and "
        "taken for the outside\n",
        counted(comparison.unknown_sides, "vertices are"));
  }
  text += fmt::format(
      "farthest vertex: {:.6g}; no point of the original surface is farther than "
      "{:.6g}\n",
      comparison.farthest, comparison.no_farther_than);
  if (comparison.tolerance)
    text += tolerance_text(comparison);
  if (comparison.objects)
    text += objects_text(*comparison.objects);
  return text;
}

Json comparison_json(const SurfaceComparison& comparison) {
  const DistanceTally& distances = comparison.distances;
  Json object{{"from", surface_json(comparison.from)},
              {"to", surface_json(comparison.to)},
              {"tiles_read", comparison.tiles_read},
              {"signed", comparison.is_signed},
              {"area", distances.weight()},
              {"distance", distances_json(distances)},
              {"lone_vertices", comparison.lone_vertices},
              {"unknown_sides", comparison.unknown_sides},
              {"farthest", comparison.farthest},
              {"no_farther_than", comparison.no_farther_than}};
  if (comparison.tolerance) {
    object["tolerance"] = *comparison.tolerance;
    object["area_within"] = distances.weight_within();
    object["within"] = comparison.is_within();
  }
  if (comparison.objects)
    object["objects"] = objects_json(*comparison.objects);
  object["warnings"] = comparison.warnings;
  return object;
}

}  // namespace meshhier::comparing
