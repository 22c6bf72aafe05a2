// Connections that no thread serves: a thread gets one when its request is whole. A client that
// sends slowly holds no thread. connection_schedule.h has the rules.
#pragma once

#include "server/connection.h"
#include "server/connection_limits.h"
#include "server/connection_schedule.h"

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace meshhier::server {

/// Holds the pending connections and hands them out. Thread-safe.
class ConnectionQueue {
 public:
  /// `size.threads` call next().
  ConnectionQueue(ConnectionSchedule::Size size, const ConnectionLimits& limits);
  ConnectionQueue(const ConnectionQueue&) = delete;
  ConnectionQueue& operator=(const ConnectionQueue&) = delete;
  /// Requires that no other call is under way.
  ~ConnectionQueue();

  /// Adds a new connection. Waits while there are too many.
  void accept(std::unique_ptr<Connection> connection);
  /// Waits for the next one to be served and returns it: its request is whole, or none will come.
  /// Returns null after close().
  std::unique_ptr<Connection> next();
  /// Gives back one of next() that was served and may bring another request.
  void return_connection(std::unique_ptr<Connection> connection);
  /// Closes one of next().
  void close_connection(std::unique_ptr<Connection> connection);

  /// Whether a new connection waits until another one is closed.
  bool has_waiting_accepts() const;
  /// Whether a slow reply to `client` must end: a new connection waits, or a ready one by the rule
  /// of ConnectionSchedule::must_yield().
  bool must_yield(const std::string& client) const;
  struct Load {
    std::size_t pending = 0;
    std::size_t served = 0;     ///< these have a thread
    std::uint64_t refused = 0;  ///< closed so far to make room for others
  };
  Load load() const;
  /// Serves nobody any more, and closes all pending connections.
  void close();

 private:
  using Clock = ConnectionSchedule::Clock;

  void watch();
  void add(std::unique_ptr<Connection> connection);
  static void read_available(PendingConnection& pending);
  void poll_pending();
  void offer_next();
  void wake_poll() const;

  mutable std::mutex mutex_;  ///< guards all below
  ConnectionSchedule schedule_;
  std::size_t waiting_accepts_ = 0;
  bool is_closed_ = false;
  std::condition_variable has_next_, has_room_;
  int wakeup_fd_;  ///< an eventfd that ends poll() when there is a new socket
  std::thread thread_;
};

}  // namespace meshhier::server
