// Parts of files over HTTP and HTTPS (RFC 9110, section 14), by libcurl.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

struct HttpOptions {
  std::vector<std::string> headers;    ///< "Name: value"; Authorization never goes to another host
  std::uint64_t bytes_per_second = 0;  ///< of all that comes; 0: no limit
  std::chrono::milliseconds first_wait{500};  ///< before the second try; twice as long each time
  std::chrono::seconds silence{30};  ///< without a byte: then a try is over, answered or not
};

/// Where something is.
struct HttpAddress {
  std::string url;    ///< as it is asked for, perhaps with secrets
  std::string shown;  ///< in messages
};

struct HttpAnswer {
  std::vector<std::byte> bytes;
  bool is_whole = false;                 ///< all of the file: the host knows no ranges
  std::optional<std::uint64_t> total{};  ///< bytes of the file
  std::string version;                   ///< its ETag or when it was modified; empty: not known
};

/// Bytes and requests so far, all of them.
struct HttpCounters {
  std::atomic<std::uint64_t> bytes{0};
  std::atomic<std::uint64_t> requests{0};
};

/// What fails by the line or by a busy host is tried again, up to five times with growing waits;
/// what has come by then counts. Credentials come from ~/.netrc, too. Thread-safe: each thread that
/// asks has a connection, which stays open. Failures throw Error(io) naming the address as it is
/// shown.
class HttpClient {
 public:
  /// A file of which the host sends no part is taken whole up to this.
  static constexpr std::uint64_t kMostWhole = std::uint64_t{64} << 20;

  /// `check` is called some times a second, by any thread that waits, and may throw.
  HttpClient(HttpOptions options, std::function<void()> check);
  ~HttpClient();

  /// Bytes [first, first + count) of a file, fewer only at its end, or all of it. Requires count >
  /// 0.
  HttpAnswer get(const HttpAddress& address, std::uint64_t first, std::uint64_t count);
  /// The same; nothing if there is no such file (404, 410).
  std::optional<HttpAnswer> find(const HttpAddress& address, std::uint64_t first,
                                 std::uint64_t count);
  /// All that is under way fails, and all that is asked for from now on.
  void stop() { is_over_ = true; }

  const HttpCounters& counters() const { return counters_; }

 private:
  class Connection;
  class Lease;

  HttpOptions options_;
  std::function<void()> check_;
  HttpCounters counters_;
  std::atomic<bool> is_over_ = false;
  struct Idle;
  std::unique_ptr<Idle> idle_;
};

/// Whether a text is the address of something on the web.
bool is_web_address(std::string_view text);

}  // namespace meshhier::storage
