// Another program at work, heard through its standard error.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace meshhier::storage {

/// It runs in a process group of its own, so that Ctrl-C at the terminal is this program's to pass
/// on; without input; what it prints as results is dropped. It is killed when the thread that
/// started it ends, whatever ends that: it never outlives this process. One thread at a time may
/// use it.
class ChildProcess {
 public:
  /// What becomes of what it says on its standard error.
  enum class Errors {
    heard,   ///< by hear(), to be called as long as it runs: it waits once 64 KiB are not heard
    dropped  ///< as its results
  };

  /// `words`: the program's path, then its arguments. It inherits no open file. Throws Error(io) if
  /// it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& words, Errors errors = Errors::heard);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Kills it if it still runs.
  ~ChildProcess();

  /// Appends what it has said since to `text`, a few kilobytes at most, waiting up to `longest` for
  /// it. False once it has said all: it has ended, or is about to, or nobody hears it.
  bool hear(std::string& text, std::chrono::milliseconds longest);
  /// Asks it to stop, by SIGTERM.
  void ask_to_stop();
  /// Its exit code; 128 + n after death by signal n. Waits for its end.
  int wait();

 private:
  int process_ = -1;
  int errors_ = -1;  ///< its standard error, read here; -1: dropped
};

}  // namespace meshhier::storage
