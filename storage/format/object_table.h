// objects.bin: the names and properties of a mesh's objects, once, outside of the tiles.
//
// Problem: a mesh may have millions of objects; whoever clicks on one wants a row of the table, and
// whoever types a name wants the next few.
//
// Idea: objects are numbered by name. They lie in blocks, each packed and checked on its own, and a
// directory at the end tells where each block is and with which name it begins:
//
// clang-format off
//   magic, version | block 0: objects 0 .. 255 | block 1: 256 .. | ... | directory | end
//                    gzip                        gzip                  gzip
// clang-format on
//
// Cost: a question reads one block, about 10 kB, or for a long name a few. The writer appends only,
// and holds a block, and 60 bytes and a key for each one before.
#pragma once

#include "hierarchy/object_row.h"
#include "storage/format/object_directory.h"
#include "storage/io/file.h"
#include "storage/io/hash.h"

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// Facts about a table that its reader needs before the first read; the manifest keeps them.
struct ObjectTableFacts {
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64 of the file
  std::uint32_t objects = 0;
  std::uint64_t directory_bytes = 0;     ///< in the file
  std::uint64_t directory_checksum = 0;  ///< XXH3-64 of these
  std::vector<ObjectProperty> properties;
  friend bool operator==(const ObjectTableFacts&, const ObjectTableFacts&) = default;
};

/// Writes a table. The bytes follow from the rows. One thread at a time may use it.
class ObjectTableWriter {
 public:
  /// `file` is empty, and must outlive this. Requires at most kMostObjectProperties properties,
  /// with different names.
  ObjectTableWriter(File& file, std::vector<ObjectProperty> properties);

  /// Appends the next object. Requires a name that is greater than the one before, texts in UTF-8,
  /// finite numbers, and values of the properties' types. Throws Error(input) if it is the object
  /// behind kMostObjects or has more than kMostObjectTextBytes, Error(io).
  void add(ObjectRow row);

  /// Writes what is left, and the directory: the file is whole then, but not synced. Call it once.
  ObjectTableFacts finish();

 private:
  void flush();
  void append(std::span<const std::byte> bytes);

  File& file_;
  std::uint64_t end_ = 0;
  Checksum sum_;
  ObjectDirectory directory_;
  std::vector<ObjectRow> rows_;  ///< of the block that is not written yet
  std::size_t text_bytes_ = 0;   ///< theirs
};

/// A table that nobody vouches for, read block by block. It keeps a few blocks unpacked.
/// Thread-safe. Everything throws Error(corrupt) where the file is not as it must be, Error(io).
class ObjectTable {
 public:
  /// Objects that follow each other: from `begin` up to `end`.
  struct Range {
    std::uint32_t begin = 0, end = 0;
    friend bool operator==(const Range&, const Range&) = default;
  };

  /// Reads the directory. `expected`: what the manifest tells; all but the file's checksum is
  /// compared.
  explicit ObjectTable(std::unique_ptr<const File> file,
                       const ObjectTableFacts* expected = nullptr);

  std::uint32_t size() const { return directory_.objects(); }
  const std::vector<ObjectProperty>& properties() const { return directory_.properties; }

  /// Requires object < size().
  ObjectRow row(std::uint32_t object) const;
  std::optional<std::uint32_t> find(std::string_view name) const;
  /// Returns the objects whose names begin with `prefix`; all of an empty one.
  Range range_of_prefix(std::string_view prefix) const;
  /// Calls visit(object, row) for each object, in order; checks also that blocks follow each other.
  void for_each(const std::function<void(std::uint32_t object, const ObjectRow& row)>& visit) const;

 private:
  using Rows = std::shared_ptr<const std::vector<ObjectRow>>;
  struct Kept {
    std::size_t block;
    Rows rows;
  };
  using IsBefore = std::function<bool(std::string_view name)>;

  /// Where the directory is, as the end of the file tells.
  struct Place {
    std::uint64_t offset = 0, bytes = 0, unpacked = 0, checksum = 0;
  };
  Place read_place() const;
  void read_directory(const Place& place);
  void require_same(const Place& place, const ObjectTableFacts& expected) const;
  /// Returns a part of the file, checked and unpacked.
  std::vector<std::byte> unpack(File::Range range, std::uint64_t unpacked, std::uint64_t sum,
                                const std::string& name) const;
  Rows rows_of(std::size_t block) const;
  Rows read_rows(const ObjectBlock& block) const;
  /// Returns the first object whose name is not before; requires that none behind it is.
  std::uint32_t first_not(const IsBefore& is_before) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::unique_ptr<const File> file_;
  ObjectDirectory directory_;
  mutable std::mutex mutex_;
  mutable std::list<Kept> kept_;  ///< the one used last first
};

}  // namespace meshhier::storage
