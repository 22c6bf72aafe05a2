#include "app/batch_items.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "config/config.h"
#include "config/named_files.h"
#include "mesh_io/output_name.h"
#include "pipeline/plan/build_plan.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 4096;

/// Throws Error(usage) for settings that are none, and for words that are for one build alone.
void check_settings(const BuildArguments& arguments) {
  std::vector<std::string> settings = arguments.settings;
  for (const std::string& setting : settings) {
    if (setting.starts_with("input=") || setting.starts_with("output="))
      throw Error(
          ErrorCode::usage,
          fmt::format("--set {}: with --each, inputs are the FILEs, and -o names the folder "
                      "of all outputs",
                      plain_text(setting, kLongestName)));
  }
  mesh_io::require_true_ending(arguments.output, {},
                               "with --each, -o names the folder of all outputs; archives are "
                               "made in it by --set storage.container=3tz");
  settings.insert(settings.end(), {"input=mesh.ply", "output=mesh.hier"});
  config::parse_config("{}", {"--set", {}}, settings);
}

/// Whether a shell would have replaced the word by names of files, had there been any.
bool is_pattern(const std::string& word) {
  return word.find_first_of("*?[") != std::string::npos;
}

/// Whether it is what batches make, or where they put it.
bool is_made(const fs::path& input, const BuildArguments& arguments, storage::FileSystem& files) {
  return config::is_hierarchy(files, input) ||
         (!arguments.output.empty() && files.is_directory(input) &&
          files.canonical(input) == files.canonical(arguments.output));
}

BatchItem plan_item(const std::string& input, const BuildArguments& arguments,
                    storage::FileSystem& files) {
  BatchItem item{.input = input};
  try {
    if (is_made(input, arguments, files)) {
      item.result = BatchResult::left_out;
      return item;
    }
    const config::Config config =
        config::read_named(files, {input}, config::CommandLine(arguments.settings));
    const fs::path folder = arguments.output;
    item.output = folder.empty() ? config.output : folder / config.output.filename();
    item.memory_budget = pipeline::memory_budget(config);
    item.threads = pipeline::thread_count(config);
  } catch (const Error& error) {
    const bool is_nothing = is_pattern(input) && !files.exists(input);
    set_failed(item, static_cast<int>(error.code()),
               is_nothing ? input + ": no file has a name like that" : error.what());
  }
  return item;
}

}  // namespace

std::vector<BatchItem> plan_items(const BuildArguments& arguments, storage::FileSystem& files) {
  check_settings(arguments);
  std::vector<BatchItem> items;
  std::set<fs::path> inputs;
  std::map<fs::path, std::string> makers;
  for (const std::string& input : arguments.named) {
    const fs::path normal = fs::absolute(input).lexically_normal();
    if (!inputs.insert(storage::without_last_slash(normal)).second)
      continue;
    items.push_back(plan_item(input, arguments, files));
    const fs::path& output = items.back().output;
    if (output.empty())
      continue;
    const auto [other, is_new] = makers.emplace(files.canonical(output), input);
    if (!is_new)
      throw Error(ErrorCode::usage,
                  fmt::format("{} and {} would both become {}: rename one, or build them by two "
                              "commands into two folders (of a tileset.json name the folder)",
                              plain_text(other->second, kLongestName),
                              plain_text(input, kLongestName), output.string()));
  }
  return items;
}

void set_failed(BatchItem& item, int code, const std::string& message) {
  item.result = BatchResult::failed;
  item.code = code;
  item.message = message;
}

std::string summary_text(const std::vector<BatchItem>& items,
                         const std::function<std::string(const BatchItem&)>& detail) {
  std::string rows, counts;
  for (const auto& [name, result] : kBatchResults) {
    std::size_t count = 0;
    for (const BatchItem& item : items) {
      if (item.result != result)
        continue;
      ++count;
      rows += fmt::format(
          "{:<10}  {}{}\n", name, plain_text(item.name(), kLongestName),
          result == BatchResult::failed
              ? fmt::format(" ({}): {}", item.code, plain_text(item.message, kLongestName))
              : detail(item));
    }
    if (count > 0)
      counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, name);
  }
  return rows + counted(items.size(), "models") + ": " + counts + '\n';
}

std::vector<int> failures_of(const std::vector<BatchItem>& items) {
  std::vector<int> failures;
  for (const BatchItem& item : items) {
    if (item.code != 0)
      failures.push_back(item.code);
  }
  return failures;
}

}  // namespace meshhier::app
