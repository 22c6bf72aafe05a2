// Memory that items at work take, kept below a limit.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>

namespace meshhier::execution {

/// Lets items in as long as all that is held stays within the limit; others wait. An item is let
/// in once at a time, so that none waits for another one that waits. Thread-safe.
class MemoryGate {
 public:
  explicit MemoryGate(std::uint64_t limit_bytes) : limit_(limit_bytes) {}

  /// Memory that is held as long as the object is there.
  class Hold {
   public:
    Hold(MemoryGate& gate, std::uint64_t bytes) : gate_(gate), bytes_(bytes) {}
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;
    ~Hold() { gate_.leave(bytes_); }

   private:
    MemoryGate& gate_;
    std::uint64_t bytes_;
  };

  /// Waits until there is room. An item that exceeds the limit by itself goes in when nothing else
  /// is held.
  [[nodiscard]] Hold enter(std::uint64_t bytes) {
    std::unique_lock lock(mutex_);
    freed_.wait(lock, [&] { return held_ == 0 || held_ + bytes <= limit_; });
    held_ += bytes;
    return {*this, bytes};
  }
  /// Does the same for an owner that hands it on.
  [[nodiscard]] std::shared_ptr<const void> share(std::uint64_t bytes) {
    return std::shared_ptr<const Hold>(new Hold(enter(bytes)));
  }

 private:
  void leave(std::uint64_t bytes) {
    {
      const std::lock_guard lock(mutex_);
      held_ -= bytes;
    }
    freed_.notify_all();
  }

  const std::uint64_t limit_;
  std::uint64_t held_ = 0;
  std::mutex mutex_;
  std::condition_variable freed_;
};

}  // namespace meshhier::execution
