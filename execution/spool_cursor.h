// Reads a spool's records, one after another.
#pragma once

#include "execution/cancel.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::execution {

/// Reads a spool forwards, 128 KiB at a time. A cursor is for one thread; several may read one
/// spool. Both arguments must outlive it, and nothing may be appended to the spool meanwhile.
template <class Record>
class SpoolCursor {
 public:
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 17;

  SpoolCursor(const storage::RecordSpool<Record>& spool, const CancelToken& cancel)
      : spool_(spool), cancel_(cancel) {}

  /// Returns record `index` < the spool's size; no call may ask for one before that of the call
  /// before. Valid until the next call. Throws Error(interrupted) once cancelled, and Error(io) if
  /// the spool cannot be read.
  const Record& at(std::uint64_t index) {
    if (index >= first_ + buffer_.size())
      load(index);
    return buffer_[index - first_];
  }
  std::uint64_t size() const { return spool_.size(); }

 private:
  void load(std::uint64_t index) {
    cancel_.check();
    first_ = index;
    buffer_.resize(std::min<std::uint64_t>(kBufferBytes / sizeof(Record), spool_.size() - index));
    spool_.read(index, buffer_);
  }

  const storage::RecordSpool<Record>& spool_;
  const CancelToken& cancel_;
  std::uint64_t first_ = 0;
  std::vector<Record> buffer_;
};

}  // namespace meshhier::execution
