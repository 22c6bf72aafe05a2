// A file on the web of which parts have come: each byte is fetched once.
#pragma once

#include "storage/io/file.h"
#include "storage/io/http_client.h"
#include "storage/io/read_ahead.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace meshhier::storage {

/// The most requests at the same time, and the most bytes that are fetched before they are asked
/// for.
inline constexpr std::size_t kFetchedAtOnce = 6;
inline constexpr std::uint64_t kFetchedAhead = std::uint64_t{16} << 20;

/// A file of the process alone, to which parts are appended. Thread-safe.
class FetchedParts {
 public:
  /// `file` is empty.
  explicit FetchedParts(std::unique_ptr<File> file) : file_(std::move(file)) {}

  /// Returns the place to read them from.
  std::uint64_t append(std::span<const std::byte> bytes);
  void read(std::uint64_t place, std::span<std::byte> bytes) const {
    file_->read_exact(place, bytes);
  }

 private:
  std::unique_ptr<File> file_;
  std::mutex mutex_;
  std::uint64_t end_ = 0;
};

/// A file on the web. Thread-safe. Failures throw Error(io).
class RemoteContent {
 public:
  /// `start`: the first `asked` bytes, fewer if there are fewer, or the whole file. `client` and
  /// `parts` must outlive this. Throws Error(io) if `start` contradicts itself or does not tell how
  /// long the file is.
  RemoteContent(HttpClient& client, HttpAddress address, FetchedParts& parts,
                const HttpAnswer& start, std::uint64_t asked);

  std::uint64_t size() const { return size_; }
  const std::string& version() const { return version_; }
  /// Reads up to bytes.size() bytes and returns how many, fewer only at the end. Fetches what is
  /// not there yet; a small read fetches whole blocks of 64 KiB.
  std::size_t read(std::uint64_t offset, std::span<std::byte> bytes);
  /// Begins to fetch those of the ranges that have 64 KiB or more, several at a time.
  void will_read(std::span<const File::Range> ranges);

 private:
  struct Part {
    std::uint64_t end = 0;    ///< in the file
    std::uint64_t place = 0;  ///< among the parts
  };

  [[noreturn]] void fail(const char* what) const;
  /// Returns the range from its first byte that is not there on.
  File::Range missing_of(const File::Range& range) const;
  bool read_if_there(std::uint64_t offset, std::span<std::byte> bytes) const;
  std::uint64_t fetch(const File::Range& range);
  void keep(std::uint64_t offset, std::span<const std::byte> bytes);
  /// The part that holds a byte; mutex_ is locked.
  std::map<std::uint64_t, Part>::const_iterator part_at(std::uint64_t offset) const;

  HttpClient& client_;
  HttpAddress address_;
  FetchedParts& parts_;
  std::uint64_t size_ = 0;
  std::string version_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Part> there_;  ///< keys: where they begin in the file
  ReadAhead<File::Range, std::uint64_t> ahead_;
};

}  // namespace meshhier::storage
