// The rules by which a pending connection is served next, or closed to make room, without sockets,
// threads or a clock.
//
// The number of connections is limited. When all are in use, the next client waits until one is
// closed, or until a pending one has had no whole request for too long: of the client with the most
// connections, the oldest. Threads are shared out as well: a client gets another one only while it
// has less than three times as many as are free. One client alone gets three of four threads.
#pragma once

#include "server/connection.h"
#include "server/connection_limits.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace meshhier::server {

/// A connection that no thread serves.
struct PendingConnection {
  std::unique_ptr<Connection> connection{};
  std::string client{};                           ///< client_key() of its address
  std::chrono::steady_clock::time_point since{};  ///< its arrival, or a request's first byte
  bool has_begun = false;                         ///< a part of a request is there
  bool is_ready = false;                          ///< to be served
};

/// Deterministic; not thread-safe. Never looks into a `connection`.
class ConnectionSchedule {
 public:
  using Clock = std::chrono::steady_clock;
  using Id = std::uint64_t;  ///< ascending in the order of add()

  struct Size {
    std::size_t threads = 0;
    std::size_t connections = 0;  ///< pending and served
  };
  ConnectionSchedule(Size size, const ConnectionLimits& limits);

  Id add(PendingConnection connection);
  /// The pending ones; they may be changed until they are taken.
  std::map<Id, PendingConnection>& pending() { return pending_; }
  const std::map<Id, PendingConnection>& pending() const { return pending_; }

  /// Whether a pending connection may be served now.
  bool has_next() const;
  /// Takes the oldest that may be served now, which then counts as served; nothing if there is
  /// none.
  std::optional<PendingConnection> take_next();
  /// Says that one of that client is served no more.
  void release(const std::string& client);
  std::size_t served() const { return all_served_; }
  /// Returns how many make_room() has closed so far.
  std::uint64_t refused() const { return refused_; }

  /// Whether a slow reply to `client` keeps a ready connection from a thread. It only yields to
  /// clients that have no more threads than `client`.
  bool must_yield(const std::string& client) const;

  /// Returns whether there is room for a new connection. If all are in use, closes a pending one
  /// that has waited too long, if there is any.
  bool make_room(Clock::time_point now);
  /// Closes those that had their time for a request. Returns true if there was one.
  bool drop_timed_out(Clock::time_point now);

 private:
  using Pending = std::map<Id, PendingConnection>;

  std::size_t served_to(const std::string& client) const;
  bool may_serve(const PendingConnection& connection) const;
  Pending::const_iterator find_next() const;
  Pending::const_iterator find_victim() const;

  Size size_;
  ConnectionLimits limits_;
  Pending pending_;
  Id next_id_ = 0;
  std::map<std::string, std::size_t> served_;  ///< connections with a thread, by client
  std::size_t all_served_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace meshhier::server
