#include "server/http_server.h"

#include "base/error.h"
#include "server/conditions.h"
#include "server/connection.h"
#include "server/connection_body.h"
#include "server/connection_queue.h"
#include "server/http_messages.h"
#include "storage/io/open_files.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

namespace meshhier::server {
namespace {

/// Connections that the system keeps until we take them; the library asks for 5, and more than a
/// handful of clients at once would wait a second for their next try. Linux grants 4096 at most.
constexpr int kBacklog = 4096;

/// After so many a connection is closed; more would only keep a thread from others.
constexpr std::size_t kMostRequests = 10'000;

/// Files that are open besides connections and those that they read: standard streams, folders, the
/// port, kept archives (hierarchies.cpp).
constexpr std::size_t kOwnFiles = 24;
/// Files that a thread has open at once while it looks for a file, or stores one.
constexpr std::size_t kFilesOfThread = 4;

/// Returns the options with as many threads and connections as the open files of this process
/// allow: a request that finds none left could only be told to come again.
ServerOptions fitted(ServerOptions options) {
  const std::size_t files =
      std::max<std::size_t>(storage::most_open_files(), kOwnFiles) - kOwnFiles;
  const std::size_t threads = std::max<std::size_t>(files / (2 * kFilesOfThread), 1);
  options.threads = std::min(options.threads, threads);
  const std::size_t left = files - std::min(files, options.threads * kFilesOfThread);
  options.most_connections = std::min(options.most_connections, std::max(left, options.threads));
  return options;
}

[[noreturn]] void refuse_port(const ServerOptions& options, int error) {
  const std::string place = fmt::format("port {} of {}", options.port, options.host);
  if (error == EADDRINUSE) {
    throw Error(ErrorCode::io, fmt::format("{} is in use: choose another one with --port, or any "
                                           "that is free with --port 0",
                                           place));
  }
  throw Error(ErrorCode::io,
              fmt::format("cannot listen on {}: {}; --host must be an address of this machine, and "
                          "ports below 1024 are the system's",
                          place, error == 0 ? "no such host" : std::strerror(error)));
}

/// Returns a host as URLs have it: IPv6 addresses in brackets.
std::string in_url(const std::string& host) {
  return host.find(':') == std::string::npos ? host : '[' + host + ']';
}

/// Runs a task at once: it only puts the accepted connection into the queue.
class InlineTaskQueue final : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> task) override { task(); }
  void shutdown() override {}
};

/// The exchange that this thread is at: facts that the library does not pass on.
struct Exchange {
  Body* body = nullptr;          ///< the request's
  bool ends_connection = false;  ///< the reply is the last one
};
thread_local Exchange exchange;

}  // namespace

/// The library's server, with connections of ours: as the library's own server for TLS, it takes
/// over where a connection is accepted.
class HttpServer::Library final : public httplib::Server {
 public:
  Library(const ServerOptions& options, Answer answer, Log log)
      : options_(fitted(options)),
        answer_(std::move(answer)),
        log_(std::move(log)),
        queue_({options_.threads, options_.most_connections}, options.limits) {
    set_up();
    bind();
  }
  ~Library() override { end(); }

  std::uint16_t port() const { return port_; }
  bool is_lost() const { return is_lost_; }
  Traffic traffic() const {
    const ConnectionQueue::Load load = queue_.load();
    return {load.pending + load.served, load.served, accepted_, load.refused + failed_,
            sent_bytes_};
  }

  void begin() {
    thread_ = std::thread([this] { run(); });
    add_workers();
    while (!is_running())
      std::this_thread::yield();
  }

  /// Starts as many threads as there are to be had; throws if there is none.
  void add_workers() {
    try {
      while (workers_.size() < options_.threads)
        workers_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      if (workers_.empty())
        throw;
    }
  }

  void end() {
    is_stopping_ = true;
    if (!is_running())
      close_socket();
    stop();
    queue_.close();
    if (thread_.joinable())
      thread_.join();
    for (std::thread& worker : workers_)
      worker.join();
    workers_.clear();
  }

 private:
  /// Takes connections until the end. The library gives its socket up for good if accept() tells of
  /// trouble in the network, so it is bound again.
  void run() {
    listen_after_bind();
    while (!is_stopping_ && bind_again())
      listen_after_bind();
  }

  /// Returns false if it is to end, or the port is lost.
  bool bind_again() {
    try {
      options_.port = port_;
      bind();
    } catch (const Error&) {
      is_lost_ = true;
      return false;
    }
    if (is_stopping_)  // end() may have come too early to see the socket
      close_socket();
    return !is_stopping_;
  }

  void close_socket() {
    const socket_t socket = svr_sock_.exchange(INVALID_SOCKET);
    if (socket != INVALID_SOCKET)
      ::close(socket);
  }

