// The builds of a batch: what each makes of what, and how it went.
#pragma once

#include "app/build_arguments.h"
#include "base/named_value.h"
#include "storage/io/file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace meshhier::app {

enum class BatchResult { left_out, not_begun, to_build, done, up_to_date, failed, stopped };
/// In the order in which people are told of them: failures last, where they are seen.
inline constexpr std::array kBatchResults{NamedValue{"left out", BatchResult::left_out},
                                          NamedValue{"up to date", BatchResult::up_to_date},
                                          NamedValue{"to build", BatchResult::to_build},
                                          NamedValue{"done", BatchResult::done},
                                          NamedValue{"not begun", BatchResult::not_begun},
                                          NamedValue{"stopped", BatchResult::stopped},
                                          NamedValue{"failed", BatchResult::failed}};

/// A build of the batch.
struct BatchItem {
  std::string input;
  std::filesystem::path output{};  ///< empty: not known, as the input is no mesh
  std::uint64_t memory_budget = 0;
  std::size_t threads = 1;
  BatchResult result = BatchResult::not_begun;
  int code = 0;
  std::string message{};
  double seconds = 0;

  /// The name that it is told by.
  std::string name() const { return output.empty() ? input : output.string(); }
};

/// Notes that the build has failed.
void set_failed(BatchItem& item, int code, const std::string& message);

/// Returns a build for each of arguments.named, those that are named twice once. What cannot be
/// built has failed already, and hierarchies and the folder of the outputs are left out: patterns
/// as "scans/*" match them from the second time on. Throws Error(usage) for settings that are none,
/// or are for one build alone, and if two builds would have one output.
std::vector<BatchItem> plan_items(const BuildArguments& arguments, storage::FileSystem& files);

/// Returns a line for each build, the failed ones last, and one for all. `detail`: what more is to
/// be said of one that has not failed, behind its name.
std::string summary_text(const std::vector<BatchItem>& items,
                         const std::function<std::string(const BatchItem&)>& detail);

/// Returns the exit codes of those that did not succeed.
std::vector<int> failures_of(const std::vector<BatchItem>& items);

}  // namespace meshhier::app
