// The account of a build: the time, memory and disk of each stage.
#pragma once

#include "execution/progress.h"
#include "execution/serial_time.h"
#include "storage/io/file.h"
#include "storage/io/process.h"
#include "storage/io/scratch_use.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::pipeline {

/// Bytes that went through system calls. Data in the memory pool does not count: it never touches
/// the disk.
struct Traffic {
  std::uint64_t input_read = 0;
  std::uint64_t output_written = 0;
  std::uint64_t temporary_read = 0;
  std::uint64_t temporary_written = 0;

  std::uint64_t moved() const {
    return input_read + output_written + temporary_read + temporary_written;
  }
};

struct StageStats {
  std::string name;
  double wall_seconds = 0;
  double user_seconds = 0;
  double system_seconds = 0;
  double serial_seconds = 0;  ///< those of work in one thread alone (execution/serial_time.h)
  Traffic bytes;
  std::uint64_t peak_resident_bytes = 0;  ///< the process's, up to the end of the stage

  double cpu_seconds() const { return user_seconds + system_seconds; }
};

/// Notes what happens from stage to stage, and passes on all that it hears. A stage that comes
/// again (a repeated sweep) goes on with its first entry. advance() may be called by several
/// threads at once, all else by one.
class StageMeter final : public execution::Progress {
 public:
  /// The sources of its figures; tests put their own in.
  struct Sources {
    execution::Progress& shown;
    const storage::IoCounters& io;
    const storage::ScratchUse& scratch;
    std::function<storage::ProcessUsage()> usage = storage::process_usage;
    execution::Clock clock = execution::steady_clock();
    std::function<double()> serial = execution::serial_seconds;
  };
  explicit StageMeter(Sources sources);

  void expect(std::vector<execution::ExpectedStage> stages) override {
    sources_.shown.expect(std::move(stages));
  }
  void stage(std::string_view name, std::uint64_t total, std::string_view unit) override;
  void warn(std::string_view message) override { sources_.shown.warn(message); }
  void advance(std::uint64_t count) override { sources_.shown.advance(count); }
  void finish(std::string_view summary) override { sources_.shown.finish(summary); }

  /// Begins a stage that nobody is shown: too short, or without a count.
  void begin(std::string_view name);
  /// Ends the last stage. May be called again, after another stage.
  void end();

  const std::vector<StageStats>& stages() const { return stages_; }
  /// Returns the figures from the construction to the last end(), time between stages included.
  StageStats total() const;

 private:
  struct Reading {
    double clock = 0;
    double serial = 0;
    storage::ProcessUsage usage;
    Traffic bytes;
  };
  Reading read() const;
  static void add_difference(const Reading& from, const Reading& to, StageStats& stage);

  Sources sources_;
  Reading start_, last_;
  std::vector<StageStats> stages_;
  std::size_t current_ = 0;  ///< index in stages_; their number: none
};

/// The figures of a whole build.
struct BuildStats {
  nlohmann::ordered_json config;  ///< resolved; with input, output, memory_budget, threads
  std::size_t threads = 1;
  std::uint64_t memory_budget_bytes = 0;
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;  ///< the input's
  std::uint32_t partitions = 0;
  int levels = 0;
  std::uint64_t tiles = 0;
  std::uint64_t input_bytes = 0;
  std::uint64_t output_bytes = 0;  ///< the published files'
  std::uint64_t peak_temporary_bytes = 0;
  std::uint64_t predicted_output_bytes = 0;
  std::uint64_t predicted_temporary_bytes = 0;
  std::vector<StageStats> stages;
  StageStats total;

  /// The bytes that a build must move at least: the input read once, the output written once.
  std::uint64_t floor_bytes() const { return input_bytes + output_bytes; }
};

/// Returns a table for people, a line a stage, then the bytes on disk.
std::string stats_text(const BuildStats& stats);

/// Returns one object; docs/command_line.md lists its keys. Bytes and seconds throughout.
nlohmann::ordered_json to_json(const BuildStats& stats);

}  // namespace meshhier::pipeline
