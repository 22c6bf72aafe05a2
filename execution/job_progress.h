// The progress of a whole job, from the times that its stages were expected to take, and took.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::execution {

/// A stage as a job announces it. Stages are known by name and unit.
struct ExpectedStage {
  std::string name;
  std::string unit;
  std::uint64_t units = 0;  ///< all its work; 0 if unknown. A resumed job has fewer left
  double seconds = 0;       ///< for all of it, about
};

/// Adds up the stages of a job. Its part done never decreases. The time left follows from the
/// expected times, and the more of the job is done, the more from the pace of this run.
///
/// Work that a resumed job does not do again counts as done, but not for the pace. A stage that was
/// not expected, or comes more often than expected, adds nothing. Without expectations each stage
/// is a job of its own. One thread at a time; `now`: seconds, never less than in the call before.
class JobProgress {
 public:
  /// Announces all stages to come. Said again, it is about what is left of the job.
  void expect(std::vector<ExpectedStage> stages);
  /// Ends the stage before and begins the next, with `total` units left in it.
  void begin(std::string_view name, std::string_view unit, std::uint64_t total, double now);
  void end(double now);

  /// Returns the part of the job that is done, 0 to 1, with so many units of the current stage
  /// done; nothing if it cannot be known.
  std::optional<double> part(std::uint64_t done);
  std::optional<double> seconds_left(std::uint64_t done, double now) const;

 private:
  double share(std::uint64_t done) const;
  double weight_done(std::uint64_t done) const;
  double weight_of_all() const;

  std::vector<ExpectedStage> stages_;
  std::size_t next_ = 0;
  const ExpectedStage* current_ = nullptr;  ///< null: none that was expected
  std::uint64_t total_ = 0;                 ///< units of the current stage
  double begun_ = 0;                        ///< when the current stage began
  double skipped_ = 0;                      ///< share of the current stage that was done before
  double passed_ = 0;                       ///< expected seconds of the stages before
  double worked_ = 0;                       ///< those of them that this run did
  double spent_ = 0;                        ///< real seconds for these
  double before_ = 0;                       ///< part of the job done before expect()
  double shown_ = 0;                        ///< the last part()
};

}  // namespace meshhier::execution
