#include "execution/job_progress.h"

#include <algorithm>
#include <utility>

namespace meshhier::execution {
namespace {

// The expectation weighs as much as so much work that took as long as expected: a short stage says
// little of the pace of the others, as one waits for the disk and the other computes.
constexpr double kPriorShare = 0.05;
constexpr double kPriorSeconds = 1;

}  // namespace

void JobProgress::expect(std::vector<ExpectedStage> stages) {
  stages_ = std::move(stages);
  next_ = 0;
  current_ = nullptr;
  passed_ = 0;
  before_ = shown_;
}

void JobProgress::begin(std::string_view name, std::string_view unit, std::uint64_t total,
                        double now) {
  end(now);
  total_ = total;
  begun_ = now;
  if (stages_.empty())
    shown_ = before_ = 0;
  const auto found = std::find_if(
      stages_.begin() + static_cast<std::ptrdiff_t>(next_), stages_.end(),
      [&](const ExpectedStage& stage) { return stage.name == name && stage.unit == unit; });
  if (found == stages_.end())
    return;
  // Stages between that did not come had nothing to do.
  const auto index = static_cast<std::size_t>(found - stages_.begin());
  for (; next_ < index; ++next_)
    passed_ += stages_[next_].seconds;
  ++next_;
  current_ = &*found;
  skipped_ =
      total < found->units ? 1 - static_cast<double>(total) / static_cast<double>(found->units) : 0;
  if (total == 0 && found->units > 0)
    skipped_ = 1;
}

void JobProgress::end(double now) {
  if (const ExpectedStage* stage = std::exchange(current_, nullptr)) {
    passed_ += stage->seconds;
    worked_ += stage->seconds * (1 - skipped_);
    spent_ += now - begun_;
  }
}

double JobProgress::share(std::uint64_t done) const {
  return total_ == 0 ? 0
                     : static_cast<double>(std::min(done, total_)) / static_cast<double>(total_);
}

double JobProgress::weight_done(std::uint64_t done) const {
  if (current_ == nullptr)
    return passed_;
  return passed_ + current_->seconds * (skipped_ + (1 - skipped_) * share(done));
}

double JobProgress::weight_of_all() const {
  double all = 0;
  for (const ExpectedStage& stage : stages_)
    all += stage.seconds;
  return all;
}

std::optional<double> JobProgress::part(std::uint64_t done) {
  if (stages_.empty() && total_ == 0)
    return std::nullopt;
  const double all = weight_of_all();
  const double of_rest = stages_.empty() ? share(done) : all > 0 ? weight_done(done) / all : 0;
  shown_ = std::clamp(before_ + (1 - before_) * of_rest, shown_, 1.0);
  return shown_;
}

std::optional<double> JobProgress::seconds_left(std::uint64_t done, double now) const {
  if (stages_.empty()) {
    const double elapsed = now - begun_;
    if (done == 0 || total_ == 0 || elapsed <= 0)
      return std::nullopt;
    return elapsed * (1 - share(done)) / share(done);
  }
  const double all = weight_of_all();
  const double prior = kPriorSeconds + kPriorShare * all;
  const bool works = current_ != nullptr;
  const double worked = worked_ + (works ? current_->seconds * (1 - skipped_) * share(done) : 0);
  const double spent = spent_ + (works ? now - begun_ : 0);
  const double pace = (prior + spent) / (prior + worked);
  return std::max(0.0, all - weight_done(done)) * pace;
}

}  // namespace meshhier::execution
