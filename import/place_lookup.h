// Reads records of a spool in any order: quick if records that follow one another lie near.
#pragma once

#include "storage/io/spool.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::importing {

/// Keeps the last of some lines of records, each at its own place: 512 KiB of positions. The spool
/// may grow meanwhile, on the same thread. For one thread.
template <class Record>
class SpoolLookup {
 public:
  explicit SpoolLookup(const storage::RecordSpool<Record>& spool) : spool_(spool) {}

  /// Returns a record, valid until the next call. Requires index < the spool's size. Throws
  /// Error(io).
  const Record& at(std::uint64_t index) {
    const std::uint64_t first = index / kRecords * kRecords;
    Line& line = lines_[index / kRecords % kLines];
    if (line.first != first || index - first >= line.records.size()) {
      line.first = first;
      line.records.resize(std::min<std::uint64_t>(kRecords, spool_.size() - first));
      spool_.read(first, line.records);
    }
    return line.records[index - first];
  }

 private:
  static constexpr std::uint64_t kRecords = 128;
  static constexpr std::size_t kLines = 170;
  struct Line {
    std::uint64_t first = 0;
    std::vector<Record> records;
  };

  const storage::RecordSpool<Record>& spool_;
  std::array<Line, kLines> lines_;
};

}  // namespace meshhier::importing
