#include "bench/scale_tables.h"

#include "execution/size_text.h"
#include "hierarchy/error.h"

#include <algorithm>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::bench {
namespace {

using execution::exact_size_text;
using execution::rounded_size_text;
using Rows = std::vector<const ScaleMeasurement*>;

double ratio(double a, double b) {
  return b > 0 ? a / b : 0;
}

double ratio(std::uint64_t a, std::uint64_t b) {
  return ratio(static_cast<double>(a), static_cast<double>(b));
}

double microseconds(const ScaleMeasurement& m, double seconds) {
  return ratio(seconds * 1e6, static_cast<double>(m.setting.triangles));
}

std::string millions(std::uint64_t triangles) {
  const double number = static_cast<double>(triangles) / 1e6;
  return fmt::format("{:.{}f} M", number, number < 0.1 ? 3 : number < 9.95 ? 2 : 1);
}

/// What one column says of a build.
struct Column {
  const char* title;
  std::function<std::string(const ScaleMeasurement&)> cell;
};

const Column kTriangles{"triangles", [](const auto& m) { return millions(m.setting.triangles); }};
const Column kWall{"wall s", [](const auto& m) { return fmt::format("{:.2f}", m.wall_seconds); }};
const Column kCpu{"CPU s", [](const auto& m) { return fmt::format("{:.2f}", m.cpu_seconds); }};
const Column kCpuEach{"CPU µs/triangle", [](const auto& m) {
                        return fmt::format("{:.3f}", microseconds(m, m.cpu_seconds));
                      }};
const Column kRate{"M triangles/s", [](const auto& m) {
                     return fmt::format("{:.2f}", ratio(static_cast<double>(m.setting.triangles),
                                                        m.wall_seconds * 1e6));
                   }};
const Column kBudget{"budget",
                     [](const auto& m) { return exact_size_text(m.setting.budget_bytes); }};
const Column kPeak{"peak memory", [](const auto& m) {
                     return rounded_size_text(std::max(m.peak_bytes, m.system_peak_bytes));
                   }};
const Column kPeakRatio{
    "peak/budget", [](const auto& m) {
      return fmt::format(
          "{:.2f}", ratio(std::max(m.peak_bytes, m.system_peak_bytes), m.setting.budget_bytes));
    }};
const Column kMoved{"moved/floor", [](const auto& m) {
                      return fmt::format("{:.2f}", ratio(m.moved_bytes, m.floor_bytes()));
                    }};
const Column kTemporary{"temporary", [](const auto& m) {
                          return m.temporary_bytes == 0 ? std::string("-")
                                                        : rounded_size_text(m.temporary_bytes);
                        }};
const Column kTemporaryFloor{
    "temporary/(in + out)",
    [](const auto& m) { return fmt::format("{:.2f}", ratio(m.temporary_bytes, m.floor_bytes())); }};
const Column kPredicted{
    "predicted/temporary", [](const auto& m) {
      return m.temporary_bytes == 0
                 ? std::string("-")
                 : fmt::format("{:.2f}", ratio(m.predicted_temporary_bytes, m.temporary_bytes));
    }};
const Column kOutput{"output", [](const auto& m) { return rounded_size_text(m.output_bytes); }};
const Column kPredictedOutput{"predicted/output", [](const auto& m) {
                                return fmt::format("{:.2f}",
                                                   ratio(m.predicted_output_bytes, m.output_bytes));
                              }};
const Column kCopy{"plain copy s",
                   [](const auto& m) { return fmt::format("{:.2f}", m.copy_seconds); }};
const Column kCopyRatio{"wall/copy", [](const auto& m) {
                          return fmt::format("{:.1f}", ratio(m.wall_seconds, m.copy_seconds));
                        }};
const Column kMethod{"method", [](const auto& m) { return m.setting.method; }};
const Column kOrder{
    "order", [](const auto& m) { return std::string(m.setting.shuffled ? "random" : "own"); }};

std::string table(const std::string& title, const std::vector<Column>& columns, const Rows& rows) {
  if (rows.empty())
    return "";
  std::string text = fmt::format("### {}\n\n|", title);
  for (const Column& column : columns)
    text += fmt::format(" {} |", column.title);
  text += "\n|";
  for (std::size_t i = 0; i < columns.size(); ++i)
    text += "---:|";
  text += '\n';
  for (const ScaleMeasurement* row : rows) {
    text += '|';
    for (const Column& column : columns)
      text += fmt::format(" {} |", column.cell(*row));
    text += '\n';
  }
  return text + '\n';
}

/// The measurements that differ from the usual in nothing but what `forget` makes equal, in order
/// of their settings.
Rows rows_of(const ScaleReport& report,
             const std::function<void(ScaleSetting&, const ScaleSetting&)>& forget) {
  Rows rows;
  for (const ScaleMeasurement& m : report.measurements) {
    ScaleSetting setting = m.setting;
    forget(setting, report.usual);
    if (setting == report.usual)
      rows.push_back(&m);
  }
  std::ranges::sort(rows, {}, [](const ScaleMeasurement* m) { return m->setting; });
  return rows;
}

/// A column that compares each build with another of the same size.
Column against(const Rows& rows, const char* title,
               const std::function<bool(const ScaleSetting&)>& is_reference) {
  return {title, [=](const ScaleMeasurement& m) {
            for (const ScaleMeasurement* other : rows) {
              if (other->setting.triangles == m.setting.triangles && is_reference(other->setting))
                return fmt::format("{:.2f}", ratio(m.wall_seconds, other->wall_seconds));
            }
            return std::string("-");
          }};
}

double compute_gain(const ScaleReport& report, unsigned threads) {
  const auto found = std::ranges::find(report.compute, threads, &ComputeGain::threads);
  return found == report.compute.end() ? 0 : found->gain;
}

double wall_of(const ScaleMeasurement& m, const std::string& stage) {
  const auto found = std::ranges::find(m.stages, stage, &StageTime::name);
  return found == m.stages.end() ? 0 : found->wall_seconds;
}

/// Stage by stage: wall time of every number of threads, gain over one.
std::string thread_table(const ScaleReport& report) {
  const Rows rows = rows_of(
      report, [](ScaleSetting& s, const ScaleSetting& usual) { s.threads = usual.threads; });
  if (rows.size() < 2)
    return "";
  const ScaleMeasurement& one = *rows.front();
  std::string head = fmt::format("| stage | {} thread: wall s |", one.setting.threads);
  std::string rule = "|---|---:|";
  std::string loop = "| a loop that only computes | |";
  std::string total = fmt::format("| **whole build** | {:.2f} |", one.wall_seconds);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const unsigned threads = rows[i]->setting.threads;
    head += fmt::format(" {} threads: wall s | gain |", threads);
    rule += "---:|---:|";
    loop += fmt::format(" | {:.2f} |", compute_gain(report, threads));
    total += fmt::format(" {:.2f} | {:.2f} |", rows[i]->wall_seconds,
                         ratio(one.wall_seconds, rows[i]->wall_seconds));
  }
  std::string text =
      fmt::format("### Threads ({} triangles, {})\n\n{}\n{}\n", millions(one.setting.triangles),
                  exact_size_text(one.setting.budget_bytes), head, rule);
  for (const StageTime& stage : one.stages) {
    text += fmt::format("| {} | {:.2f} |", stage.name, stage.wall_seconds);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const double wall = wall_of(*rows[i], stage.name);
      text += fmt::format(" {:.2f} | {:.2f} |", wall, ratio(stage.wall_seconds, wall));
    }
    text += '\n';
  }
  return text + total + '\n' + loop + "\n\n";
}

}  // namespace

