#include "app/build_batch.h"

#include "app/batch_items.h"
#include "app/batch_plan.h"
#include "base/error.h"
#include "execution/size_text.h"
#include "server/build_process.h"
#include "storage/io/json_text.h"
#include "storage/io/own_program.h"
#include "storage/io/told_json.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <ostream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {

namespace {

namespace fs = std::filesystem;

/// Throws Error(usage) if the outputs cannot lie there, else makes the folder.
void make_folder(const fs::path& folder, storage::FileSystem& files) {
  if (folder.empty())
    return;
  if (files.exists(folder) && !files.is_directory(folder))
    throw Error(ErrorCode::usage, folder.string() + ": with --each, -o names a folder");
  files.make_directories(folder);
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
      if (item.result == BatchResult::not_begun)
        all.push_back(&item);
      else
        tell_end(item);
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
    environment_.messages << storage::told_json_text(named) + '\n' << std::flush;
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

std::string seconds_text(const BatchItem& item) {
  return item.result == BatchResult::done ? ", in " + execution::duration_text(item.seconds) : "";
}

}  // namespace

int run_batch(const BuildArguments& arguments, execution::ProgressMode mode,
              const Environment& environment) {
  std::vector<BatchItem> items = plan_items(arguments, environment.files);
  if (arguments.dry_run)
    return plan_batch(arguments, items, mode, environment);
  make_folder(arguments.output, environment.files);
  Batch(arguments, mode, environment).run(items);
  environment.out << summary_text(items, seconds_text) << std::flush;
  if (environment.cancel.cancelled())
    throw Error(ErrorCode::interrupted, "interrupted; the same command goes on where it was");
  return server::exit_code_of(failures_of(items));
}

}  // namespace meshhier::app
