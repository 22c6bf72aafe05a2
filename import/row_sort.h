// Rows of bytes of any length, and their sort, out of core.
//
// Problem. Names have any length, and there may be millions with their properties: neither all nor
// a table of them fits into memory. ExternalSort takes records of one length.
//
// Idea. Rows fill the memory, are sorted there and go to a spool as a run; runs are merged by a
// heap of their first rows, which are read through small windows.
//
// Invariant. Rows come ascending by key, compared byte by byte; those of equal keys in the order in
// which they were added, whatever the memory.
//
// Cost. O(n log n) comparisons; each row is written and read once, and once more for each 64-fold
// of runs.
#pragma once

#include "import/import_room.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {

/// A key and bytes that belong to it, each shorter than 4 GiB.
struct Row {
  std::string_view key, bytes;
};

/// Rows one behind the other.
class RowSpool {
 public:
  explicit RowSpool(storage::ScratchFile& scratch) : bytes_(scratch, kImportSpoolBytes) {}

  void append(const Row& row);
  /// Returns the bytes of all rows.
  std::uint64_t bytes() const { return bytes_.size(); }
  std::uint64_t rows() const { return rows_; }
  void clear();

 private:
  friend class RowCursor;
  storage::Spool bytes_;
  std::uint64_t rows_ = 0;
};

/// Reads rows forwards. Nothing may be appended meanwhile.
class RowCursor {
 public:
  static constexpr std::size_t kWindow = std::size_t{1} << 17;

  explicit RowCursor(const RowSpool& rows, std::size_t window = kWindow)
      : RowCursor(rows, 0, rows.bytes(), window) {}
  /// Reads those whose bytes are from `begin` to `end`.
  RowCursor(const RowSpool& rows, std::uint64_t begin, std::uint64_t end, std::size_t window);

  /// Goes on to the next row; false behind the last.
  bool next();
  /// Returns the row here, valid until the next call of next().
  const Row& row() const { return row_; }

 private:
  std::string_view take(std::size_t bytes);

  const storage::Spool* spool_;
  std::uint64_t at_, end_;  ///< bytes of the spool that are not in the window yet
  std::size_t window_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< bytes of the buffer that were taken
  Row row_;
};

/// Sorts rows by key. Call add() any number of times, sort() once, then next(). For one thread.
class RowSort {
 public:
  /// Holds about `memory_bytes`, but always one row.
  RowSort(const ImportRoom& room, std::uint64_t memory_bytes);

  void add(const Row& row);
  void sort();
  /// Goes on to the next row in order; false behind the last.
  bool next();
  /// Returns the row here, valid until the next call of next().
  const Row& row() const { return row_; }

 private:
  /// Where a row's key and bytes lie in memory.
  struct Held {
    std::size_t at;
    std::uint32_t key, bytes;
  };
  struct Run {
    std::uint64_t begin, end;
  };
  struct Head {
    RowCursor cursor;
    std::size_t run;
  };

  Row held(std::size_t i) const;
  bool is_full(const Row& row) const;
  void sort_held();
  void spill();
  void merge_runs();
  void open(std::size_t first, std::size_t count);
  bool next_merged();

  static constexpr std::size_t kLeastMemory = std::size_t{1} << 16;
  static constexpr std::size_t kLeastWindow = std::size_t{1} << 12;
  static constexpr std::size_t kMostMerged = 64;

  const ImportRoom& room_;
  std::size_t memory_;
  std::vector<char> text_;
  std::vector<Held> held_;
  std::unique_ptr<RowSpool> spool_;
  std::vector<Run> runs_;
  std::vector<Head> heads_;  ///< a heap: the least row first
  bool is_begun_ = false;    ///< of a merge: the first head's row was handed out
  std::size_t next_ = 0;     ///< of held_
  Row row_;
};

}  // namespace meshhier::importing
