// Counters of the bytes that scratch files moved and hold on disk.
#pragma once

#include <atomic>
#include <cstdint>

namespace meshhier::storage {

/// Counts bytes; thread-safe. A byte is on disk from its write until its file is gone.
class ScratchUse {
 public:
  void add_written(std::uint64_t bytes) { bytes_written_ += bytes; }
  void add_read(std::uint64_t bytes) { bytes_read_ += bytes; }
  /// A file has grown by so much.
  void add_grown(std::uint64_t bytes) {
    const std::uint64_t now = bytes_on_disk_ += bytes;
    std::uint64_t peak = peak_bytes_on_disk_;
    while (peak < now && !peak_bytes_on_disk_.compare_exchange_weak(peak, now)) {
    }
  }
  /// A file of that size is gone.
  void add_removed(std::uint64_t bytes) { bytes_on_disk_ -= bytes; }

  std::uint64_t bytes_written() const { return bytes_written_; }
  std::uint64_t bytes_read() const { return bytes_read_; }
  std::uint64_t bytes_on_disk() const { return bytes_on_disk_; }
  std::uint64_t peak_bytes_on_disk() const { return peak_bytes_on_disk_; }

 private:
  std::atomic<std::uint64_t> bytes_written_{0};
  std::atomic<std::uint64_t> bytes_read_{0};
  std::atomic<std::uint64_t> bytes_on_disk_{0};
  std::atomic<std::uint64_t> peak_bytes_on_disk_{0};
};

}  // namespace meshhier::storage
