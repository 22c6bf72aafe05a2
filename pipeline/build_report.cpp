#include "pipeline/build_report.h"

#include "config/config_schema.h"
#include "execution/size_text.h"
#include "hierarchy/plain_text.h"
#include "import/import_input.h"

#include <cstddef>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

constexpr std::size_t kLongestName = 255;

/// What `config` became, with what does not decide the result.
nlohmann::ordered_json whole_config(const config::Config& config) {
  nlohmann::ordered_json whole{{"input", config::find_config_key("input")->show(config)},
                               {"output", config.output.string()},
                               {"memory_budget", execution::exact_size_text(config.memory_budget)},
                               {"threads", config.threads}};
  whole.update(config::resolved_json(config));
  whole["storage"]["container"] = config::find_config_key("storage.container")->show(config);
  return whole;
}

BuildStats make_stats(const storage::HierarchyReader& made, const StageContext& context) {
  const config::Config& config = context.config;
  const BuildPlan& plan = context.plan;
  const SourceSummary& source = made.manifest().source;
  BuildStats stats;
  stats.config = whole_config(config);
  stats.threads = plan.threads;
  stats.memory_budget_bytes = config.memory_budget;
  stats.vertices = source.vertices;
  stats.triangles = source.triangles;
  stats.partitions = plan.tree.partition_count();
  stats.levels = raw(plan.tree.depth()) + 1;
  stats.tiles = made.records().size();
  stats.input_bytes = source.file_bytes;
  return stats;
}

std::string report_text(const SourceSummary& source, const std::string& found,
                        const BuildStats& stats) {
  std::string text = found.empty() ? "" : found + '\n';
  text += fmt::format("{} vertices, {} triangles -> {} partitions, {} levels, {} tiles, {}\n",
                      source.vertices, source.triangles, stats.partitions, stats.levels,
                      stats.tiles, execution::rounded_size_text(stats.output_bytes));
  for (const SourceFile& file : source.files) {
    text += fmt::format("imported {}: {}, {}\n", plain_text(file.name, kLongestName), file.format,
                        execution::rounded_size_text(file.bytes));
  }
  if (!source.counts.empty())
    text += "counted " + importing::counts_text(source.counts) + '\n';
  if (source.degenerate_triangles > 0) {
    text += fmt::format("dropped {} degenerate triangles\n", source.degenerate_triangles);
  }
  if (source.unreferenced_vertices > 0) {
    text += fmt::format("kept {} vertices that no triangle uses\n", source.unreferenced_vertices);
  }
  return text + stats_text(stats);
}

}  // namespace

BuildReport make_report(const storage::HierarchyReader& made, const BuildOutcome& outcome,
                        const StageMeter& meter, const StageContext& context) {
  BuildReport report;
  report.stats = make_stats(made, context);
  report.stats.output_bytes = outcome.output_bytes;
  report.stats.peak_temporary_bytes = outcome.peak_temporary_bytes;
  report.stats.predicted_output_bytes = outcome.predicted.output_bytes;
  report.stats.predicted_temporary_bytes = outcome.predicted.temporary_bytes;
  report.stats.stages = meter.stages();
  report.stats.total = meter.total();
  report.text = report_text(made.manifest().source, outcome.found, report.stats);
  return report;
}

}  // namespace meshhier::pipeline
