// A host on the loopback that does whatever a test wants of it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace meshhier::tests {

struct HostRequest {
  std::string method;
  std::string target;
  std::string head;                                              ///< all of it
  std::optional<std::pair<std::uint64_t, std::uint64_t>> range;  ///< first and last byte
};

struct HostReply {
  std::string bytes;       ///< as they are sent, head and body
  bool keeps_open = true;  ///< the connection, for the next request
};

class HttpHost {
 public:
  /// Called by several threads at once.
  using Answer = std::function<HostReply(const HostRequest&)>;

  explicit HttpHost(Answer answer);
  HttpHost(const HttpHost&) = delete;
  HttpHost& operator=(const HttpHost&) = delete;
  ~HttpHost();

  /// "http://127.0.0.1:PORT/"
  std::string url() const;
  /// The heads of all requests so far.
  std::vector<std::string> heads() const;
  std::size_t requests() const { return heads().size(); }

 private:
  void accept_all();
  void serve(int connection);

  Answer answer_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<bool> is_over_ = false;
  mutable std::mutex mutex_;  ///< guards all below
  std::vector<std::string> heads_;
  std::vector<int> connections_;
  std::vector<std::thread> threads_;
  std::thread accepting_;
};

/// As hosts of files do that know ranges.
HostReply answer_with(const HostRequest& request, const std::string& file,
                      const std::string& more_headers = "ETag: \"1\"\r\n");
/// With the whole file.
HostReply answer_whole(const HostRequest& request, const std::string& file);
HostReply answer_status(int status, const std::string& more_headers = "");

}  // namespace meshhier::tests
