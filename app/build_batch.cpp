#include "app/build_batch.h"

#include "base/error.h"
#include "base/named_value.h"
#include "base/plain_text.h"
#include "config/config.h"
#include "config/named_files.h"
#include "execution/size_text.h"
#include "pipeline/plan/build_plan.h"
#include "server/build_process.h"
#include "storage/io/json_text.h"
#include "storage/io/own_program.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 4096;

enum class BatchResult { not_begun, done, up_to_date, failed, stopped };
constexpr std::array kBatchResults{
    NamedValue{"not begun", BatchResult::not_begun}, NamedValue{"done", BatchResult::done},
    NamedValue{"up to date", BatchResult::up_to_date}, NamedValue{"failed", BatchResult::failed},
    NamedValue{"stopped", BatchResult::stopped}};

/// A build of the batch.
struct BatchItem {
  std::string input;
  fs::path output{};  ///< empty: not known, as the input is no mesh
  std::uint64_t memory_budget = 0;
  std::size_t threads = 1;
  BatchResult result = BatchResult::not_begun;
  int code = 0;
  std::string message{};
  double seconds = 0;

  /// The name that it is told by.
  std::string name() const { return output.empty() ? input : output.string(); }
};

void set_failed(BatchItem& item, int code, const std::string& message) {
  item.result = BatchResult::failed;
  item.code = code;
  item.message = message;
}

/// Throws Error(usage) for settings that are none, or are for one build alone.
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
  settings.insert(settings.end(), {"input=mesh.ply", "output=mesh.hier"});
  config::parse_config("{}", {"--set", {}}, settings);
}

/// Throws Error(usage) if the outputs cannot lie there, else makes the folder.
void make_folder(const fs::path& folder, storage::FileSystem& files) {
  if (folder.empty())
    return;
  if (files.exists(folder) && !files.is_directory(folder))
    throw Error(ErrorCode::usage, folder.string() + ": with --each, -o names a folder");
  files.make_directories(folder);
}

/// Whether a shell would have replaced the word by names of files, had there been any.
bool is_pattern(const std::string& word) {
  return word.find_first_of("*?[") != std::string::npos;
}

