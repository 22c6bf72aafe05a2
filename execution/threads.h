// The threads that the system gives this process.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <future>
#include <string>

namespace meshhier::execution {

/// Starts up to `wanted` threads at once, which do nothing, and ends them. Returns how many the
/// system has given. Thread-safe; takes some 20 microseconds a thread.
std::size_t startable_threads(std::size_t wanted);

/// Limits parallel work to as many threads as can be started, to the end of the process: a limit of
/// processes or of memory may leave fewer than there are processors. Call it once, before any
/// parallel work.
void limit_threads_to_startable();

/// Runs `work` beside the caller, or, if no thread is to be had, before it returns. The future
/// throws what `work` throws, and waits for its end when it is destroyed.
std::future<void> run_beside(std::function<void()> work);

/// Returns a message if an exception says that no thread can be started; "" if it does not.
std::string thread_failure(const std::exception& error);

}  // namespace meshhier::execution
