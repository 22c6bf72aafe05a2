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

/// One thread at a time may use it. Nothing here throws but for lack of memory; failures of the
/// socket end the conversation.
class Connection final : public httplib::Stream {
 public:
  /// Whether a slow reply to that client must end, because others wait.
  using MustYield = std::function<bool(const std::string& client)>;

  /// Hears how many bytes a client has taken.
  using Sent = std::function<void(std::size_t bytes)>;

  /// Takes the socket over. `is_stopping`: the server is to end.
  Connection(socket_t socket, const ConnectionLimits& limits, MustYield must_yield,
             std::function<bool()> is_stopping, Sent sent);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() override;

  /// The client's address; the same however often it is asked.
  const std::string& address() const { return address_; }
  /// client_key() of address().
  const std::string& client() const { return client_; }
  /// Reads the bytes that have arrived, without waiting. Returns true if next_request() may be
  /// called: a request's head is there as a whole, or none will come.
  bool read_available();
  /// Whether a part of the next request is there.
  bool has_begun() const;
  /// The number of requests so far.
  std::size_t requests() const { return requests_; }

  enum class Next {
    request,  ///< head() is the next request's
    refused,  ///< the bytes that came are none; refusal() says why
    end,      ///< the client has closed the conversation
  };
  /// Takes the next request. Requires that read_available() was true.
  Next next_request();
  const RequestHead& head() const { return head_; }
  const RefusedHead& refusal() const { return refusal_; }

  /// A piece of the body.
  struct BodyPiece {
    std::size_t bytes = 0;             ///< 0: none comes any more,
    Body::End end = Body::End::whole;  ///< because of this
  };
  /// Returns the next bytes behind the head, as far as Content-Length announced some: those that
  /// are there, else waits for the first that come, within the limits. A client that waits for it
  /// is told to go on.
  BodyPiece take_body(std::span<std::byte> bytes);
  bool is_stopping() const { return is_stopping_(); }

  /// Says that nothing more is sent. If the client may still be sending, its bytes are dropped for
  /// up to 200 ms: it could not read the reply otherwise.
  void finish();

  bool is_readable() const override { return place_ < head_.text.size(); }
  bool is_writable() const override { return !is_broken_; }
  /// Reads from the head, and nothing behind it: the library reads no bodies.
  ssize_t read(char* bytes, std::size_t count) override;
  /// Writes some bytes and returns how many, perhaps 0; -1 if the client takes too long or is gone.
  ssize_t write(const char* bytes, std::size_t count) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Waits until the socket is ready for `event`; returns false if it is not before `end`, or once
  /// `is_over` says so.
  bool wait(short event, Clock::time_point end, const std::function<bool()>& is_over) const;
  std::size_t head_begin() const;
  bool has_head() const;
  void begin_exchange();
  Next refuse(RefusedHead refusal);
  std::size_t take_received(std::span<std::byte> bytes);
  BodyPiece receive_body(std::span<std::byte> bytes);
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
  Sent sent_;
  std::string received_;  ///< not yet taken as a head
  RequestHead head_;
  RefusedHead refusal_;
  std::size_t place_ = 0;  ///< bytes that were read of the head
  std::size_t requests_ = 0;
  std::uint64_t body_left_ = 0;  ///< announced bytes that have not come
  Clock::time_point exchange_start_;
  std::size_t exchanged_bytes_ = 0;  ///< the body's, then the reply's
  bool is_broken_ = false;
  bool has_ended_ = false;   ///< the client says no more
  bool has_unread_ = false;  ///< bytes came, or may come, that are no part of a request
};

}  // namespace meshhier::server
