#include "config/config.h"

#include "config/config_schema.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"

#include <algorithm>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::tests::fuzz {
namespace {

using config::Config;

struct CommandLine {
  std::string text;
  std::vector<std::string> overrides;
};

CommandLine split_lines(std::string_view input) {
  constexpr std::string_view kSet = "--set ";
  CommandLine line;
  while (!input.empty()) {
    const std::size_t end = std::min(input.find('\n'), input.size() - 1) + 1;
    const std::string_view taken = input.substr(0, end);
    input.remove_prefix(end);
    if (taken.starts_with(kSet)) {
      const std::string_view setting = taken.substr(kSet.size());
      line.overrides.emplace_back(setting.substr(0, setting.find('\n')));
    } else {
      line.text += taken;
    }
  }
  return line;
}

void check_config(const Config& config) {
  const auto is_tile = [](std::uint32_t vertices) { return vertices >= 4 && vertices <= 32768; };
  require(!config.input.empty() && !config.output.empty(), "paths are there");
  require(config.output.has_filename(), "the output has a name");
  require(config.memory_budget.value_or(1) > 0 && config.threads <= 4096,
          "budget and threads are in range");
  require(is_tile(config.partition.vertices), "partition.vertices is in range");
  require(config.partition.count.value_or(1) >= 1, "partition.count is in range");
  const TargetVertexCounts asked = config.simplify.vertices.value_or(4);
  require(std::ranges::all_of(asked.by_level(), is_tile), "simplify.vertices is in range");
  require(!asked.by_level().empty() && asked.by_level().size() <= TargetVertexCounts::kMostLevels,
          "simplify.vertices has a number of levels");
  require(config.outline.sectors >= 1 && config.outline.sectors <= 65536, "sectors are in range");
  require(config.outline.tolerance > 0 && config.outline.tolerance <= 1, "tolerance is in range");
}

/// Settings that decide the result, written as the manifest does and read again, decide the same
/// result.
void check_resolved(const Config& config) {
  nlohmann::ordered_json resolved = config::resolved_json(config);
  nlohmann::ordered_json document = resolved;
  document["input"] = "a.ply";
  document["output"] = "b.hier";
  const Config again = config::parse_config(document.dump(), {"again", {}}, {});
  require(config::resolved_json(again) == resolved, "a resolved config resolves to itself");
}

}  // namespace

void config(Bytes input) {
  const CommandLine line = split_lines(text_of(input));
  Config read;
  const std::string refused = refusal({ErrorCode::usage}, "", [&] {
    read = config::parse_config(line.text, {"config.json", "folder"}, line.overrides);
  });
  if (!refused.empty()) {
    require(refused.starts_with("config.json: ") || refused.starts_with("--set"),
            "a message names its origin");
    return;
  }
  check_config(read);
  check_resolved(read);
}

}  // namespace meshhier::tests::fuzz
