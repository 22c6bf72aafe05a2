// Measures the part of a computation that goes one step after another: time that more threads
// cannot shorten.
#pragma once

#include <algorithm>
#include <atomic>

namespace meshhier::execution {

/// Returns the CPU seconds of this thread's work that went one step after another: its own outside
/// of parallel calls (parallel.h), and the longest chain of each such call: its reads, its sinks or
/// one piece of its work. By Amdahl's law no number of threads does the work in less.
double serial_seconds();

/// Returns the CPU seconds of the calling thread.
double thread_cpu_seconds();

/// The time of steps that go one after another; or, by count_longest(), beside each other.
class StepTime {
 public:
  /// Runs step() and adds the time that it took.
  template <class Step>
  auto count(const Step& step) {
    const Measured measured(*this, &StepTime::add);
    return step();
  }
  /// Runs step(), which others may run beside, and keeps the longest. Thread-safe.
  template <class Step>
  auto count_longest(const Step& step) {
    const Measured measured(*this, &StepTime::keep_longest);
    return step();
  }
  double seconds() const { return seconds_; }

 private:
  class Measured {
   public:
    Measured(StepTime& time, void (StepTime::*take)(double))
        : time_(time), take_(take), begun_(thread_cpu_seconds()) {}
    Measured(const Measured&) = delete;
    Measured& operator=(const Measured&) = delete;
    ~Measured() { (time_.*take_)(thread_cpu_seconds() - begun_); }

   private:
    StepTime& time_;
    void (StepTime::*take_)(double);
    double begun_;
  };

  void add(double seconds) { seconds_ = seconds_ + seconds; }
  void keep_longest(double seconds) {
    double longest = seconds_;
    while (seconds > longest && !seconds_.compare_exchange_weak(longest, seconds)) {
    }
  }

  std::atomic<double> seconds_ = 0;
};

/// Stands for a parallel call while it lives. If calls are within calls on one thread, the
/// outermost counts.
class ParallelCall {
 public:
  ParallelCall();
  ParallelCall(const ParallelCall&) = delete;
  ParallelCall& operator=(const ParallelCall&) = delete;
  ~ParallelCall();

  StepTime reads, work, sinks;

 private:
  double begun_;
};

}  // namespace meshhier::execution
