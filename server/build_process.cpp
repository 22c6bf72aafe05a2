#include "server/build_process.h"

#include "base/error.h"
#include "storage/io/child_process.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

/// A build's words are shown, and a request to stop is heard, within so long.
constexpr std::chrono::milliseconds kHearFor{50};

/// A build's lines have some hundred bytes; anything longer is no line of a build.
constexpr std::size_t kLongestLine = 64 * 1024;

/// The code of one that was asked to stop, by SIGTERM, before it could hear it.
constexpr int kNotBegun = 128 + 15;

void take_lines(std::string& text, Job& job, const BuildListener& listener) {
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
    const std::string line = text.substr(0, end);
    text.erase(0, end + 1);
    take_line(job, line);
    listener.heard(line, job);
  }
  if (text.size() > kLongestLine)
    text.clear();
}

}  // namespace

BuildEnd run_build_process(const std::vector<std::string>& words, Job job,
                           const BuildListener& listener) {
  storage::ChildProcess child(words);
  std::string text;
  bool is_asked = false;
  while (child.hear(text, kHearFor)) {
    if (listener.is_to_stop() && !std::exchange(is_asked, true))
      child.ask_to_stop();
    take_lines(text, job, listener);
  }
  take_lines(text, job, listener);
  BuildEnd end{child.wait(), job.message, job.warnings};
  if (is_asked && end.code == kNotBegun)
    return {static_cast<int>(ErrorCode::interrupted), "interrupted", {}};
  if (end.message.empty() && end.code > 128)
    end.message = fmt::format("the build was ended by signal {}", end.code - 128);
  else if (end.message.empty())
    end.message = fmt::format("the build ended with exit code {}", end.code);
  return end;
}

int exit_code_of(std::span<const int> failures) {
  if (failures.empty())
    return 0;
  const bool are_alike =
      std::ranges::all_of(failures, [&](int code) { return code == failures.front(); });
  return are_alike ? failures.front() : kSeveralReasons;
}

}  // namespace meshhier::server
