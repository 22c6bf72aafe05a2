#include "pipeline/build_report.h"

#include "base/plain_text.h"
#include "base/widest_corner.h"
#include "config/config_schema.h"
#include "config/placement.h"
#include "execution/size_text.h"
#include "import/import_input.h"
#include "pipeline/input_note.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

constexpr std::size_t kLongestFileName = 255;
constexpr std::size_t kLongestPath = 4096;

/// Returns the resolved config, with the keys that do not decide the result.
nlohmann::ordered_json whole_config(const config::Config& config) {
  nlohmann::ordered_json whole{{"input", config::find_config_key("input")->show(config)},
                               {"output", config.output.string()},
                               {"memory_budget", execution::exact_size_text(memory_budget(config))},
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
  stats.memory_budget_bytes = memory_budget(config);
  stats.vertices = source.vertices;
  stats.triangles = source.triangles;
  stats.partitions = plan.tree.partition_count();
  stats.levels = raw(plan.tree.depth()) + 1;
  stats.tiles = made.records().size();
  stats.input_bytes = source.file_bytes;
  return stats;
}

/// A count that all should know of: "3 normals of the mesh became 0".
struct CountWarning {
  std::string_view count;
  const char* what;
  const char* became;
};

constexpr const char* kBecameZero = " of the mesh became 0: the file has no finite numbers there";
constexpr const char* kBecameWhite = " of the mesh became white: others have colours";
constexpr std::array kCountWarnings{
    CountWarning{importing::kZeroedNormals, "normals", kBecameZero},
    CountWarning{importing::kZeroedTexcoords, "texture coordinates", kBecameZero},
    CountWarning{importing::kMadeWhite, "vertices", kBecameWhite},
    CountWarning{importing::kFacesMadeWhite, "faces", kBecameWhite},
    CountWarning{importing::kHiddenColours, "vertices",
                 " without a picture have colours that are not shown: others have both"},
    CountWarning{importing::kIgnoredEmission, "materials",
                 " emit light that is not shown, beside their base colour"},
    CountWarning{importing::kMadeOpaque, "materials",
                 " are transparent and shown as opaque: only pictures are shown through"},
    CountWarning{
        importing::kIgnoredTechniques, "materials",
        " have pictures by KHR_techniques_webgl of which none is known to be their colour: "
        "they are not shown"}};

/// Returns the warning that nothing has an area. If positions are rounded, the mesh itself may have
/// one.
const char* no_area_text(const SourceSummary& source, bool is_rounded) {
  if (is_rounded)
    return "no triangle has an area once positions are rounded to so few bits "
           "(\"storage.positions.bits\"): viewers show nothing";
  if (source.double_precision)
    return "no triangle of the mesh has an area that 32-bit floats can hold, their corners lie on "
           "lines: viewers show nothing";
  return "no triangle of the mesh has an area, their corners lie on lines: viewers show nothing";
}

/// Returns warnings of a hierarchy of which a viewer shows nothing, or less than its maker may
/// think.
std::string warning_text(const SourceSummary& source, bool has_area, bool is_rounded) {
  std::string text;
  const auto warn = [&](const std::string& what) { text += "warning: " + what + '\n'; };
  if (source.triangles == 0 && source.faces == 0)
    warn("the mesh has no triangles: viewers show nothing of points alone");
  else if (source.triangles == 0)
    warn("all triangles of the mesh are degenerate: viewers show nothing");
  else if (source.diagonal() == 0)
    warn("all vertices of the mesh are at one point: viewers show nothing");
  else if (!has_area)
    warn(no_area_text(source, is_rounded));
  else if (source.degenerate_triangles > source.triangles)
    warn("most triangles of the mesh are degenerate");
  for (const CountWarning& warning : kCountWarnings) {
    const std::uint64_t count = source.count_of(warning.count);
    if (count > 0)
      warn(counted(count, warning.what) + warning.became);
  }
  if (source.triangles > 0 && source.unreferenced_vertices > source.vertices / 2)
    warn("most vertices of the mesh belong to no triangle");
  return text;
}

/// Returns the absolute value of each coordinate.
Vec3d absolute(Vec3d p) {
  return {std::abs(p.x), std::abs(p.y), std::abs(p.z)};
}

/// Whether the triangle has more area than rounding its corners makes of a line. Along each axis an
/// edge is off by at most 2^-23 of the largest coordinate there, whatever the other axes are like:
/// they may be in other units.
bool is_wide(Vec3f a, Vec3f b, Vec3f c) {
  constexpr double kRounding = 0x1p-23;
  Vec3d off;
  for (const Vec3f corner : {a, b, c}) {
    const Vec3d p = absolute(to_double(corner)) * kRounding;
    off = {std::max(off.x, p.x), std::max(off.y, p.y), std::max(off.z, p.z)};
  }
  const auto [first, second, third] = widest_first(a, b, c);
  const Vec3d one = second - first, other = third - first;
  const Vec3d area = absolute(cross(one, other)), edges = absolute(one) + absolute(other) + off;
  return area.x > edges.y * off.z + edges.z * off.y || area.y > edges.z * off.x + edges.x * off.z ||
         area.z > edges.x * off.y + edges.y * off.x;
}

bool has_area(const TileMesh& mesh) {
  const auto has = [&](const TileTriangle& triangle) {
    const auto corner = [&](int k) { return mesh.vertices.positions[raw(triangle[k])]; };
    return is_wide(corner(0), corner(1), corner(2));
  };
  return std::ranges::any_of(mesh.interior, has) || std::ranges::any_of(mesh.border, has);
}

std::string placement_text(const storage::Manifest& made, const config::Config& config) {
  if (made.transform)
    return config::placement_text(config, made.source.bounds, *made.transform);
  const std::filesystem::path& local = config.placement.unplaced_by;
  return local.empty() ? "" : local.string() + " names no map: the model has no place\n";
}

std::string account_text(const SourceSummary& source, const BuildStats& stats) {
  std::string text;
  for (const SourceFile& file : source.files) {
    text += fmt::format("imported {}: {}, {}\n", plain_text(file.name, kLongestFileName),
                        file.format, execution::rounded_size_text(file.bytes));
  }
  if (!source.counts.empty())
    text += "counted " + importing::counts_text(source.counts) + '\n';
  if (!source.unused.empty())
    text += fmt::format("not used: {}\n", fmt::join(source.unused, ", "));
  return text + stats_text(stats);
}

}  // namespace

