// Other programs that work for this one: processes that wait for questions, each for one at a time.
//
// A program is spoken with by one socket, its standard input and output, and ends when that is
// closed, or after a failure. Numbers are unsigned, 32 bits, little endian:
//
//   greeting   the protocol's number, once it is ready
//   question   numbers, the last one how many bytes follow; then the bytes
//   answer     0, byte count, then the bytes
//           or 1, byte count, then why there is none, in UTF-8
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// A pool grows to as many processes as threads ask at once, and keeps them for later questions.
/// Thread-safe: each question has a process for itself. A process ends with the thread that started
/// it, so threads that end cost no more than a new process.
class WorkerPool {
 public:
  struct Answer {
    bool is_good = false;
    std::vector<std::byte> bytes;  ///< the answer, or in UTF-8 why there is none
  };

  /// Starts no process yet. `name`: the program's, in errors. `protocol`: the number that it greets
  /// with. `words`: returns the words that start it, as ChildProcess takes them; may throw.
  WorkerPool(std::string name, std::uint32_t protocol,
             std::function<std::vector<std::string>()> words);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  ~WorkerPool();

  /// Asks a process that waits, else a new one, and waits for the answer. Returns nothing if two
  /// new ones have ended at this question. Throws Error(io) if none can be started, Error(budget)
  /// if the answer has more than `most_bytes`, and what `words` throws. `numbers`: the last one is
  /// bytes.size().
  std::optional<Answer> ask(std::span<const std::uint32_t> numbers,
                            std::span<const std::byte> bytes,
                            std::uint64_t most_bytes = UINT32_MAX);
  /// Ends the processes that wait.
  void end_idle();

 private:
  class Worker;

  std::unique_ptr<Worker> take_idle();
  std::unique_ptr<Worker> start() const;

  std::string name_;
  std::uint32_t protocol_;
  std::function<std::vector<std::string>()> words_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Worker>> idle_;
};

}  // namespace meshhier::storage
