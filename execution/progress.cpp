#include "execution/progress.h"

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
/// Narrower than any terminal of today, so that "\r" always returns to the line's start.
constexpr std::size_t kLineWidth = 79;

/// A stage at one moment.
struct Snapshot {
  std::string_view name;
  std::string_view unit;
  std::uint64_t done = 0;
  std::uint64_t total = 0;  ///< 0: unknown
  double seconds = 0;

  double rate() const { return seconds > 0 ? static_cast<double>(done) / seconds : 0; }
  std::optional<double> seconds_left() const {
    if (total == 0 || rate() <= 0)
      return std::nullopt;
    return static_cast<double>(total - std::min(done, total)) / rate();
  }
};

/// Counts and keeps time; says what is to be shown, and when.
class PacedProgress : public Progress {
 public:
  PacedProgress(std::ostream& out, double interval, Clock clock)
      : out_(out), interval_(interval), clock_(std::move(clock)), job_start_(clock_()) {}

  void stage(std::string_view name, std::uint64_t total, std::string_view unit) override {
    const std::lock_guard lock(mutex_);
    const double now = clock_();
    end_stage(now);
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
    // Whoever is late finds another thread drawing already and goes back to work.
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || now < due_ || !in_stage_)
      return;
    due_ = now + interval_;
    show_progress(snapshot(now));
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
  virtual void show_finish(std::string_view summary, double seconds) = 0;

 private:
  Snapshot snapshot(double now) const { return {name_, unit_, done_, total_, now - stage_start_}; }

  void end_stage(double now) {
    if (std::exchange(in_stage_, false))
      show_end(snapshot(now));
  }

  std::ostream& out_;
  double interval_;
  Clock clock_;
  double job_start_;

  std::mutex mutex_;  ///< guards all below but the atomics
  std::string name_;
  std::string unit_;
  std::uint64_t total_ = 0;
  double stage_start_ = 0;
  bool in_stage_ = false;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<double> due_{0};  ///< when the next picture may be shown
};

/// Three digits and a letter: "980", "12.3 k", "1.23 M".
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

std::string duration_text(double seconds) {
  if (seconds < 9.95)
    return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::uint64_t>(std::llround(std::min(seconds, 1e9)));
  if (whole < 60)
    return fmt::format("{} s", whole);
  if (whole < 3600)
    return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

class BarProgress final : public PacedProgress {
 public:
  BarProgress(std::ostream& out, Clock clock)
      : PacedProgress(out, kBarInterval, std::move(clock)) {}

  ~BarProgress() override {
    if (shown_ > 0)
      out() << '\n' << std::flush;
  }

 protected:
  void show_start(const Snapshot& stage) override { redraw(line(stage)); }
  void show_progress(const Snapshot& stage) override { redraw(line(stage)); }

  void show_end(const Snapshot& stage) override {
    redraw(fmt::format("{:<10} {} {} in {}", stage.name,
                       short_number(static_cast<double>(stage.done)), stage.unit,
                       duration_text(stage.seconds)));
    out() << '\n' << std::flush;
    shown_ = 0;
  }

  void show_finish(std::string_view summary, double seconds) override {
    out() << fmt::format("{:<10} {}{}{}\n", "done", summary, summary.empty() ? "in " : ", ",
                         duration_text(seconds))
          << std::flush;
  }

 private:
  static std::string line(const Snapshot& stage) {
    const std::string rate = fmt::format("{} {}/s", short_number(stage.rate()), stage.unit);
    if (stage.total == 0) {
      return fmt::format("{:<10} {} {}  {}", stage.name,
                         short_number(static_cast<double>(stage.done)), stage.unit, rate);
    }
    const double part =
        std::min(1.0, static_cast<double>(stage.done) / static_cast<double>(stage.total));
    const auto filled = static_cast<std::size_t>(part * static_cast<double>(kBarWidth));
    const std::optional<double> left = stage.seconds_left();
    return fmt::format("{:<10} [{:.<{}}] {:>3} %  {}{}", stage.name, std::string(filled, '#'),
                       kBarWidth, static_cast<int>(part * 100), rate,
                       left ? "  " + duration_text(*left) + " left" : "");
  }

  /// Blanks wipe what the line before had more.
  void redraw(std::string text) {
    text.resize(std::min(text.size(), kLineWidth));
    out() << '\r' << text << std::string(shown_ - std::min(shown_, text.size()), ' ') << std::flush;
    shown_ = text.size();
  }

  std::size_t shown_ = 0;  ///< letters on the terminal's current line
};

class JsonProgress final : public PacedProgress {
 public:
  JsonProgress(std::ostream& out, Clock clock)
      : PacedProgress(out, kJsonInterval, std::move(clock)) {}

 protected:
  void show_start(const Snapshot& stage) override { write("stage_start", stage); }
  void show_progress(const Snapshot& stage) override { write("progress", stage); }
  void show_end(const Snapshot& stage) override { write("stage_end", stage); }

  void show_finish(std::string_view summary, double seconds) override {
    write_line({{"event", "finish"}, {"seconds", milliseconds(seconds)}, {"summary", summary}});
  }

 private:
  using Json = nlohmann::ordered_json;

  /// Finer times are noise.
  static double milliseconds(double seconds) { return std::round(seconds * 1000) / 1000; }

  void write(std::string_view event, const Snapshot& stage) {
    const std::optional<double> left = stage.seconds_left();
    write_line({{"event", event},
                {"stage", stage.name},
                {"done", stage.done},
                {"total", stage.total == 0 ? Json() : Json(stage.total)},
                {"unit", stage.unit},
                {"rate", std::round(stage.rate())},
                {"seconds", milliseconds(stage.seconds)},
                {"eta_seconds", left ? Json(milliseconds(*left)) : Json()}});
  }

  void write_line(const Json& event) {
    out() << event.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n' << std::flush;
  }
};

}  // namespace

Clock steady_clock() {
  return [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
}

std::unique_ptr<Progress> make_progress(ProgressMode mode, std::ostream& out, bool is_terminal,
                                        Clock clock) {
  if (mode == ProgressMode::automatic)
    mode = is_terminal ? ProgressMode::bar : ProgressMode::none;
  switch (mode) {
    case ProgressMode::bar:
      return std::make_unique<BarProgress>(out, std::move(clock));
    case ProgressMode::json:
      return std::make_unique<JsonProgress>(out, std::move(clock));
    case ProgressMode::automatic:
    case ProgressMode::none:
      break;
  }
  return std::make_unique<NoProgress>();
}

}  // namespace meshhier::execution
