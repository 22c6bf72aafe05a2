// The figures of a server for Prometheus. However many clients, models and names there are, the
// number of samples is the same.
#pragma once

#include "server/build_counts.h"
#include "server/http_server.h"
#include "server/uploads.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::server {

/// Counts replies by method and class of status. Thread-safe.
class RequestCounts {
 public:
  /// Methods that have a count of their own; the last one is that of all others.
  static constexpr std::array<std::string_view, 6> kMethods{"GET",  "HEAD", "OPTIONS",
                                                            "POST", "PUT",  "other"};
  /// The hundreds of status that replies here have.
  static constexpr std::array kClasses{2, 3, 4, 5};

  void count(std::string_view method, int status);
  /// `method`, `status_class`: places in the tables above.
  std::uint64_t of(std::size_t method, std::size_t status_class) const {
    return counts_[method][status_class];
  }

 private:
  std::array<std::array<std::atomic<std::uint64_t>, kClasses.size()>, kMethods.size()> counts_{};
};

/// The figures of one moment, besides those of requests and of the process.
struct Figures {
  Traffic traffic{};
  std::optional<std::size_t> models{};    ///< none: the folder cannot be listed
  std::optional<BuildCounts> builds{};    ///< none: no folder is watched
  std::optional<UploadCounts> uploads{};  ///< none: none are taken
  /// By the name of a place of ours, "folder".
  std::vector<std::pair<std::string_view, std::uint64_t>> free_bytes{};
  std::chrono::system_clock::time_point started{};
};

/// Returns the text; figures of the process are those of now.
std::string metrics_text(const RequestCounts& requests, const Figures& figures);

}  // namespace meshhier::server
