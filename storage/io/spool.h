// Append-only scratch bytes: in memory while the budget lasts, on disk from there on.
//
// This is what makes one algorithm serve meshes smaller and larger than memory: stages append to
// spools and read them back, and only the memory pool decides what touches the disk. The bytes that
// are read never depend on it.
#pragma once

#include "base/error.h"
#include "storage/io/file.h"
#include "storage/io/scratch_use.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace meshhier::storage {

/// Bytes that may be held in memory by all spools together. Thread-safe.
class MemoryPool {
 public:
  explicit MemoryPool(std::uint64_t capacity_bytes)
      : free_(static_cast<std::int64_t>(capacity_bytes)) {}
  /// May be called only while nothing is taken.
  void set_capacity(std::uint64_t capacity_bytes) {
    free_ = static_cast<std::int64_t>(capacity_bytes);
  }
  /// Takes `bytes`, or returns false and takes none if fewer are free.
  bool try_take(std::uint64_t bytes);
  void give_back(std::uint64_t bytes) { free_ += static_cast<std::int64_t>(bytes); }
  std::uint64_t free_bytes() const { return static_cast<std::uint64_t>(free_.load()); }

  /// Counts for all scratch files that take what the pool does not hold.
  ScratchUse& scratch_use() { return scratch_use_; }
  const ScratchUse& scratch_use() const { return scratch_use_; }

 private:
  std::atomic<std::int64_t> free_;
  ScratchUse scratch_use_;
};

/// A temporary file shared by many spools; made when the first block must leave memory, removed at
/// the end. It may be several files, PATH, PATH.1, ...: threads that write to one file wait for
/// each other in the system, whatever they write. Failures throw Error(io). Threads may append,
/// release, read and sync at once; all else needs the file for itself. `files` and `pool` must
/// outlive it.
class ScratchFile {
 public:
  /// Whether the file is there when its object is gone.
  enum class Stays {
    no,
    yes  ///< for a later process; one that an earlier process left is gone on with
  };

  /// The number of files that it may be.
  enum class Files {
    one,
    one_a_thread  ///< up to 16; more threads share them
  };

  ScratchFile(FileSystem& files, std::filesystem::path path, MemoryPool& pool,
              Stays stays = Stays::no, Files files_at_once = Files::one);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();

  /// Returns another file, `name`, beside this one and of the same pool: for what is needed for a
  /// while only, as disk space comes back with a whole file.
  ScratchFile beside(const char* name) const {
    return {files_, path_.parent_path() / name, pool_, Stays::no,
            own_.size() == 1 ? Files::one : Files::one_a_thread};
  }
  /// The path of the one file, or of the first.
  const std::filesystem::path& path() const { return path_; }

  /// Returns the bytes on disk. Thread-safe.
  std::uint64_t size() const;
  MemoryPool& pool() { return pool_; }

  /// Writes `bytes` to where as many were released, or else to the end; returns where.
  /// Thread-safe.
  std::uint64_t append(std::span<const std::byte> bytes);
  /// Says that bytes which were appended so are not needed any more: later ones take their place.
  /// Thread-safe.
  void release(std::uint64_t offset, std::uint64_t bytes);
  /// Says that bytes which an earlier process appended are still needed; returns false if there are
  /// not so many. Must come before the first append().
  bool claim(std::uint64_t offset, std::uint64_t bytes);

  /// Makes another file's bytes, which stay as they are, readable here: what is said to lie at
  /// `offset` of that file lies at placed(offset) here, until the next mount(). The file stays
  /// open. Throws Error(io) if there are too many.
  void mount(std::unique_ptr<File> file);
  /// Returns where that is; for an offset that no file can have, a place that claim() refuses.
  std::uint64_t placed(std::uint64_t offset) const {
    return offset <= kOffsetMask ? (mounted_.size() << kPlaceBits) + offset : kNowhere;
  }
  /// Whether an offset lies in a file that was mounted.
  static bool is_mounted(std::uint64_t offset) { return offset >> kPlaceBits > 0; }
  /// Returns the error to throw if the bytes at `offset` are not those that were written there:
  /// Error(io), or Error(corrupt) for a mounted file.
  Error changed(std::uint64_t offset) const;
  /// Forces what was appended before the call to the disk; `check` is as File::sync()'s.
  /// Thread-safe.
  void sync(const std::function<void()>& check);
  /// Removes the file; nothing is left of what was appended.
  void remove();
  /// Reads bytes that were appended or claimed. Thread-safe.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const {
    file_at(offset).read_exact(is_mounted(offset) ? offset & kOffsetMask : place_of(offset).offset,
                               bytes);
    pool_.scratch_use().add_read(bytes.size());
  }

 private:
  static constexpr int kPlaceBits = 44;  // 16 TiB
  static constexpr int kFileBits = 40;   // 1 TiB for each file if there are several
  static constexpr std::size_t kMostFiles = std::size_t{1} << (kPlaceBits - kFileBits);
  static constexpr std::uint64_t kOffsetMask = (std::uint64_t{1} << kPlaceBits) - 1;
  static constexpr std::uint64_t kMostMounted = std::uint64_t{1}
                                                << 18;  // a spool's block has 63 bits
  static constexpr std::uint64_t kNowhere = (kMostMounted + 1) << kPlaceBits;

  /// One of the files; offsets in it are below place_of()'s.
  struct Own {
    std::unique_ptr<File> file;
    std::uint64_t size = 0;
  };
  /// The place of bytes that are in no mounted file: which of the own files, and the offset there.
  struct Place {
    std::size_t own;
    std::uint64_t offset;
  };
  Place place_of(std::uint64_t offset) const {
    const std::uint64_t place = offset & kOffsetMask;
    return own_.size() == 1
               ? Place{0, place}
               : Place{place >> kFileBits, place & ((std::uint64_t{1} << kFileBits) - 1)};
  }
  std::filesystem::path path_of(std::size_t own) const;
  const File& file_at(std::uint64_t offset) const {
    return is_mounted(offset) ? *mounted_[(offset >> kPlaceBits) - 1]
                              : *own_[place_of(offset).own].file;
  }
  std::size_t own_of_this_thread() const;
  void require_room(std::size_t own) const;

  FileSystem& files_;
  std::filesystem::path path_;
  MemoryPool& pool_;
  Stays stays_;
  mutable std::mutex mutex_;  ///< guards own_, but for files once they are made, and free_
  std::vector<Own> own_;
  std::map<std::uint64_t, std::vector<std::uint64_t>> free_;  ///< offsets by size
  std::vector<std::unique_ptr<File>> mounted_;
};

