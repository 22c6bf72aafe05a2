// Several spools in a row, read as one.
#pragma once

#include "base/error.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::pipeline {

/// One spool that is written, or those that tasks have stored, one behind the other. As with a
/// spool, one thread writes, then any threads may read at once.
template <class Record>
class JoinedSpool {
 public:
  JoinedSpool(storage::ScratchFile& scratch, std::size_t block_bytes)
      : scratch_(&scratch), first_(scratch, block_bytes) {}

  void append(std::span<const Record> records) { first_.append(records); }
  void append(const Record& record) { first_.append(record); }

  std::uint64_t size() const {
    std::uint64_t count = first_.size();
    for (const storage::RecordSpool<Record>& part : more_)
      count += part.size();
    return count;
  }

  /// Requires first + records.size() <= size().
  void read(std::uint64_t first, std::span<Record> records) const {
    read_part(first_, first, records);
    for (const storage::RecordSpool<Record>& part : more_)
      read_part(part, first, records);
  }

  void clear() {
    first_.clear();
    more_.clear();
  }

  /// Calls visit(spool) for each, in their order; the first may be empty.
  template <class Visit>
  void for_each_part(const Visit& visit) const {
    visit(first_);
    for (const storage::RecordSpool<Record>& part : more_)
      visit(part);
  }

  /// Stores what was appended.
  storage::StoredSpool store() { return first_.store(); }
  /// Takes stored records behind those that are there; returns false if `stored` contradicts
  /// itself.
  bool restore(const storage::StoredSpool& stored) {
    if (stored.bytes % sizeof(Record) != 0)
      return false;
    if (stored.bytes == 0)
      return stored.blocks.empty();
    if (first_.size() == 0)
      return first_.restore(stored);
    return more_.emplace_back(*scratch_, stored.block_bytes).restore(stored);
  }
  /// Returns Spool::changed() for a restored part that is not as it was stored; nothing if all are.
  std::optional<Error> find_change() const {
    if (!first_.is_as_stored())
      return first_.changed();
    for (const storage::RecordSpool<Record>& part : more_) {
      if (!part.is_as_stored())
        return part.changed();
    }
    return std::nullopt;
  }

 private:
  /// Reads the records that lie in the part; `first` and `records` become those behind it.
  static void read_part(const storage::RecordSpool<Record>& part, std::uint64_t& first,
                        std::span<Record>& records) {
    if (first >= part.size()) {
      first -= part.size();
      return;
    }
    const std::uint64_t count = std::min<std::uint64_t>(records.size(), part.size() - first);
    part.read(first, records.first(count));
    records = records.subspan(count);
    first = 0;
  }

  storage::ScratchFile* scratch_;
  storage::RecordSpool<Record> first_;
  std::vector<storage::RecordSpool<Record>> more_;
};

}  // namespace meshhier::pipeline