ScaleMeasurement parse_stats(const std::string& json, const ScaleSetting& setting) {
  try {
    const auto stats = nlohmann::json::parse(json);
    ScaleMeasurement m;
    m.setting = setting;
    m.wall_seconds = stats.at("total").at("wall_seconds");
    m.cpu_seconds = stats.at("total").at("cpu_seconds");
    m.peak_bytes = stats.at("total").at("peak_resident_bytes");
    m.input_bytes = stats.at("input_bytes");
    m.output_bytes = stats.at("output_bytes");
    m.predicted_output_bytes = stats.at("predicted_output_bytes");
    m.temporary_bytes = stats.at("peak_temporary_bytes");
    m.predicted_temporary_bytes = stats.at("predicted_temporary_bytes");
    m.moved_bytes = stats.at("moved_bytes");
    for (const auto& stage : stats.at("stages"))
      m.stages.push_back({stage.at("name"), stage.at("wall_seconds"), stage.at("cpu_seconds")});
    return m;
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorCode::input, fmt::format("not the account of a build: {}", error.what()));
  }
}

std::string scale_tables(const ScaleReport& report) {
  const Rows sizes = rows_of(
      report, [](ScaleSetting& s, const ScaleSetting& usual) { s.triangles = usual.triangles; });
  const Rows budgets = rows_of(report, [](ScaleSetting& s, const ScaleSetting& usual) {
    s.triangles = usual.triangles;
    s.budget_bytes = usual.budget_bytes;
  });
  const Rows methods =
      rows_of(report, [](ScaleSetting& s, const ScaleSetting& usual) { s.method = usual.method; });
  const Rows orders = rows_of(report, [](ScaleSetting& s, const ScaleSetting& usual) {
    s.triangles = usual.triangles;
    s.shuffled = usual.shuffled;
  });
  const std::string usual =
      fmt::format("{}, {}, {} threads", report.usual.method,
                  exact_size_text(report.usual.budget_bytes), report.usual.threads);
  std::string text = fmt::format("Meshes: {}.\n\n", report.base);
  text += table(fmt::format("Sizes ({})", usual),
                {kTriangles, kWall, kCpu, kCpuEach, kRate, kPeak, kPeakRatio, kMoved, kOutput,
                 kPredictedOutput, kCopy, kCopyRatio},
                sizes);
  if (budgets.size() > sizes.size()) {
    text +=
        table(fmt::format("Budgets ({}, {} threads)", report.usual.method, report.usual.threads),
              {kTriangles, kBudget, kWall, kCpu, kPeak, kPeakRatio, kMoved, kTemporary,
               kTemporaryFloor, kPredicted},
              budgets);
  }
  text += thread_table(report);
  if (methods.size() > 1) {
    const Column factor = against(methods, "wall/edge_collapse", [](const ScaleSetting& s) {
      return s.method == "edge_collapse";
    });
    text += table(fmt::format("Methods ({} triangles)", millions(report.usual.triangles)),
                  {kMethod, kWall, kCpu, kCpuEach, kRate, factor}, methods);
  }
  if (std::ranges::any_of(orders, [](const auto* m) { return m->setting.shuffled; })) {
    const Column factor =
        against(orders, "wall/own", [](const ScaleSetting& s) { return !s.shuffled; });
    text += table(fmt::format("Order of vertices and faces ({})", usual),
                  {kTriangles, kOrder, kWall, kCpu, kCpuEach, kPeakRatio, kMoved, factor}, orders);
  }
  return text;
}

}  // namespace meshhier::bench