/// The places in a scratch file that hold a spool's bytes.
struct StoredSpool {
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;
  std::uint64_t block_bytes = 0;
  std::vector<std::uint64_t> blocks;  ///< offsets
};

/// A sequence of bytes. One thread appends; after the last append() any threads may read at once.
/// Failures of the scratch file throw Error(io).
class Spool {
 public:
  /// `block_bytes`: size of the blocks that move to disk, one of which is held in memory while
  /// writing, whatever the pool has; > 0.
  Spool(ScratchFile& scratch, std::size_t block_bytes)
      : scratch_(&scratch), block_bytes_(block_bytes) {}
  Spool(Spool&& other) noexcept;
  Spool& operator=(Spool&&) = delete;
  ~Spool() { clear(); }

  void append(std::span<const std::byte> bytes) {
    if (bytes.empty() || bytes.size() > room_)
      return append_to_blocks(bytes);
    std::memcpy(end_, bytes.data(), bytes.size());
    grow(bytes.size());
  }
  std::uint64_t size() const { return size_; }

  /// Copies bytes.size() bytes from `offset`. Requires offset + bytes.size() <= size().
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

  /// Forgets the content; gives its memory back to the pool and its disk space to the scratch file.
  void clear();

  /// Puts all that is in memory on disk, and returns where it is: for restore(), in another process
  /// even. Nothing can be appended any more.
  StoredSpool store();
  /// Takes what should be in the scratch file already, without looking; returns false if `stored`
  /// contradicts itself. The spool must be empty.
  bool restore(const StoredSpool& stored);
  /// Whether the scratch file holds what was stored; reads it all. For a restored spool, before
  /// anything is appended to the scratch file.
  bool is_as_stored() const;
  /// Returns ScratchFile::changed() for a restored spool that is not as it was stored.
  Error changed() const { return scratch_->changed(blocks_.empty() ? 0 : blocks_[0].offset()); }

 private:
  /// The place of a block's bytes, in memory or on disk. It takes 8 bytes, as large meshes have
  /// many blocks, and owns nothing.
  class Block {
   public:
    static Block in_memory(std::byte* memory) {
      return Block(reinterpret_cast<std::uintptr_t>(memory));
    }
    static Block on_disk(std::uint64_t offset) { return Block(offset << 1 | 1); }
    bool is_on_disk() const { return (word_ & 1) != 0; }
    std::byte* memory() const { return reinterpret_cast<std::byte*>(word_); }
    std::uint64_t offset() const { return word_ >> 1; }

   private:
    static_assert(sizeof(std::uintptr_t) == sizeof(std::uint64_t));
    explicit Block(std::uint64_t word) : word_(word) {}  // addresses of arrays are even
    std::uint64_t word_;
  };
  void append_to_blocks(std::span<const std::byte> bytes);
  void open_block();
  void grow(std::size_t bytes) {
    end_ += bytes;
    room_ -= bytes;
    size_ += bytes;
  }
  /// Returns the bytes that a block holds; all but the last one are full.
  std::size_t used_bytes(std::size_t block) const;

  ScratchFile* scratch_;
  std::size_t block_bytes_;
  std::byte* end_ = nullptr;  ///< where the next byte goes, while the last block has room
  std::size_t room_ = 0;
  std::uint64_t size_ = 0;
  std::uint64_t checksum_ = 0;  ///< chain over all blocks, each seeded with those before; the last
                                ///< one is left out as long as it is open
  std::vector<Block> blocks_;   ///< in memory: counted in the pool, but for the last, open one
};

/// A spool of one kind of trivially copyable record.
template <class Record>
class RecordSpool {
 public:
  RecordSpool(ScratchFile& scratch, std::size_t block_bytes) : spool_(scratch, block_bytes) {}
  void append(std::span<const Record> records) { spool_.append(std::as_bytes(records)); }
  void append(const Record& record) { append(std::span(&record, 1)); }
  std::uint64_t size() const { return spool_.size() / sizeof(Record); }
  void read(std::uint64_t first, std::span<Record> records) const {
    spool_.read(first * sizeof(Record), std::as_writable_bytes(records));
  }
  std::vector<Record> read_all() const {
    std::vector<Record> records(size());
    read(0, records);
    return records;
  }
  void clear() { spool_.clear(); }
  StoredSpool store() { return spool_.store(); }
  bool restore(const StoredSpool& stored) { return spool_.restore(stored); }
  bool is_as_stored() const { return spool_.is_as_stored(); }
  Error changed() const { return spool_.changed(); }

 private:
  static_assert(std::is_trivially_copyable_v<Record>);
  Spool spool_;
};

}  // namespace meshhier::storage
