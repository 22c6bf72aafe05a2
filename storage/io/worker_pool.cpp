#include "storage/io/worker_pool.h"

#include "base/error.h"
#include "storage/io/child_process.h"

#include <array>
#include <string>
#include <utility>

namespace meshhier::storage {

class WorkerPool::Worker {
 public:
  explicit Worker(const std::vector<std::string>& words)
      : process_(words, ChildProcess::Errors::dropped, ChildProcess::Speech::socket) {}

  /// Waits for its greeting; returns false if that is another one, or the process ended.
  bool is_ready(std::uint32_t protocol) {
    std::uint32_t said = 0;
    return process_.receive(std::as_writable_bytes(std::span(&said, 1))) && said == protocol;
  }

  /// Returns nothing if the process has ended.
  std::optional<Answer> ask(std::span<const std::uint32_t> numbers,
                            std::span<const std::byte> bytes, std::uint64_t most_bytes) {
    std::array<std::uint32_t, 2> head{};  // status, bytes
    if (!process_.send(std::as_bytes(numbers)) || !process_.send(bytes) ||
        !process_.receive(std::as_writable_bytes(std::span(head))))
      return std::nullopt;
    if (head[1] > most_bytes) {
      throw Error(ErrorCode::budget, "what is read takes " + std::to_string(head[1]) +
                                         " bytes of memory, and there are " +
                                         std::to_string(most_bytes) +
                                         "; give a larger memory_budget");
    }
    Answer answer{head[0] == 0, std::vector<std::byte>(head[1])};
    if (!process_.receive(answer.bytes))
      return std::nullopt;
    return answer;
  }

 private:
  ChildProcess process_;
};

WorkerPool::WorkerPool(std::string name, std::uint32_t protocol,
                       std::function<std::vector<std::string>()> words)
    : name_(std::move(name)), protocol_(protocol), words_(std::move(words)) {}

WorkerPool::~WorkerPool() = default;

std::optional<WorkerPool::Answer> WorkerPool::ask(std::span<const std::uint32_t> numbers,
                                                  std::span<const std::byte> bytes,
                                                  std::uint64_t most_bytes) {
  constexpr int kNewOnes = 2;  // somebody may have killed the others, and the first of these
  for (int tried = 0; tried < kNewOnes;) {
    std::unique_ptr<Worker> worker = take_idle();
    if (!worker) {
      worker = start();
      ++tried;
    }
    if (std::optional<Answer> answer = worker->ask(numbers, bytes, most_bytes)) {
      if (answer->is_good) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(worker));
      }
      return answer;
    }
  }
  return std::nullopt;
}

void WorkerPool::end_idle() {
  const std::lock_guard lock(mutex_);
  idle_.clear();
}

std::unique_ptr<WorkerPool::Worker> WorkerPool::take_idle() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty())
    return nullptr;
  std::unique_ptr<Worker> last = std::move(idle_.back());
  idle_.pop_back();
  return last;
}

std::unique_ptr<WorkerPool::Worker> WorkerPool::start() const {
  const std::vector<std::string> words = words_();
  auto worker = std::make_unique<Worker>(words);
  if (worker->is_ready(protocol_))
    return worker;
  std::string line;
  for (const std::string& word : words)
    line += line.empty() ? word : ' ' + word;
  throw Error(ErrorCode::io, name_ + " does not start; \"" + line + "\" in a terminal says more");
}

}  // namespace meshhier::storage
