// One client's socket, as the HTTP library's stream, with the limits that keep a client from
// holding a thread or memory: how long it may be silent, how much it may say, how slowly it may
// listen.
#pragma once

#include "server/connection_limits.h"
#include "server/request_head.h"

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include <httplib.h>

namespace meshhier::server {

/// Of one thread.
class Connection final : public httplib::Stream {
 public:
  /// `has_high_valence`: others wait for a thread; `is_stopping`: the server is to end.
  Connection(socket_t socket, const ConnectionLimits& limits,
             std::function<bool()> has_high_valence, std::function<bool()> is_stopping);

  enum class Next {
    request,    ///< head() is the next request's
    malformed,  ///< what came is none
    too_large,
    end,  ///< of the conversation: the client has closed it, or is too slow
  };
  /// Waits for the next request and reads its head.
  Next next_request();
  const RequestHead& head() const { return head_; }

  /// Closes the socket. If the client may still be speaking, what it says is dropped for a moment:
  /// it could not read the reply otherwise.
  void close();

  bool is_readable() const override { return place_ < head_.text.size(); }
  bool is_writable() const override { return !is_broken_; }
  /// From the head, and nothing behind it: bodies are refused.
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
  bool wait_for_first_byte();
  /// Bytes of the head that received_ begins with; 0 if it is too large, or does not come.
  std::size_t receive_head();
  void begin_reply();
  /// Appends what has come to received_; false at the end of it.
  bool receive();
  /// As others wait; while nobody does, it may take its time.
  bool is_too_slow() const;
  void finish();

  socket_t socket_;
  ConnectionLimits limits_;
  std::function<bool()> has_high_valence_, is_stopping_;
  std::string received_;  ///< not yet taken as a head
  RequestHead head_;
  std::size_t place_ = 0;  ///< what was read of the head
  std::size_t requests_ = 0;
  Clock::time_point reply_start_;
  std::size_t reply_bytes_ = 0;
  bool is_broken_ = false;
  bool has_unread_ = false;  ///< what was not taken as a request
};

}  // namespace meshhier::server
