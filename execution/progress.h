// The progress of a job, told while it runs: to people as a bar, to programs as JSON lines.
#pragma once

#include "execution/job_progress.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::execution {

/// Hears of a job's stages, one after the other. Never affects the job: output that cannot be
/// written is lost silently, nothing is thrown.
class Progress {
 public:
  virtual ~Progress() = default;

  /// Says which stages are to come and what each will take, so that the whole job's progress can be
  /// told. May be said again when more is known. No advance() may run at the same time.
  virtual void expect(std::vector<ExpectedStage> /*stages*/) {}

  /// Ends the stage before and begins the next. `name`: one word ("simplify"); `total`: units of
  /// work in it, 0 if unknown; `unit`: what is counted, plural ("tiles"). No advance() may run at
  /// the same time.
  virtual void stage(std::string_view name, std::uint64_t total, std::string_view unit) = 0;

  /// Says that so many more units of the current stage are done. Thread-safe and cheap, but meant
  /// for tiles and blocks, not for single vertices. Does nothing before the first stage().
  virtual void advance(std::uint64_t count) = 0;

  /// Tells something to know before the end, one line without its end; shown in every mode. No
  /// advance() may run at the same time.
  virtual void warn(std::string_view /*message*/) {}

  /// Ends the last stage and the job. `summary`: one line for people, may be empty. No advance()
  /// may run at the same time. Called by who made the object, not by the job; not called if the job
  /// failed: destroying the object tidies the terminal.
  virtual void finish(std::string_view summary) = 0;
};

/// Shows nothing.
class NoProgress final : public Progress {
 public:
  void stage(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void finish(std::string_view) override {}
};

enum class ProgressMode {
  automatic,  ///< bar on a terminal, none elsewhere
  bar,   ///< on a terminal one line for the whole job, redrawn at most 10 times a second and wiped
         ///< at the end; elsewhere a plain line for each finished stage
  json,  ///< one JSON object a line, at most 2 a second besides the start and the end of each stage
  none   ///< nothing but warnings
};

/// The place where progress is shown.
struct Terminal {
  // NOLINTNEXTLINE(google-explicit-constructor): most say no more
  Terminal(bool there = false, std::function<std::size_t()> width = {})
      : is_terminal(there), columns(std::move(width)) {}

  bool is_terminal;
  std::function<std::size_t()> columns;  ///< returns the width now; none, or 0, if it is unknown
};

/// Returns seconds since some moment; never decreases.
using Clock = std::function<double()>;
Clock steady_clock();

/// Makes a Progress that writes to `out` (usually standard error), which must outlive it.
/// `terminal` describes `out`.
///
/// The JSON objects have "event": "stage_start" | "progress" | "stage_end", each with "stage",
/// "done", "total" (null if unknown), "unit", "rate" (units a second since the start of the stage),
/// "seconds" (likewise), "eta_seconds" (null if unknown), "job_done" (0 to 1) and "job_eta_seconds"
/// for the whole job (null if unknown); "event": "warning" with "message"; at the end "event":
/// "finish" with "seconds" (the whole job's) and "summary".
std::unique_ptr<Progress> make_progress(ProgressMode mode, std::ostream& out,
                                        const Terminal& terminal, Clock clock = steady_clock());

}  // namespace meshhier::execution
