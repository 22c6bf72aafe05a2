#include "pipeline/plan/build_stats.h"

#include "execution/size_text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

using Json = nlohmann::ordered_json;

double ratio(double a, double b) {
  return b > 0 ? a / b : 0;
}

double rounded(double number, double parts) {
  return std::round(number * parts) / parts;
}

/// Returns a - b; 0 if that is less, as counters are read a moment apart.
std::uint64_t difference(std::uint64_t a, std::uint64_t b) {
  return a - std::min(a, b);
}

double triangle_rate(const BuildStats& stats, const StageStats& stage) {
  return ratio(static_cast<double>(stats.triangles), stage.wall_seconds);
}

// ---- text

std::string bytes_cell(std::uint64_t bytes) {
  return bytes == 0 ? "-" : execution::rounded_size_text(bytes);
}

std::string rate_cell(double rate) {
  return rate > 0 ? fmt::format("{:.2f}", rate / 1e6) : "-";
}

constexpr const char* kRow = "{:<10} {:>8} {:>8} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}\n";

std::string row(const BuildStats& stats, const StageStats& stage) {
  return fmt::format(
      kRow, stage.name, fmt::format("{:.2f}", stage.wall_seconds),
      fmt::format("{:.2f}", stage.cpu_seconds()), fmt::format("{:.2f}", stage.serial_seconds),
      bytes_cell(stage.bytes.input_read), bytes_cell(stage.bytes.output_written),
      bytes_cell(stage.bytes.temporary_read), bytes_cell(stage.bytes.temporary_written),
      bytes_cell(stage.peak_resident_bytes), rate_cell(triangle_rate(stats, stage)));
}

// ---- JSON

Json stage_json(const BuildStats& stats, const StageStats& stage) {
  return {{"name", stage.name},
          {"wall_seconds", rounded(stage.wall_seconds, 1e6)},
          {"cpu_seconds", rounded(stage.cpu_seconds(), 1e6)},
          {"user_seconds", rounded(stage.user_seconds, 1e6)},
          {"system_seconds", rounded(stage.system_seconds, 1e6)},
          {"serial_seconds", rounded(stage.serial_seconds, 1e6)},
          {"input_read_bytes", stage.bytes.input_read},
          {"output_written_bytes", stage.bytes.output_written},
          {"temporary_read_bytes", stage.bytes.temporary_read},
          {"temporary_written_bytes", stage.bytes.temporary_written},
          {"peak_resident_bytes", stage.peak_resident_bytes},
          {"triangles_per_second", std::round(triangle_rate(stats, stage))}};
}

}  // namespace

StageMeter::StageMeter(Sources sources) : sources_(std::move(sources)), start_(read()) {
  last_ = start_;
}

void StageMeter::stage(std::string_view name, std::uint64_t total, std::string_view unit) {
  begin(name);
  sources_.shown.stage(name, total, unit);
}

void StageMeter::begin(std::string_view name) {
  end();
  const auto found = std::ranges::find(stages_, name, &StageStats::name);
  current_ = static_cast<std::size_t>(found - stages_.begin());
  if (found == stages_.end())
    stages_.push_back({.name = std::string(name), .bytes = {}});
}

void StageMeter::end() {
  Reading now = read();
  // A peak never falls, but the system's count of it does, by some 100 KiB.
  now.usage.peak_resident_bytes =
      std::max(now.usage.peak_resident_bytes, last_.usage.peak_resident_bytes);
  if (current_ < stages_.size())
    add_difference(last_, now, stages_[current_]);
  last_ = now;
  current_ = stages_.size();
}

StageStats StageMeter::total() const {
  StageStats total{.name = "total", .bytes = {}};
  add_difference(start_, last_, total);
  return total;
}

StageMeter::Reading StageMeter::read() const {
  const storage::ScratchUse& scratch = sources_.scratch;
  Reading reading;
  reading.clock = sources_.clock();
  reading.serial = sources_.serial();
  reading.usage = sources_.usage();
  reading.bytes.temporary_read = scratch.bytes_read();
  reading.bytes.temporary_written = scratch.bytes_written();
  reading.bytes.input_read = difference(sources_.io.bytes_read, scratch.bytes_read());
  reading.bytes.output_written = difference(sources_.io.bytes_written, scratch.bytes_written());
  return reading;
}

void StageMeter::add_difference(const Reading& from, const Reading& to, StageStats& stage) {
  stage.wall_seconds += to.clock - from.clock;
  stage.serial_seconds += to.serial - from.serial;
  stage.user_seconds += to.usage.user_seconds - from.usage.user_seconds;
  stage.system_seconds += to.usage.system_seconds - from.usage.system_seconds;
  stage.peak_resident_bytes = to.usage.peak_resident_bytes;
  const auto add = [&](std::uint64_t Traffic::*count) {
    stage.bytes.*count += difference(to.bytes.*count, from.bytes.*count);
  };
  add(&Traffic::input_read);
  add(&Traffic::output_written);
  add(&Traffic::temporary_read);
  add(&Traffic::temporary_written);
}

std::string stats_text(const BuildStats& stats) {
  std::string text = fmt::format(kRow, "stage", "wall s", "CPU s", "serial s", "read", "written",
                                 "temp. in", "temp. out", "peak mem", "Mtri/s");
  for (const StageStats& stage : stats.stages)
    text += row(stats, stage);
  text += row(stats, stats.total);
  text += fmt::format("temporary disk: {} at most, {} predicted; output: {}, {} predicted\n",
                      execution::rounded_size_text(stats.peak_temporary_bytes),
                      execution::rounded_size_text(stats.predicted_temporary_bytes),
                      execution::rounded_size_text(stats.output_bytes),
                      execution::rounded_size_text(stats.predicted_output_bytes));
  text += fmt::format("memory: {} at most, budget {}; moved {:.2f} times input + output\n",
                      execution::rounded_size_text(stats.total.peak_resident_bytes),
                      execution::rounded_size_text(stats.memory_budget_bytes),
                      ratio(static_cast<double>(stats.total.bytes.moved()),
                            static_cast<double>(stats.floor_bytes())));
  return text;
}

Json to_json(const BuildStats& stats) {
  Json stages = Json::array();
  for (const StageStats& stage : stats.stages)
    stages.push_back(stage_json(stats, stage));
  const std::uint64_t moved = stats.total.bytes.moved();
  return {
      {"generator", "meshhier " MESHHIER_VERSION},
      {"config", stats.config},
      {"threads", stats.threads},
      {"memory_budget_bytes", stats.memory_budget_bytes},
      {"vertices", stats.vertices},
      {"triangles", stats.triangles},
      {"partitions", stats.partitions},
      {"levels", stats.levels},
      {"tiles", stats.tiles},
      {"input_bytes", stats.input_bytes},
      {"output_bytes", stats.output_bytes},
      {"predicted_output_bytes", stats.predicted_output_bytes},
      {"peak_temporary_bytes", stats.peak_temporary_bytes},
      {"predicted_temporary_bytes", stats.predicted_temporary_bytes},
      {"floor_bytes", stats.floor_bytes()},
      {"moved_bytes", moved},
      {"moved_per_floor",
       rounded(ratio(static_cast<double>(moved), static_cast<double>(stats.floor_bytes())), 1e4)},
      {"stages", stages},
      {"total", stage_json(stats, stats.total)}};
}

}  // namespace meshhier::pipeline
