// A client that sends what it is told, byte by byte if need be, and checks nothing.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace meshhier::tests {

struct RawReply {
  int status = 0;                              ///< 0: the connection was closed without a reply
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;
};

/// One connection. Throws std::runtime_error if it cannot be made, or is silent for ten minutes.
class RawClient {
 public:
  /// `from`: the address it has itself, any of the loopback.
  explicit RawClient(std::uint16_t port, int receive_buffer_bytes = 0,
                     const char* from = "127.0.0.1");
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient();

  /// As much as the server takes; it may have closed the connection.
  void send(std::string_view bytes) const;
  /// The next reply, whose body ends as its head says. `is_head`: it has no body.
  RawReply receive(bool is_head = false);
  RawReply get(const std::string& target, const std::string& more_headers = "");
  /// Returns whether the server closes the connection before it says anything more.
  bool is_closed();

 private:
  bool fill();

  int socket_;
  std::string received_;
};

}  // namespace meshhier::tests