std::uint64_t bytes_of(const storage::HierarchyReader& made, storage::FileSystem& files) {
  return made.manifest().total_bytes + files.open(storage::manifest_path(made.directory()))->size();
}

std::string made_text(const storage::HierarchyReader& made, const std::filesystem::path& output,
                      std::uint64_t output_bytes) {
  const SourceSummary& source = made.manifest().source;
  return fmt::format(
      "made {}: {}, {} in {}, {}, {}, {}\n", plain_text(output.string(), kLongestPath),
      counted_vertices(source.vertices, source.places), counted(source.triangles, "triangles"),
      counted(made.tree().partition_count(), "partitions"),
      counted(static_cast<std::uint64_t>(raw(made.tree().depth())) + 1, "levels"),
      counted(made.records().size(), "tiles"), execution::rounded_size_text(output_bytes));
}

bool has_area(const storage::HierarchyReader& made, const execution::CancelToken& cancel) {
  return std::ranges::any_of(made.records(), [&](const TileRecord& record) {
    cancel.check();
    return made.tree().is_partition(record.node) && has_area(made.read_tile(record.node).mesh);
  });
}

std::string notes_text(const storage::HierarchyReader& made, const config::Config& config,
                       bool has_area) {
  const SourceSummary& source = made.manifest().source;
  std::string text;
  if (source.degenerate_triangles > 0)
    text += "dropped " + counted(source.degenerate_triangles, "degenerate triangles") + '\n';
  if (source.unreferenced_vertices > 0) {
    text += fmt::format("kept {} that no triangle uses\n",
                        counted(source.unreferenced_vertices, "vertices"));
  }
  if (config.storage.normals == config::Normals::map && !made.manifest().normal_maps)
    text += "no tile has a normal map: none with triangles lies above the partitions\n";
  return text + warning_text(source, has_area, made.manifest().quantization.has_value()) +
         placement_text(made.manifest(), config) +
         storage::forced_collapses_text(
             storage::summarize_forced_collapses(made.records(), source.places));
}

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
  const SourceSummary& source = made.manifest().source;
  report.text = made_text(made, context.config.output, outcome.output_bytes) +
                fmt::format("took {} and {} of memory, of a budget of {}\n",
                            execution::duration_text(report.stats.total.wall_seconds),
                            execution::rounded_size_text(report.stats.total.peak_resident_bytes),
                            execution::rounded_size_text(memory_budget(context.config)));
  if (!outcome.found.empty())
    report.text += outcome.found + '\n';
  if (outcome.copies_between_tiles > 0)
    report.text += fmt::format(
        "{} of tiles lie exactly where those of other tiles do: their borders agree there, and are "
        "simplified as one surface; \"weld\" makes one vertex of those that are alike in all "
        "else\n",
        counted(outcome.copies_between_tiles, "vertices"));
  report.text += notes_text(made, context.config, outcome.has_area);
  report.account = account_text(source, report.stats);
  report.input = note_of(outcome.input, source.checksum, context.config, context.files,
                         [&] { context.cancel.check(); });
  return report;
}

}  // namespace meshhier::pipeline
