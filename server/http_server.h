// The server: sockets and threads around a function from requests to replies.
#pragma once

#include "server/connection_limits.h"
#include "server/http.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace meshhier::server {

struct ServerOptions {
  std::string host = "127.0.0.1";  ///< an address of this machine
  std::uint16_t port = 8080;       ///< 0: any that is free
  // A thread waits for the disk or the network most of its time, and takes some 100 KiB.
  std::size_t threads = 64;
  /// The most connections: with a file for each thread they are below the 1024 open files of a
  /// process. If it may have fewer (ulimit -n), there are fewer threads and connections.
  std::size_t most_connections = 512;
  ConnectionLimits limits{};
};

/// A request that was answered, for a log.
struct Served {
  std::string client;  ///< its address
  std::string method;
  std::string target;  ///< as sent; nobody vouches for it
  int status = 0;
  std::uint64_t bytes = 0;  ///< the body's, as announced
};

/// The connections of a server at this moment, and what went over them since it began.
struct Traffic {
  std::size_t open = 0;    ///< connections
  std::size_t served = 0;  ///< of them; each has a thread
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;  ///< closed without a reply: there were too many, or no memory
  std::uint64_t sent_bytes = 0;
};

/// For one thread; traffic() and is_lost() may be called by any.
class HttpServer {
 public:
  using Answer = std::function<Reply(const Request&)>;
  using Log = std::function<void(const Served&)>;

  /// Binds the port; connections are taken from start() on. `answer` is called by up to
  /// options.threads threads at once, and `log`, which may be empty, too. A file in a reply is read
  /// after `answer` has returned. Throws Error(io) that says what to do if the port is not to be
  /// had.
  HttpServer(const ServerOptions& options, Answer answer, Log log);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  /// Stops, as stop().
  ~HttpServer();

  std::uint16_t port() const;
  Traffic traffic() const;
  /// Starts the threads, or as many as the system gives, and returns when connections are taken.
  /// Throws std::system_error if there can be none.
  void start();
  /// Whether the system has taken the port away, and it could not be had again. Nothing is served
  /// then.
  bool is_lost() const;
  /// Stops: replies under way are cut off. Waits for the threads. May be called more than once.
  void stop();

 private:
  class Library;
  std::unique_ptr<Library> library_;
};

/// Returns "http://127.0.0.1:8080/"; for a host that stands for all addresses, the loopback's.
std::string url_of(const std::string& host, std::uint16_t port);
/// Whether `host` stands for all addresses of this machine.
bool is_every_address(const std::string& host);
/// Whether `host` is the loopback, so that only this machine reaches a server there: if so, its URL
/// has one of the names that is_loopback_name() knows.
bool is_loopback_host(const std::string& host);

}  // namespace meshhier::server
