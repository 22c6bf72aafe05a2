// Tells measurements in words.
#include "base/plain_text.h"
#include "verify/verify_error.h"

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const DistanceSummary& summary) {
  return {{"mean", summary.mean}, {"rms", summary.rms}, {"max", summary.max}};
}

/// Returns ten thousandths of the diagonal, the unit that simplifiers are compared in.
double in_parts(double distance, double diagonal) {
  return diagonal > 0 ? distance / diagonal * 1e4 : 0;
}

std::string row(const char* name, const DistanceSummary& summary, double diagonal) {
  return fmt::format("  {:<8} {:>12.6g} {:>12.6g} {:>12.6g} | {:>10.4f} {:>10.4f} {:>10.3f}\n",
                     name, summary.mean, summary.rms, summary.max, in_parts(summary.mean, diagonal),
                     in_parts(summary.rms, diagonal), in_parts(summary.max, diagonal));
}

}  // namespace

std::string to_text(const ErrorMeasurement& m) {
  std::string text = fmt::format("{}: {}, {}{}; {} each way\n", m.name, counted(m.tiles, "tiles"),
                                 counted(m.triangles, "triangles"),
                                 m.flat > 0 ? fmt::format(", {} of them without area", m.flat) : "",
                                 counted(m.samples, "samples"));
  text += fmt::format("  {:<8} {:>38} | {:>32}\n", "", "input units", "diagonal x 10^-4");
  text += fmt::format("  {:<8} {:>12} {:>12} {:>12} | {:>10} {:>10} {:>10}\n", "", "mean", "rms",
                      "max", "mean", "rms", "max");
  text += row("forward", m.forward, m.diagonal) + row("backward", m.backward, m.diagonal);
  text += fmt::format("  {:<8} {:>12.6g} {:>25} | {:>10.4f}\n", "error", m.error, "",
                      in_parts(m.error, m.diagonal));
  text += fmt::format("  {:<8} {:>38.6g} | {:>32.3f}\n", "bound", m.bound,
                      in_parts(m.bound, m.diagonal));
  if (m.ratio) {
    text += fmt::format("  bound / measured maximum of a tile: median {:.3g}, p95 {:.3g}\n",
                        m.ratio->median, m.ratio->p95);
  }
  for (const std::string& problem : m.problems)
    text += fmt::format("PROBLEM: {}\n", problem);
  return text;
}

nlohmann::ordered_json to_json(const ErrorMeasurement& m) {
  return {{"level", m.level ? Json(raw(*m.level)) : Json()},
          {"name", m.name},
          {"tiles", m.tiles},
          {"triangles", m.triangles},
          {"flat_triangles", m.flat},
          {"diagonal", m.diagonal},
          {"samples", m.samples},
          {"forward", to_json(m.forward)},
          {"backward", to_json(m.backward)},
          {"error", m.error},
          {"bound", m.bound},
          {"ratio", m.ratio ? Json{{"median", m.ratio->median}, {"p95", m.ratio->p95}} : Json()},
          {"problems", m.problems}};
}

}  // namespace meshhier::verifying
