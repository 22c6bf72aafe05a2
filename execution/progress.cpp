#include "execution/progress.h"

#include "base/plain_text.h"
#include "execution/size_text.h"
#include "storage/io/told_json.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::execution {

namespace {

/// A bar looks steady at 10 pictures a second; a program that reads along needs fewer.
constexpr double kBarInterval = 0.1;
constexpr double kJsonInterval = 0.5;
constexpr std::size_t kBarWidth = 24;
/// The least width of a bar; a shorter one says less than the percentage beside it.
constexpr std::size_t kLeastBarWidth = 8;
/// The width of a terminal that does not say it.
constexpr std::size_t kUsualColumns = 80;

/// A stage at one moment.
struct Snapshot {
  std::string_view name;
  std::string_view unit;
  std::uint64_t done = 0;
  std::uint64_t total = 0;  ///< 0: unknown
  double seconds = 0;
  std::optional<double> job_part;
  std::optional<double> job_seconds_left;

  double rate() const { return seconds > 0 ? static_cast<double>(done) / seconds : 0; }
  std::optional<double> seconds_left() const {
    if (total == 0 || rate() <= 0)
      return std::nullopt;
    return static_cast<double>(total - std::min(done, total)) / rate();
  }
};

void write_warning(std::ostream& out, std::string_view message) {
  out << "warning: " << message << '\n' << std::flush;
}

/// Counts and keeps time; decides when something is shown.
class PacedProgress : public Progress {
 public:
  PacedProgress(std::ostream& out, double interval, Clock clock)
      : out_(out), interval_(interval), clock_(std::move(clock)), job_start_(clock_()) {}

  void expect(std::vector<ExpectedStage> stages) override {
    const std::lock_guard lock(mutex_);
    end_stage(clock_());
    job_.expect(std::move(stages));
  }

  void stage(std::string_view name, std::uint64_t total, std::string_view unit) override {
    const std::lock_guard lock(mutex_);
    const double now = clock_();
    end_stage(now);
    job_.begin(name, unit, total, now);
    name_ = name;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    stage_start_ = now;
    in_stage_ = true;
    due_ = now + interval_;
    show_start(snapshot(now));
  }

  void advance(std::uint64_t count) override {
    done_ += count;
    const double now = clock_();
    if (now < due_)
      return;
    // A thread that comes late finds another one drawing already and goes back to work.
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || now < due_ || !in_stage_)
      return;
    due_ = now + interval_;
    show_progress(snapshot(now));
  }

  void warn(std::string_view message) override {
    const std::lock_guard lock(mutex_);
    show_warning(message);
  }

  void finish(std::string_view summary) override {
    const std::lock_guard lock(mutex_);
    const double now = clock_();
    end_stage(now);
    show_finish(summary, now - job_start_);
  }

 protected:
  std::ostream& out() { return out_; }

  virtual void show_start(const Snapshot& stage) = 0;
  virtual void show_progress(const Snapshot& stage) = 0;
  virtual void show_end(const Snapshot& stage) = 0;
  virtual void show_warning(std::string_view message) { write_warning(out(), message); }
  virtual void show_finish(std::string_view summary, double seconds) = 0;

 private:
  Snapshot snapshot(double now) {
    const std::uint64_t done = done_;
    return {name_,
            unit_,
            done,
            total_,
            now - stage_start_,
            job_.part(done),
            job_.seconds_left(done, now)};
  }

  void end_stage(double now) {
    if (!std::exchange(in_stage_, false))
      return;
    job_.end(now);
    show_end(snapshot(now));
  }

  std::ostream& out_;
  double interval_;
  Clock clock_;
  double job_start_;

  std::mutex mutex_;  ///< guards all below but the atomics
  JobProgress job_;
  std::string name_;
  std::string unit_;
  std::uint64_t total_ = 0;
  double stage_start_ = 0;
  bool in_stage_ = false;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<double> due_{0};  ///< when the next picture may be shown
};

/// Returns three digits and a letter: "980", "12.3 k", "1.23 M".
std::string short_number(double number) {
  constexpr std::array kLetters{"", " k", " M", " G", " T"};
  std::size_t letter = 0;
  // 999.5 would round to four digits.
  while (number >= 999.5 && letter + 1 < kLetters.size()) {
    number /= 1000;
    ++letter;
  }
  const bool whole = letter == 0 && std::trunc(number) == number;
  const int decimals = whole || number >= 99.95 ? 0 : number >= 9.995 ? 1 : 2;
  return fmt::format("{:.{}f}{}", number, decimals, kLetters[letter]);
}

/// Shows one line of a terminal for the whole job.
class BarProgress final : public PacedProgress {
 public:
  BarProgress(std::ostream& out, Terminal terminal, Clock clock)
      : PacedProgress(out, kBarInterval, std::move(clock)), terminal_(std::move(terminal)) {}

  ~BarProgress() override { wipe(); }

 protected:
  void show_start(const Snapshot& stage) override { redraw(stage); }
  void show_progress(const Snapshot& stage) override { redraw(stage); }
  void show_end(const Snapshot& /*stage*/) override {}
  void show_warning(std::string_view message) override {
    wipe();
    write_warning(out(), message);
  }
  void show_finish(std::string_view /*summary*/, double /*seconds*/) override { wipe(); }

 private:
  /// The last column stays free: a letter there may already wrap.
  std::size_t width() const {
    const std::size_t columns = terminal_.columns ? terminal_.columns() : 0;
    return (columns == 0 ? kUsualColumns : columns) - 1;
  }

