#include "server/worker_pool.h"

#include <utility>

namespace meshhier::server {

WorkerPool::WorkerPool(std::size_t threads, std::size_t most_waiting,
                       std::atomic<std::size_t>& waiting)
    : most_waiting_(most_waiting), waiting_(waiting) {
  for (std::size_t i = 0; i < threads; ++i)
    threads_.emplace_back([this] { work(); });
}

void WorkerPool::enqueue(std::function<void()> task) {
  std::unique_lock lock(mutex_);
  has_room_.wait(lock, [&] { return tasks_.size() < most_waiting_; });
  tasks_.push_back(std::move(task));
  waiting_ = tasks_.size();
  has_task_.notify_one();
}

void WorkerPool::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  has_task_.notify_all();
  for (std::thread& thread : threads_)
    thread.join();
}

void WorkerPool::work() {
  for (;;) {
    std::unique_lock lock(mutex_);
    has_task_.wait(lock, [&] { return is_ending_ || !tasks_.empty(); });
    if (tasks_.empty())
      return;
    const std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    waiting_ = tasks_.size();
    lock.unlock();
    has_room_.notify_one();
    task();
  }
}

}  // namespace meshhier::server
