// One client's socket, as the HTTP library's stream, with the limits that keep a client from
// holding a thread or memory: how long it may be silent, how much it may say, how slowly it may
// listen.
#pragma once

#include "server/connection_limits.h"
#include "server/http.h"
#include "server/request_head.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include <httplib.h>

namespace meshhier::server {

/// Of one thread at a time.
class Connection final : public httplib::Stream {
 public:
  /// Whether a slow reply to that client must end, because others wait.
  using MustYield = std::function<bool(const std::string& client)>;

  /// Takes the socket over. `is_stopping`: the server is to end.
  Connection(socket_t socket, const ConnectionLimits& limits, MustYield must_yield,
             std::function<bool()> is_stopping);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() override;

  /// Of the client; the same however often it is asked.
  const std::string& address() const { return address_; }
  /// client_key() of it.
  const std::string& client() const { return client_; }
  /// Reads what has arrived, without waiting. True if next_request() may be called: a request is
  /// there as a whole, or none will come.
  bool read_available();
  /// Whether a part of the next request is there.
  bool has_begun() const { return !received_.empty(); }
  /// How many requests there were.
  std::size_t requests() const { return requests_; }

  enum class Next {
    request,    ///< head() is the next request's
    malformed,  ///< what came is none
    too_large,
    end,  ///< of the conversation: the client has closed it
  };
  /// Requires that read_available() was true.
  Next next_request();
  const RequestHead& head() const { return head_; }

  /// What came of the body.
  struct Piece {
    std::size_t bytes = 0;             ///< 0: none comes any more,
    Body::End end = Body::End::whole;  ///< because of this
  };
  /// The next bytes behind the head, as far as Content-Length announced some: what is there, or
  /// what comes first. A client that waits for it is told to go on.
  Piece take_body(std::span<std::byte> bytes);
  bool is_stopping() const { return is_stopping_(); }

  /// Nothing more is said. If the client may still be speaking, what it says is dropped for a
  /// moment: it could not read the reply otherwise.
  void finish();

  bool is_readable() const override { return place_ < head_.text.size(); }
  bool is_writable() const override { return !is_broken_; }
  /// From the head, and nothing behind it: the library reads no bodies.
  ssize_t read(char* bytes, std::size_t count) override;
  /// -1 if the client takes too long.
  ssize_t write(const char* bytes, std::size_t count) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Whether the socket is ready for `event` before `end`; false, too, if `is_over` says so.
  bool wait(short event, Clock::time_point end, const std::function<bool()>& is_over) const;
  bool has_head() const;
  void begin_exchange();
  std::size_t take_received(std::span<std::byte> bytes);
  Piece receive_body(std::span<std::byte> bytes);
  bool invite_body();
  /// Appends what has come to received_.
  enum class Received { something, nothing_yet, end };
  Received receive();
  /// Whether it takes less than the least rate while others wait.
  bool is_too_slow() const;

  socket_t socket_;
  std::string address_, client_;
  ConnectionLimits limits_;
  MustYield must_yield_;
  std::function<bool()> is_stopping_;
  std::string received_;  ///< not yet taken as a head
  RequestHead head_;
  std::size_t place_ = 0;  ///< what was read of the head
  std::size_t requests_ = 0;
  std::uint64_t body_left_ = 0;  ///< of what was announced
  Clock::time_point exchange_start_;
  std::size_t exchanged_bytes_ = 0;  ///< of the body, then of the reply
  bool is_broken_ = false;
  bool has_ended_ = false;   ///< the client says no more
  bool has_unread_ = false;  ///< what was not taken as a request
};

}  // namespace meshhier::server
