// A request and its reply as values: a reply is made without a socket.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::server {

/// The bytes behind a head, from the first to the last, each once. For one thread; never throws.
class Body {
 public:
  enum class End {
    whole,     ///< all that were announced have come
    lost,      ///< the client has gone
    slow,      ///< it took too long
    stopping,  ///< the server ends
  };

  Body() = default;
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  virtual ~Body() = default;

  /// Returns how many bytes are announced.
  virtual std::uint64_t bytes() const = 0;
  /// Reads up to bytes.size() of them, at least one, and returns how many; waits for them. 0: none
  /// comes any more, and end() says why.
  virtual std::size_t read(std::span<std::byte> bytes) = 0;
  virtual End end() const = 0;
  virtual bool is_stopping() const = 0;
};

/// A request as a client sent it; nobody vouches for any of it.
struct Request {
  std::string method = "GET";
  std::string target{};  ///< as it was sent: "/models.json?x", not decoded; of an address its path
  std::optional<std::string> host{};
  std::optional<std::string> accept_encoding{};
  std::optional<std::string> if_match{};
  std::optional<std::string> if_none_match{};
  std::optional<std::string> if_range{};
  std::optional<std::string> range{};
  std::optional<std::string> origin{};  ///< "" if there are several
  std::optional<std::string> authorization{};
  std::optional<std::string> content_type{};
  std::optional<std::string> content_encoding{};
  bool is_part = false;       ///< its body is a part of something (Content-Range)
  bool has_body = false;      ///< more than 0 bytes are announced behind the head
  Body* body = nullptr;       ///< null if no Content-Length tells how long it is
  std::string client{};       ///< the address that it came from; empty: not known
  bool is_passed_on = false;  ///< a proxy says so: `client` is the proxy's
};

/// A part of a file, sent piece by piece.
struct FilePart {
  std::shared_ptr<const storage::File> file;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

/// The reply to a request. The server adds Content-Length and Connection.
struct Reply {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers{};
  std::string text{};              ///< the body, unless it is
  std::optional<FilePart> file{};  ///< this

  std::uint64_t body_bytes() const { return file ? file->bytes : text.size(); }
  /// Returns the header's value, "" if it is not there; `name` as it was put in.
  std::string_view header(std::string_view name) const;
};

/// A client waits so long until it asks again.
inline constexpr const char* kRetryAfterSeconds = "1";

/// Returns a reply of one line for people.
inline Reply text_reply(int status, const std::string& text) {
  return {status, {{"Content-Type", "text/plain; charset=utf-8"}}, text + '\n', {}};
}

/// Returns 503, for a failure that may pass, and when to ask again.
inline Reply busy_reply() {
  Reply reply =
      text_reply(503, "The server has too much to do at this moment: ask again in a second.");
  reply.headers.emplace_back("Retry-After", kRetryAfterSeconds);
  return reply;
}

inline std::string_view Reply::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name)
      return value;
  }
  return {};
}

}  // namespace meshhier::server
