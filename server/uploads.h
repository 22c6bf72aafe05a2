// Uploads: meshes that clients send into a watched inbox.
//
//   PUT /inbox/scan.ply       a mesh file
//   POST /inbox/house         a form of files (multipart.h): one mesh with all that belongs to it,
//                             which becomes a folder of that name
//
// The inbox has it whole or not at all, and nothing in it is ever replaced.
#pragma once

#include "server/gallery.h"
#include "server/http.h"
#include "storage/io/file.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::server {

struct UploadOptions {
  std::filesystem::path inbox;                          ///< absolute
  std::uint64_t limit_bytes = std::uint64_t{20} << 30;  ///< a request has at most
  std::filesystem::path folder{};  ///< the hierarchies'; empty: its disk does not count
  std::uint64_t disk_floor = 0;    ///< bytes that stay free on both disks
  std::string suffix = ".hier";    ///< the hierarchies' that are made
  std::string token{};             ///< who sends must know it; empty: there is none
  bool is_loopback = true;  ///< only this machine reaches the server; else nobody sends without a
                            ///< token
  std::size_t most_at_once = 8;  ///< each holds a thread
};

/// The uploads so far, and those under way.
struct UploadCounts {
  std::uint64_t taken = 0;
  std::uint64_t refused = 0;
  std::uint64_t bytes = 0;  ///< of the requests that were taken
  std::size_t at_once = 0;
};

/// Takes uploads. Thread-safe.
class Uploads {
 public:
  using Tell = std::function<void(const std::string& message)>;

  /// Removes uploads that a killed server left. `files` must outlive this. `tell` hears why a file
  /// could not be stored. Throws Error(io).
  Uploads(UploadOptions options, storage::FileSystem& files, Tell tell);

  /// Returns the offer that pages are told; nothing if nobody may send.
  std::optional<UploadOffer> offer() const;
  /// Returns why a request may not change anything here, by whose it is, its conditions or its
  /// encoding; nothing if it may.
  std::optional<Reply> refuse_change(const Request& request) const;
  /// Takes an upload. `place`: the target below /inbox, "/scan.ply". Returns 201, or why not, in
  /// one line. Reads the body in this thread, as long as the client sends it. Throws nothing but
  /// storage::Busy.
  Reply take(const Request& request, std::string_view place);
  UploadCounts counts() const;

 private:
  class Slot;

  Reply reply_to(const Request& request, std::string_view place);
  std::optional<Reply> refuse_size(const Request& request) const;
  void require_room(std::uint64_t more) const;
  std::optional<Reply> refuse_name(const std::string& name) const;
  Reply take_whole(const Request& request, const std::string& name);
  Reply take_file(Body& body, const std::string& name);
  Reply take_folder(Body& body, const std::string& boundary, const std::string& name);

  UploadOptions options_;
  storage::FileSystem& files_;
  Tell tell_;
  std::atomic<std::size_t> at_once_{0};
  std::atomic<std::uint64_t> taken_{0}, refused_{0}, bytes_{0};
};

}  // namespace meshhier::server
