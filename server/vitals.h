// What a service manager asks: whether the server is alive, whether it is ready, and its figures.
//
//   GET /healthz     200 as long as requests are answered
//   GET /readyz      200, or 503 with reasons (readiness.h)
//   GET /metrics     the figures (metrics.h), for this machine or those who know a token
#pragma once

#include "server/http.h"
#include "server/http_server.h"
#include "server/log_text.h"
#include "server/metrics.h"
#include "server/readiness.h"
#include "storage/io/file.h"

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::server {

struct VitalsOptions {
  ReadinessOptions readiness;
  std::string token{};  ///< who reads the figures must know it; empty: they are for this machine
};

/// Answers these requests. Thread-safe.
class Vitals {
 public:
  /// Returns the figures but for free_bytes and started.
  using Ask = std::function<Figures()>;
  using Tell = std::function<void(LogLevel, const std::string& message)>;

  /// `ask` is called for each request of figures. `tell` hears when the server becomes ready or
  /// ceases to be so, as far as anybody asks. `files` must outlive this.
  Vitals(VitalsOptions options, storage::FileSystem& files, Ask ask, Tell tell);

  /// Whether the path, decoded and relative, is one of these.
  static bool is_vital(std::string_view path);
  /// Replies to such a request, by GET or HEAD. No reply may be kept, or read by pages of others.
  Reply answer(const Request& request, std::string_view path);
  /// Counts a request that was answered.
  void count(const Served& served) { requests_.count(served.method, served.status); }

 private:
  Reply readiness();
  Reply metrics(const Request& request);
  void tell_change(const std::string& reasons);

  VitalsOptions options_;
  storage::FileSystem& files_;
  Ask ask_;
  Tell tell_;
  RequestCounts requests_;
  std::chrono::system_clock::time_point started_ = std::chrono::system_clock::now();
  std::mutex mutex_;     ///< guards all below
  std::string reasons_;  ///< why it was not ready when it was asked last
};

}  // namespace meshhier::server
