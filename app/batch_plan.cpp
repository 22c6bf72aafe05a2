#include "app/batch_plan.h"

#include "app/build_one.h"
#include "app/options.h"
#include "base/error.h"
#include "execution/size_text.h"
#include "server/build_process.h"
#include "storage/io/neighbours.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <ranges>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The disk of one file system that builds take which put their outputs there.
struct DiskShare {
  fs::path folder;  ///< one of those that are there
  std::uint64_t free_bytes = 0;
  std::uint64_t more_bytes = 0;  ///< when all is built, than now
  /// Of each build, as long as it is at work, besides; the largest first.
  std::multiset<std::uint64_t, std::greater<>> at_work{};

  /// The most that is needed at any moment, by so many builds at once.
  std::uint64_t room_bytes(std::size_t jobs) const {
    std::uint64_t bytes = more_bytes;
    for (const std::uint64_t one : at_work | std::views::take(jobs))
      bytes += one;
    return bytes;
  }
};

std::uint64_t without(std::uint64_t bytes, std::uint64_t less) {
  return bytes - std::min(bytes, less);
}

class BatchPlan {
 public:
  BatchPlan(const BuildArguments& arguments, const Environment& environment)
      : arguments_(arguments), environment_(environment) {}

  /// Estimates a build. Throws Error(interrupted); any other Error is the build's failure.
  void add(BatchItem& item) {
    environment_.cancel.check();
    Json told = Json::object();
    if (item.result == BatchResult::not_begun) {
      try {
        if (const auto estimate = estimate_of(item))
          told = add(item, *estimate);
      } catch (const Error& error) {
        if (error.code() == ErrorCode::interrupted)
          throw;
        set_failed(item, static_cast<int>(error.code()), error.what());
      }
    }
    Json model{{"input", item.input},
               {"output", item.output.string()},
               {"result", name_in(kBatchResults, item.result)},
               {"code", item.code},
               {"message", item.message}};
    model.update(told);
    models_.push_back(std::move(model));
  }

  /// Returns whether each disk holds all that will be put there.
  bool has_room() const {
    return std::ranges::all_of(disks_, [this](const auto& named) {
      return named.second.room_bytes(arguments_.jobs) <= named.second.free_bytes;
    });
  }

  std::string text(const std::vector<BatchItem>& items) const {
    std::string text = summary_text(items, [this](const BatchItem& item) {
      const auto found = details_.find(item.name());
      return found == details_.end() ? "" : found->second;
    });
    for (const auto& [root, disk] : disks_) {
      const std::uint64_t room = disk.room_bytes(arguments_.jobs);
      text += fmt::format(
          "disk        {} more when all is built, {} at once on the way, {} free "
          "in {}{}\n",
          execution::rounded_size_text(disk.more_bytes), execution::rounded_size_text(room),
          execution::rounded_size_text(disk.free_bytes), disk.folder.string(),
          room > disk.free_bytes ? ": too little for all" : "");
    }
    if (wall_seconds_ > 0)
      text += fmt::format("time        about {} (an estimate, for {})\n",
                          execution::duration_text(wall_seconds_), pipeline::kRateMachine);
    return text;
  }

  Json json() const {
    Json disks = Json::array();
    for (const auto& [root, disk] : disks_) {
      disks.push_back({{"folder", disk.folder.string()},
                       {"free_bytes", disk.free_bytes},
                       {"predicted_more_bytes", disk.more_bytes},
                       {"predicted_room_bytes", disk.room_bytes(arguments_.jobs)}});
    }
    return {{"models", models_}, {"disks", disks}, {"estimated_wall_seconds", wall_seconds_}};
  }

 private:
  std::optional<pipeline::BuildEstimate> estimate_of(BatchItem& item) const {
    BuildArguments one = arguments_;
    one.named = {item.input};
    if (!one.output.empty())
      one.output = item.output.string();
    execution::NoProgress silent;
    auto estimate = estimate_one(one, load_config(one, environment_.files), silent, environment_);
    item.result = estimate ? BatchResult::to_build : BatchResult::up_to_date;
    return estimate;
  }

  /// Counts a build; returns what programs are told of it.
  Json add(const BatchItem& item, const pipeline::BuildEstimate& estimate) {
    const pipeline::DiskNeed& need = estimate.plan.disk;
    const std::uint64_t more = without(need.output_bytes, estimate.replaced_bytes);
    DiskShare& disk = disks_[storage::file_system_root(estimate.disk)];
    if (disk.folder.empty())
      disk = {.folder = estimate.disk, .free_bytes = estimate.free_bytes};
    disk.more_bytes += more;
    disk.at_work.insert(without(without(need.room_bytes, more), estimate.left_bytes));
    wall_seconds_ += estimate.time.wall_seconds;
    details_[item.name()] =
        fmt::format(", about {}, in {}", execution::rounded_size_text(need.output_bytes),
                    execution::duration_text(estimate.time.wall_seconds));
    return to_json(estimate);
  }

  const BuildArguments& arguments_;
  const Environment& environment_;
  std::map<fs::path, DiskShare> disks_;  ///< by file systems
  std::map<std::string, std::string> details_;
  Json models_ = Json::array();
  double wall_seconds_ = 0;
};

}  // namespace

int plan_batch(const BuildArguments& arguments, std::vector<BatchItem>& items,
               execution::ProgressMode mode, const Environment& environment) {
  const auto progress = execution::make_progress(mode, environment.messages, environment.terminal);
  progress->stage("plan", items.size(), "models");
  BatchPlan plan(arguments, environment);
  for (BatchItem& item : items) {
    plan.add(item);
    progress->advance(1);
  }
  progress->finish("");
  environment.out << (arguments.json ? pretty_json(plan.json()) : plan.text(items));
  std::vector<int> failures = failures_of(items);
  if (!plan.has_room())
    failures.push_back(static_cast<int>(ErrorCode::budget));
  return server::exit_code_of(failures);
}

}  // namespace meshhier::app
