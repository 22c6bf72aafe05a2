// What `meshhier_scale` measured, as the tables of docs/performance.md.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::bench {

/// What a build is asked to do.
struct ScaleSetting {
  std::uint64_t triangles = 0;  ///< of the input
  bool shuffled = false;        ///< else in its own order
  std::string method = "edge_collapse";
  unsigned threads = 1;
  std::uint64_t budget_bytes = 0;
  friend auto operator<=>(const ScaleSetting&, const ScaleSetting&) = default;
};

struct StageTime {
  std::string name;
  double wall_seconds = 0;
  double cpu_seconds = 0;
};

/// What a build took; from its own account but for the last two.
struct ScaleMeasurement {
  ScaleSetting setting;
  double wall_seconds = 0;
  double cpu_seconds = 0;
  std::uint64_t input_bytes = 0;
  std::uint64_t output_bytes = 0;
  std::uint64_t predicted_output_bytes = 0;
  std::uint64_t temporary_bytes = 0;  ///< at once
  std::uint64_t predicted_temporary_bytes = 0;
  std::uint64_t moved_bytes = 0;
  std::uint64_t peak_bytes = 0;  ///< resident
  std::vector<StageTime> stages;
  std::uint64_t system_peak_bytes = 0;  ///< as the system counts for a parent
  double copy_seconds = 0;              ///< the floor: input read, output written, both plainly

  std::uint64_t floor_bytes() const { return input_bytes + output_bytes; }
};

/// Of the text that `meshhier build --stats` writes. Throws Error(input) if it is anything else.
ScaleMeasurement parse_stats(const std::string& json, const ScaleSetting& setting);

/// The gain of `threads` threads over one for a loop that only computes.
struct ComputeGain {
  unsigned threads = 1;
  double gain = 1;
};

/// All that a run found out. A table without rows is left out.
struct ScaleReport {
  std::string base;                            ///< what the meshes are made of
  std::vector<ScaleMeasurement> measurements;  ///< each setting once
  std::vector<ComputeGain> compute;
  ScaleSetting usual;  ///< what the tables vary one thing of; triangles: the size of most tables
};

/// Markdown: sizes, budgets, threads stage by stage, methods, order.
std::string scale_tables(const ScaleReport& report);

}  // namespace meshhier::bench
