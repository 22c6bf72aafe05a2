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

/// Thread-safe. A process ends with the thread that started it.
class WorkerPool {
 public:
  struct Answer {
    bool is_good = false;
    std::vector<std::byte> bytes;  ///< else why not
  };

  /// `name`: the program's, in errors. `words`: what starts it, as ChildProcess has them; may
  /// throw.
  WorkerPool(std::string name, std::uint32_t protocol,
             std::function<std::vector<std::string>()> words);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  ~WorkerPool();

  /// Asks a process that waits, else a new one. Nothing if new ones end at this question, too.
  /// Throws Error(io) if none can be started, and what `words` throws.
  std::optional<Answer> ask(std::span<const std::uint32_t> numbers,
                            std::span<const std::byte> bytes);
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
