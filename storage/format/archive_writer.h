// Makes a 3TZ archive (storage/format/archive_format.h) of one file after another.
#pragma once

#include "storage/format/archive_format.h"
#include "storage/io/file.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Bytes that a file in an archive takes beside its content: two headers with its name, and its
/// place in the index.
inline constexpr double kArchivedFileOverhead = 138;

/// Writes files one behind the other. It holds 24 bytes a file, and a block of 1 MiB.
/// Deterministic: the archive follows from names and contents in their order. One thread at a time
/// may use it. Failures throw Error(io); what was written is then of no use.
class ArchiveWriter {
 public:
  /// Memory for a file's place in the index, twice while the list grows.
  static constexpr std::uint64_t kFileMemory = 2 * sizeof(IndexPlace);

  /// `archive` is empty, and can be read as well; it must outlive this. `check` is called before
  /// each block of content and may throw.
  ArchiveWriter(File& archive, std::function<void()> check)
      : archive_(archive), check_(std::move(check)) {}

  /// Appends a file. Requires is_archive_name(name), and that no other file has the name. Throws
  /// Error(usage) if it is larger than kMostFileBytes.
  void add(std::string_view name, const File& content);

  /// Appends index, directory and end: the archive is whole then, but not synced.
  void finish();

  /// Bytes written so far.
  std::uint64_t bytes() const { return end_; }

 private:
  using ReadContent = std::function<void(std::uint64_t offset, std::span<std::byte> bytes)>;
  void append(std::string_view name, std::uint64_t bytes, const ReadContent& read);
  void write_directory();

  File& archive_;
  std::function<void()> check_;
  std::uint64_t end_ = 0;
  std::vector<IndexPlace> index_;
  std::vector<std::byte> block_;
};

}  // namespace meshhier::storage
