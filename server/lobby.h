// Where connections are while no thread serves them: until their request has come as a whole, and
// then until a thread is free. Who is slow to ask holds no thread.
//
// There are so many places and no more. When all are taken, the next client waits at the door
// until somebody leaves, or somebody has waited too long for a request to come: of the address
// with the most connections, whoever waits longest has to go. Threads are shared out as well: an
// address gets another one only while it has less than three times as many as are free. One
// address alone gets three of four, and there is one left for the next one.
#pragma once

#include "server/connection.h"
#include "server/connection_limits.h"

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace meshhier::server {

/// Thread-safe.
class Lobby {
 public:
  struct Size {
    std::size_t threads = 0;      ///< that call next()
    std::size_t connections = 0;  ///< in all, those that are served too
  };
  Lobby(Size size, const ConnectionLimits& limits);
  Lobby(const Lobby&) = delete;
  Lobby& operator=(const Lobby&) = delete;
  /// Requires that no other call is under way.
  ~Lobby();

  /// Takes a new client in. Waits while there is no place.
  void enter(std::unique_ptr<Connection> connection);
  /// The next one to be served: its request is whole, or none. Waits for it; null after close().
  std::unique_ptr<Connection> next();
  /// One of next() that has been served and may ask for more.
  void come_back(std::unique_ptr<Connection> connection);
  /// One of next(), of that address, that has been served and is not here any more.
  void leave(const std::string& address);

  /// Whether there is somebody who waits for a thread, or for a place.
  bool is_crowded() const;
  /// How many connections have a thread.
  std::size_t served() const;
  /// Nobody is served any more; all that are here are closed.
  void close();

 private:
  using Clock = std::chrono::steady_clock;
  struct Guest {
    std::unique_ptr<Connection> connection;
    Clock::time_point since;  ///< when it came, or the first byte of its request did
    bool has_begun = false;   ///< to speak
    bool is_ready = false;
  };
  using Guests = std::map<std::uint64_t, Guest>;  ///< by the order they came in

  void watch();
  void add(std::unique_ptr<Connection> connection);
  void hear(Guest& guest);
  void hear_those_who_speak();
  void drop_the_late();
  bool make_place();
  Guests::iterator find_victim();
  Guests::iterator find_ready();
  void wake() const;

  Size size_;
  ConnectionLimits limits_;
  mutable std::mutex mutex_;  ///< guards all below
  Guests guests_;
  std::uint64_t next_id_ = 0;
  std::map<std::string, std::size_t> served_;  ///< connections with a thread, by address
  std::size_t all_served_ = 0;
  std::size_t ready_ = 0;
  std::size_t at_the_door_ = 0;
  bool is_closed_ = false;
  std::condition_variable has_ready_, has_place_;
  int bell_;  ///< rings when there is somebody new to listen to
  std::thread thread_;
};

}  // namespace meshhier::server