  static std::string numbers(const Snapshot& stage) {
    if (!stage.job_part)
      return fmt::format("{} {}", short_number(static_cast<double>(stage.done)), stage.unit);
    return fmt::format(
        "{:>3} %{}", static_cast<int>(*stage.job_part * 100),
        stage.job_seconds_left ? "  " + duration_text(*stage.job_seconds_left) + " left" : "");
  }

  static std::string line(const Snapshot& stage, std::size_t width) {
    std::string text = fmt::format("{}  {}", numbers(stage), stage.name);
    constexpr std::size_t kAround = 3;  // "[] "
    if (stage.job_part && text.size() + kLeastBarWidth + kAround <= width) {
      const std::size_t bar = std::min(kBarWidth, width - text.size() - kAround);
      const auto filled = static_cast<std::size_t>(*stage.job_part * static_cast<double>(bar));
      text = fmt::format("[{:.<{}}] {}", std::string(filled, '#'), bar, text);
    }
    text.resize(std::min(text.size(), width));
    return text;
  }

  /// Blanks wipe what the line before had more.
  void redraw(const Snapshot& stage) {
    const std::size_t most = width();
    const std::string text = line(stage, most);
    const std::size_t old = std::min(shown_, most);
    out() << '\r' << text << std::string(old - std::min(old, text.size()), ' ') << std::flush;
    shown_ = text.size();
  }

  void wipe() {
    if (shown_ > 0)
      out() << '\r' << std::string(std::min(shown_, width()), ' ') << '\r' << std::flush;
    shown_ = 0;
  }

  Terminal terminal_;
  std::size_t shown_ = 0;  ///< letters on the terminal's current line
};

/// Shows nothing but warnings.
class QuietProgress final : public Progress {
 public:
  explicit QuietProgress(std::ostream& out) : out_(out) {}
  void stage(std::string_view, std::uint64_t, std::string_view) override {}
  void advance(std::uint64_t) override {}
  void warn(std::string_view message) override { write_warning(out_, message); }
  void finish(std::string_view) override {}

 private:
  std::ostream& out_;
};

/// Shows a line a stage, for files and pipes.
class PlainProgress final : public PacedProgress {
 public:
  PlainProgress(std::ostream& out, Clock clock)
      : PacedProgress(out, kBarInterval, std::move(clock)) {}

 protected:
  void show_start(const Snapshot& /*stage*/) override {}
  void show_progress(const Snapshot& /*stage*/) override {}
  void show_end(const Snapshot& stage) override {
    out() << fmt::format(
                 "{:<10} {} {} in {}\n", stage.name, short_number(static_cast<double>(stage.done)),
                 stage.done == 1 ? singular(stage.unit) : stage.unit, duration_text(stage.seconds))
          << std::flush;
  }
  void show_finish(std::string_view summary, double seconds) override {
    out() << fmt::format("{:<10} {}{}{}\n", "done", summary, summary.empty() ? "in " : ", ",
                         duration_text(seconds))
          << std::flush;
  }
};

class JsonProgress final : public PacedProgress {
 public:
  JsonProgress(std::ostream& out, Clock clock)
      : PacedProgress(out, kJsonInterval, std::move(clock)) {}

 protected:
  void show_start(const Snapshot& stage) override { write("stage_start", stage); }
  void show_progress(const Snapshot& stage) override { write("progress", stage); }
  void show_end(const Snapshot& stage) override { write("stage_end", stage); }
  void show_warning(std::string_view message) override {
    write_line({{"event", "warning"}, {"message", message}});
  }

  void show_finish(std::string_view summary, double seconds) override {
    write_line({{"event", "finish"}, {"seconds", milliseconds(seconds)}, {"summary", summary}});
  }

 private:
  using Json = nlohmann::ordered_json;

  /// Rounds to milliseconds, as finer times are noise.
  static double milliseconds(double seconds) { return std::round(seconds * 1000) / 1000; }

  static Json rounded(std::optional<double> number) {
    return number ? Json(std::round(*number * 1e4) / 1e4) : Json();
  }

  void write(std::string_view event, const Snapshot& stage) {
    const std::optional<double> left = stage.seconds_left();
    write_line({{"event", event},
                {"stage", stage.name},
                {"done", stage.done},
                {"total", stage.total == 0 ? Json() : Json(stage.total)},
                {"unit", stage.unit},
                {"rate", std::round(stage.rate())},
                {"seconds", milliseconds(stage.seconds)},
                {"eta_seconds", left ? Json(milliseconds(*left)) : Json()},
                {"job_done", rounded(stage.job_part)},
                {"job_eta_seconds", rounded(stage.job_seconds_left)}});
  }

  void write_line(const Json& event) {
    out() << storage::told_json_text(event) + '\n' << std::flush;
  }
};

}  // namespace

Clock steady_clock() {
  return [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
}

std::unique_ptr<Progress> make_progress(ProgressMode mode, std::ostream& out,
                                        const Terminal& terminal, Clock clock) {
  if (mode == ProgressMode::automatic)
    mode = terminal.is_terminal ? ProgressMode::bar : ProgressMode::none;
  switch (mode) {
    case ProgressMode::bar:
      if (terminal.is_terminal)
        return std::make_unique<BarProgress>(out, terminal, std::move(clock));
      return std::make_unique<PlainProgress>(out, std::move(clock));
    case ProgressMode::json:
      return std::make_unique<JsonProgress>(out, std::move(clock));
    case ProgressMode::automatic:
    case ProgressMode::none:
      break;
  }
  return std::make_unique<QuietProgress>(out);
}

}  // namespace meshhier::execution
