#include "execution/threads.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/info.h>

namespace meshhier::execution {

std::size_t startable_threads(std::size_t wanted) {
  std::atomic<bool> is_over{false};
  std::vector<std::thread> threads;
  try {
    threads.reserve(wanted);
    while (threads.size() < wanted)
      threads.emplace_back([&is_over] { is_over.wait(false); });
  } catch (const std::exception&) {  // there are no more
  }
  is_over = true;
  is_over.notify_all();
  for (std::thread& thread : threads)
    thread.join();
  return threads.size();
}

void limit_threads_to_startable() {
  const auto wanted = static_cast<std::size_t>(tbb::info::default_concurrency()) - 1;
  const std::size_t others = startable_threads(wanted);
  if (others == wanted)
    return;
  // The system counts threads that have ended for a moment longer.
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  // It stays: at its end TBB would start the others.
  [[maybe_unused]] static const auto* const limit =
      new tbb::global_control(tbb::global_control::max_allowed_parallelism, others + 1);
}

std::future<void> run_beside(std::function<void()> work) {
  try {
    return std::async(std::launch::async, work);
  } catch (const std::system_error&) {
    std::packaged_task<void()> task(std::move(work));
    task();
    return task.get_future();
  }
}

std::string thread_failure(const std::exception& error) {
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  const bool is_of_system =
      system != nullptr && (system->code() == std::errc::resource_unavailable_try_again ||
                            system->code() == std::errc::not_enough_memory);
  // TBB throws this as a std::runtime_error.
  if (!is_of_system && !std::string_view(error.what()).starts_with("pthread_create"))
    return "";
  return "the system gives no more threads; raise its limit of processes (ulimit -u, or that of "
         "the container) or of memory (ulimit -v), or end other programs";
}

}  // namespace meshhier::execution