BatchItem plan_item(const std::string& input, const BuildArguments& arguments,
                    storage::FileSystem& files) {
  BatchItem item{.input = input};
  try {
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

/// Returns a build for each input, those that are named twice once.
std::vector<BatchItem> plan_items(const BuildArguments& arguments, storage::FileSystem& files) {
  std::vector<BatchItem> items;
  std::set<fs::path> inputs;
  std::map<fs::path, std::string> makers;
  for (const std::string& input : arguments.named) {
    const fs::path normal = fs::path(input).lexically_normal();
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

/// Returns a path as a word that is no option.
std::string path_word(const std::string& path) {
  return path.starts_with('-') ? "./" + path : path;
}

class Batch {
 public:
  Batch(const BuildArguments& arguments, execution::ProgressMode mode,
        const Environment& environment)
      : arguments_(arguments),
        environment_(environment),
        program_(storage::own_program()),
        is_json_(mode == execution::ProgressMode::json),
        progress_(execution::make_progress(is_json_ ? execution::ProgressMode::none : mode,
                                           environment.messages, environment.terminal)) {}

  /// Builds all that is not done, `jobs` at once.
  void run(std::vector<BatchItem>& items) {
    progress_->stage("build", items.size(), "models");
    std::vector<BatchItem*> all;
    for (BatchItem& item : items) {
      if (item.result == BatchResult::failed)
        tell_end(item);
      else
        all.push_back(&item);
    }
    run(all, std::min<std::size_t>(arguments_.jobs, std::max<std::size_t>(all.size(), 1)));
    // Beside others there was too little memory or disk.
    std::erase_if(all,
                  [](const BatchItem* item) { return item->result != BatchResult::not_begun; });
    run(all, 1);
    progress_->finish("");
  }

 private:
  void run(const std::vector<BatchItem*>& items, std::size_t jobs) {
    std::size_t next = 0;
    const auto take = [&]() -> BatchItem* {
      const std::lock_guard lock(mutex_);
      const bool is_over = next == items.size() || environment_.cancel.cancelled();
      return is_over ? nullptr : items[next++];
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < jobs; ++i) {
      threads.emplace_back([&] {
        while (BatchItem* const item = take())
          build(*item, jobs);
      });
    }
    for (std::thread& thread : threads)
      thread.join();
  }

  void build(BatchItem& item, std::size_t jobs) {
    const execution::Clock clock = execution::steady_clock();
    const double begin = clock();
    bool is_up_to_date = false;
    std::size_t warnings = 0;
    const auto heard = [&](std::string_view line, const server::Job& job) {
      is_up_to_date = is_up_to_date || hear(line, item);
      for (; warnings < job.warnings.size(); ++warnings)
        warn(item.name() + ": " + job.warnings[warnings]);
    };
    try {
      const server::BuildEnd end =
          server::run_build_process(words(item, jobs), {.name = item.input},
                                    {heard, [&] { return environment_.cancel.cancelled(); }});
      settle(item, end, is_up_to_date);
    } catch (const Error& error) {
      set_failed(item, static_cast<int>(error.code()), error.what());
    }
    item.seconds = clock() - begin;
    constexpr int kBudget = static_cast<int>(ErrorCode::budget);
    if (item.code == kBudget && jobs > 1 && !environment_.cancel.cancelled()) {
      warn(item.name() + ": does not fit beside the others, and is built alone at the end");
      item = {item.input, item.output, item.memory_budget, item.threads};
    } else {
      tell_end(item);
    }
  }

  void settle(BatchItem& item, const server::BuildEnd& end, bool is_up_to_date) const {
    if (end.code == 0)
      item.result = is_up_to_date ? BatchResult::up_to_date : BatchResult::done;
    else
      set_failed(item, end.code, end.message);
    if (end.code == static_cast<int>(ErrorCode::interrupted) && environment_.cancel.cancelled())
      item.result = BatchResult::stopped;
  }

  std::vector<std::string> words(const BatchItem& item, std::size_t jobs) const {
    std::vector<std::string> list{program_, "build", path_word(item.input), "--progress", "json"};
    if (!arguments_.output.empty())
      list.insert(list.end(), {"-o", path_word(item.output.string())});
    for (const auto& [is_given, word] : {std::pair{arguments_.force, "--force"},
                                         {arguments_.update, "--update"},
                                         {arguments_.restart, "--restart"},
                                         {arguments_.no_links, "--no-links"}}) {
      if (is_given)
        list.emplace_back(word);
    }
    if (!arguments_.within.empty())
      list.insert(list.end(), {"--within", path_word(arguments_.within)});
    for (const std::string& setting : arguments_.settings)
      list.insert(list.end(), {"--set", setting});
    if (jobs > 1) {
      const std::size_t threads = std::max<std::size_t>(item.threads / jobs, 1);
      list.insert(list.end(), {"--set", fmt::format("threads={}", threads), "--set",
                               fmt::format("memory_budget={}", item.memory_budget / jobs)});
    }
    return list;
  }

  /// Hands a line on; whether it says that there is nothing to do.
  bool hear(std::string_view line, const BatchItem& item) {
    auto event = storage::parse_ordered_json_text(line, nullptr, {.throws = false});
    if (!event.is_object())
      event = {{"event", "message"}, {"message", line}};
    tell(item, event);
    return event.contains("event") && event["event"] == "up_to_date";
  }

  void tell_end(const BatchItem& item) {
    tell(item, {{"event", "model_end"},
                {"input", item.input},
                {"result", name_in(kBatchResults, item.result)},
                {"code", item.code},
                {"message", item.message},
                {"seconds", std::round(item.seconds * 1000) / 1000}});
    const std::lock_guard lock(mutex_);
    progress_->advance(1);
  }

  void tell(const BatchItem& item, const nlohmann::ordered_json& event) {
    if (!is_json_)
      return;
    nlohmann::ordered_json named{{"model", item.name()}};
    named.update(event);
    const std::lock_guard lock(mutex_);
    environment_.messages << storage::json_text(named) + '\n' << std::flush;
  }

  /// Tells people; programs have the builds' own lines.
  void warn(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (!is_json_)
      progress_->warn(message);
  }

  const BuildArguments& arguments_;
  const Environment& environment_;
  std::string program_;
  bool is_json_;
  std::unique_ptr<execution::Progress> progress_;
  std::mutex mutex_;
};

/// Returns a line on a build, and on why it failed.
std::string row_text(const BatchItem& item) {
  std::string text = fmt::format("{:<10}  {}", name_in(kBatchResults, item.result),
                                 plain_text(item.name(), kLongestName));
  if (item.result == BatchResult::done)
    text += ", in " + execution::duration_text(item.seconds);
  if (item.result == BatchResult::failed)
    text += fmt::format(" ({}): {}", item.code, plain_text(item.message, kLongestName));
  return text + '\n';
}

std::string summary_text(const std::vector<BatchItem>& items) {
  std::string text, counts;
  for (const BatchItem& item : items)
    text += row_text(item);
  for (const auto& [name, result] : kBatchResults) {
    const auto count = std::ranges::count(items, result, &BatchItem::result);
    if (count > 0)
      counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, name);
  }
  return text + counted(items.size(), "models") + ": " + counts + '\n';
}

}  // namespace

int run_batch(const BuildArguments& arguments, execution::ProgressMode mode,
              const Environment& environment) {
  check_settings(arguments);
  std::vector<BatchItem> items = plan_items(arguments, environment.files);
  make_folder(arguments.output, environment.files);
  Batch(arguments, mode, environment).run(items);
  environment.out << summary_text(items) << std::flush;
  if (environment.cancel.cancelled())
    throw Error(ErrorCode::interrupted, "interrupted; the same command goes on where it was");
  std::vector<int> failures;
  for (const BatchItem& item : items) {
    if (item.code != 0)
      failures.push_back(item.code);
  }
  return server::exit_code_of(failures);
}

}  // namespace meshhier::app
