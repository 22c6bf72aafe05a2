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
  /// The use of its standard error.
  enum class Errors {
    heard,   ///< by hear(), to be called as long as it runs: it waits once 64 KiB are not heard
    dropped  ///< as its results
  };
  /// The use of its standard input and output.
  enum class Speech {
    none,
    socket  ///< one for both: send() and receive()
  };

  /// Starts a program. `words`: its path, then its arguments. It inherits no open file. Throws
  /// Error(io) if there can be no new process; a program that is not there ends with 127.
  explicit ChildProcess(const std::vector<std::string>& words, Errors errors = Errors::heard,
                        Speech speech = Speech::none);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Kills it if it still runs, and waits for its end.
  ~ChildProcess();

  /// Appends what it has said since to `text`, 4096 bytes at most, waiting up to `longest` for it.
  /// Returns false once it has said all: it has ended, or is about to, or nobody hears it. Throws
  /// Error(io).
  bool hear(std::string& text, std::chrono::milliseconds longest);
  /// These send all `bytes`, and wait until as many have come as there is room for. They require a
  /// socket, return false if it has ended or does not listen any more, and throw Error(io).
  [[nodiscard]] bool send(std::span<const std::byte> bytes);
  [[nodiscard]] bool receive(std::span<std::byte> bytes);
  /// Asks it to stop, by SIGTERM; returns at once.
  void ask_to_stop();
  /// Waits for its end and returns its exit code; 128 + n after death by signal n. To be called
  /// once.
  int wait();

 private:
  int process_ = -1;
  int errors_ = -1;  ///< its standard error, read here; -1: dropped
  int socket_ = -1;  ///< this side of its standard input and output; -1: none
};

/// Returns the path of the program that the user starts by that name; nothing if PATH has none.
std::optional<std::string> find_program(std::string_view name);

}  // namespace meshhier::storage
