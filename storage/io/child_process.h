// Another program at work, heard through its standard error, or spoken with.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// It runs in a process group of its own, so that Ctrl-C at the terminal is this program's to pass
/// on; unless it is spoken with, without input, and what it prints as results is dropped. It is
/// killed when the thread that started it ends, whatever ends that: it never outlives this process.
/// One thread at a time may use it.
class ChildProcess {
 public:
  /// What becomes of what it says on its standard error.
  enum class Errors {
    heard,   ///< by hear(), to be called as long as it runs: it waits once 64 KiB are not heard
    dropped  ///< as its results
  };
  /// What its standard input and output are.
  enum class Speech {
    none,
    socket  ///< one for both: send() and receive()
  };

  /// `words`: the program's path, then its arguments. It inherits no open file. Throws Error(io) if
  /// it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& words, Errors errors = Errors::heard,
                        Speech speech = Speech::none);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Kills it if it still runs.
  ~ChildProcess();

  /// Appends what it has said since to `text`, a few kilobytes at most, waiting up to `longest` for
  /// it. False once it has said all: it has ended, or is about to, or nobody hears it.
  bool hear(std::string& text, std::chrono::milliseconds longest);
  /// Says all of that, or hears as many bytes as there is room for. Require a socket; false if it
  /// has ended, or does not listen any more. Throw Error(io).
  [[nodiscard]] bool send(std::span<const std::byte> bytes);
  [[nodiscard]] bool receive(std::span<std::byte> bytes);
  /// Asks it to stop, by SIGTERM.
  void ask_to_stop();
  /// Its exit code; 128 + n after death by signal n. Waits for its end.
  int wait();

 private:
  int process_ = -1;
  int errors_ = -1;  ///< its standard error, read here; -1: dropped
  int socket_ = -1;  ///< what it is spoken with by; -1: nothing
};

/// The path of a program that the user can start by that name; none: PATH has none.
std::optional<std::string> find_program(std::string_view name);

}  // namespace meshhier::storage