  void set_up() {
    new_task_queue = [] { return new InlineTaskQueue; };
    set_tcp_nodelay(true);
    // By the library's default two servers share a port without knowing.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      put(answer_(request_of(request, exchange.body)), response);
      return HandlerResponse::Handled;
    });
    set_post_routing_handler([](const httplib::Request&, httplib::Response& response) {
      response.headers.erase("Keep-Alive");
      // It is not certain any more where one request ends and the next one begins.
      exchange.ends_connection = response.status == 400;
      if (exchange.ends_connection && !response.has_header("Connection"))
        response.set_header("Connection", "close");
      response.set_header("Date", http_date(std::chrono::system_clock::now()));
      if (response.status == 304 || response.status == 204)
        response.headers.erase("Content-Length");
    });
    if (log_)
      set_logger(
          [this](const auto& request, const auto& response) { log_request(request, response); });
  }

  void bind() {
    errno = 0;
    const int port = options_.port == 0                           ? bind_to_any_port(options_.host)
                     : bind_to_port(options_.host, options_.port) ? options_.port
                                                                  : -1;
    if (port < 0)
      refuse_port(options_, errno);
    port_ = static_cast<std::uint16_t>(port);
    ::listen(svr_sock_, kBacklog);
  }

  void log_request(const httplib::Request& request, const httplib::Response& response) {
    log_({request.remote_addr, request.method, request.target, response.status,
          response.content_length_});
  }

  /// Takes a new connection over. If memory runs out the connection ends, and the server goes on.
  bool process_and_close_socket(socket_t socket) override {
    bool is_owned = false;
    try {
      auto connection = std::make_unique<Connection>(
          socket, options_.limits,
          [this](const std::string& client) { return queue_.must_yield(client); },
          [this] { return is_stopping_.load(); },
          [this](std::size_t bytes) { sent_bytes_ += bytes; });
      is_owned = true;
      ++accepted_;
      queue_.accept(std::move(connection));
    } catch (const std::exception&) {
      if (!is_owned)
        ::close(socket);
      ++failed_;
      return false;
    }
    return true;
  }

  void work() {
    while (std::unique_ptr<Connection> connection = queue_.next()) {
      if (serve_request_guarded(*connection)) {
        queue_.return_connection(std::move(connection));
      } else {
        connection->finish();
        queue_.close_connection(std::move(connection));
      }
    }
  }

  /// Does the same as serve_request(), but if memory runs out the connection ends, and the server
  /// goes on.
  bool serve_request_guarded(Connection& connection) {
    try {
      return serve_request(connection);
    } catch (const std::exception&) {
      return false;
    }
  }

  /// Reads one request and sends the reply; returns false if it was the last one.
  bool serve_request(Connection& connection) {
    switch (connection.next_request()) {
      case Connection::Next::request:
        break;
      case Connection::Next::refused:
        return refuse(connection);
      case Connection::Next::end:
        return false;
    }
    const RequestHead& head = connection.head();
    const bool closes = head.is_last || connection.requests() == kMostRequests || head.has_body ||
                        queue_.has_waiting_accepts();
    bool client_closes = false;
    const auto add_range = [&](httplib::Request& request) {
      if (head.range)
        request.set_header("Range", *head.range);
    };
    ConnectionBody body(connection, head.body_bytes.value_or(0));
    exchange = {.body = head.body_bytes ? &body : nullptr};
    const bool is_sent = process_request(connection, closes, client_closes, add_range);
    return is_sent && !closes && !client_closes && !exchange.ends_connection && !is_stopping_;
  }

  /// Refuses bytes that are no request, for which "-" stands in the log.
  bool refuse(Connection& connection) {
    const RefusedHead& refusal = connection.refusal();
    const std::string body = refusal.why + '\n';
    const std::string reply = fmt::format(
        "HTTP/1.1 {} {}\r\nDate: {}\r\nConnection: close\r\nCache-Control: no-store\r\n"
        "Content-Type: text/plain; charset=utf-8\r\nContent-Length: {}\r\n\r\n{}",
        refusal.status, refusal.reason, http_date(std::chrono::system_clock::now()), body.size(),
        body);
    connection.write(reply.data(), reply.size());
    if (log_)
      log_({connection.address(), "-", "-", refusal.status, body.size()});
    return false;
  }

  ServerOptions options_;
  Answer answer_;
  Log log_;
  std::uint16_t port_ = 0;
  std::atomic<bool> is_stopping_{false};
  std::atomic<bool> is_lost_{false};
  std::atomic<std::uint64_t> accepted_{0}, failed_{0}, sent_bytes_{0};
  ConnectionQueue queue_;
  std::thread thread_;
  std::vector<std::thread> workers_;
};

HttpServer::HttpServer(const ServerOptions& options, Answer answer, Log log)
    : library_(std::make_unique<Library>(options, std::move(answer), std::move(log))) {}

HttpServer::~HttpServer() = default;

std::uint16_t HttpServer::port() const {
  return library_->port();
}

Traffic HttpServer::traffic() const {
  return library_->traffic();
}

bool HttpServer::is_lost() const {
  return library_->is_lost();
}

void HttpServer::start() {
  library_->begin();
}

void HttpServer::stop() {
  library_->end();
}

std::string url_of(const std::string& host, std::uint16_t port) {
  if (is_every_address(host))
    return url_of("127.0.0.1", port);
  return fmt::format("http://{}:{}/", in_url(host), port);
}

bool is_every_address(const std::string& host) {
  return host == "0.0.0.0" || host == "::";
}

bool is_loopback_host(const std::string& host) {
  return is_loopback_name(in_url(host));
}

}  // namespace meshhier::server
