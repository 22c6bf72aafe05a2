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
#include <vector>

namespace meshhier::storage {

struct HttpOptions {
  std::vector<std::string> headers;           ///< "Name: value"; for the address's own host alone
  std::uint64_t bytes_per_second = 0;         ///< for all that comes; 0: no limit
  std::chrono::milliseconds first_wait{500};  ///< before the second try; twice as long each time
  std::chrono::seconds silence{30};  ///< without a byte: then a try is over, answered or not
};

/// The failure of a file that a host packs on its way: then parts are those of the packed file.
inline constexpr const char* kSentPacked =
    "the host sends it packed (Content-Encoding), and then parts of it say nothing: "
    "switch that off for these files";

/// The address of a file on the web.
struct HttpAddress {
  std::string url;    ///< as it is asked for, perhaps with secrets
  std::string shown;  ///< in messages
};

struct HttpAnswer {
  std::vector<std::byte> bytes;
  bool is_whole = false;                 ///< `bytes` are all of the file: the host knows no ranges
  std::optional<std::uint64_t> total{};  ///< bytes of the file
  std::string version;                   ///< the file's ETag or Last-Modified; empty: not known
  std::string encoding{};                ///< its Content-Encoding; empty: none
};

/// Bytes and requests so far, of all threads, failed tries included.
struct HttpCounters {
  std::atomic<std::uint64_t> bytes{0};
  std::atomic<std::uint64_t> requests{0};
};

/// A request that fails by the line or by a busy host is tried again, up to five times in all with
/// growing waits (at most 60 s); bytes of a part that have come by then are not asked for again.
/// Credentials come from ~/.netrc, too. Thread-safe: each thread that asks has a connection for the
/// time, which stays open for the next; with a limit of bytes per second they take turns. Failures
/// throw Error(io) naming the address as it is shown.
class HttpClient {
 public:
  /// If a host sends no parts, a file is taken whole up to so many bytes.
  static constexpr std::uint64_t kMostWhole = std::uint64_t{64} << 20;

  /// `check` is called some times a second, by any thread that waits, and may throw.
  HttpClient(HttpOptions options, std::function<void()> check);
  ~HttpClient();

  /// Returns the bytes [first, first + count) of a file, fewer only at its end, or all of it.
  /// Requires count > 0. Throws Error(io), also if there is no such file, and what `check` throws.
  HttpAnswer get(const HttpAddress& address, std::uint64_t first, std::uint64_t count);
  /// Does the same, but returns nothing if there is no such file (404, 410).
  std::optional<HttpAnswer> find(const HttpAddress& address, std::uint64_t first,
                                 std::uint64_t count);
  /// Lets all that is under way, and all that is asked for from now on, throw Error(interrupted).
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

}  // namespace meshhier::storage
