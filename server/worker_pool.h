// A fixed number of threads for the connections, and a short queue before them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include <httplib.h>

namespace meshhier::server {

/// As the HTTP library wants it. Connections that do not fit the queue stay with the system, which
/// keeps them without an open file of ours.
class WorkerPool final : public httplib::TaskQueue {
 public:
  /// `waiting`: counts the tasks that have no thread yet; outlives this.
  WorkerPool(std::size_t threads, std::size_t most_waiting, std::atomic<std::size_t>& waiting);

  /// Waits while the queue is full.
  void enqueue(std::function<void()> task) override;
  /// Ends when all tasks have.
  void shutdown() override;

 private:
  void work();

  std::size_t most_waiting_;
  std::atomic<std::size_t>& waiting_;
  std::mutex mutex_;  ///< guards the next two
  std::deque<std::function<void()>> tasks_;
  bool is_ending_ = false;
  std::condition_variable has_task_, has_room_;
  std::vector<std::thread> threads_;
};

}  // namespace meshhier::server
