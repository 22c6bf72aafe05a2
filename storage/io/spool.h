// Append-only scratch bytes: in memory while the budget lasts, on disk from there on.
//
// This is what makes one algorithm serve meshes smaller and larger than memory: stages append to
// spools and read them back, and only the memory pool decides what touches the disk. What is read
// never depends on it.
#pragma once

#include "hierarchy/error.h"
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
  /// While nothing is taken.
  void set_capacity(std::uint64_t capacity_bytes) {
    free_ = static_cast<std::int64_t>(capacity_bytes);
  }
  bool try_take(std::uint64_t bytes);
  void give_back(std::uint64_t bytes) { free_ += static_cast<std::int64_t>(bytes); }
  std::uint64_t free_bytes() const { return static_cast<std::uint64_t>(free_.load()); }

  /// Of all scratch files that take what the pool does not hold.
  ScratchUse& scratch_use() { return scratch_use_; }
  const ScratchUse& scratch_use() const { return scratch_use_; }

 private:
  std::atomic<std::int64_t> free_;
  ScratchUse scratch_use_;
};

/// A temporary file shared by many spools; made when the first block must leave memory, removed at
/// the end. It may be several files, PATH, PATH.1, ...: threads that write to one file wait for
/// each other in the system, whatever they write.
class ScratchFile {
 public:
  /// Whether the file is there when its object is gone.
  enum class Stays {
    no,
    yes  ///< for a later process; one that an earlier process left is gone on with
  };

  /// How many files it may be.
  enum class Files { one, one_a_thread };

  ScratchFile(FileSystem& files, std::filesystem::path path, MemoryPool& pool,
              Stays stays = Stays::no, Files files_at_once = Files::one);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();

  /// Another file, `name`, beside this one and of the same pool: for what is needed for a while
  /// only, as disk space comes back with a whole file.
  ScratchFile beside(const char* name) const {
    return {files_, path_.parent_path() / name, pool_, Stays::no,
            own_.size() == 1 ? Files::one : Files::one_a_thread};
  }
  /// Of the one file, or of the first.
  const std::filesystem::path& path() const { return path_; }

  /// Bytes on disk.
  std::uint64_t size() const;
  MemoryPool& pool() { return pool_; }

  /// Writes `bytes` to where as many were released, or else to the end; returns where.
  /// Thread-safe.
  std::uint64_t append(std::span<const std::byte> bytes);
  /// Bytes that were appended so are not needed any more. Thread-safe.
  void release(std::uint64_t offset, std::uint64_t bytes);
  /// Says that bytes an earlier process appended are still needed; false if there are not so many.
  /// Before the first append().
  bool claim(std::uint64_t offset, std::uint64_t bytes);

  /// Another file's bytes, which stay as they are, behind this one's own: what is said to lie at
  /// `offset` of that file lies at placed(offset) here, until the next mount(). Each stays open.
  /// Throws Error(io) if there are too many.
  void mount(std::unique_ptr<File> file);
  /// claim() refuses what no file can have.
  std::uint64_t placed(std::uint64_t offset) const {
    return offset <= kOffsetMask ? (mounted_.size() << kPlaceBits) + offset : kNowhere;
  }
  /// Whether it lies in a file that was mounted.
  static bool is_mounted(std::uint64_t offset) { return offset >> kPlaceBits > 0; }
  /// What lies at `offset` is not what was written there: Error(io), or Error(corrupt) of a mounted
  /// file.
  Error changed(std::uint64_t offset) const;
  /// Forces what was appended to the disk; `check` as for File::sync(). While others append, what
  /// was there before.
  void sync(const std::function<void()>& check);
  /// Removes the file; nothing is left of what was appended.
  void remove();
  void read(std::uint64_t offset, std::span<std::byte> bytes) const {
    file_at(offset).read_exact(is_mounted(offset) ? offset & kOffsetMask : place_of(offset).offset,
                               bytes);
    pool_.scratch_use().add_read(bytes.size());
  }

 private:
  static constexpr int kPlaceBits = 44;  // 16 TiB
  static constexpr int kFileBits = 40;   // of them, for each file where there are several
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
  /// Where bytes are: in which of the own files, if they are not in a mounted one, and where there.
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

/// Where a scratch file holds a spool's bytes.
struct StoredSpool {
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;
  std::uint64_t block_bytes = 0;
  std::vector<std::uint64_t> blocks;  ///< their offsets
};

/// A sequence of bytes. One writer; after the last append() any number of readers.
class Spool {
 public:
  /// `block_bytes`: held while writing, the grain of what moves to disk; > 0.
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

  /// Forgets the content and gives its memory back.
  void clear();

  /// Puts all that is in memory on disk: for restore(), in another process even. Nothing can be
  /// appended any more.
  StoredSpool store();
  /// Takes what should be in the scratch file already; false if `stored` contradicts itself. On an
  /// empty spool.
  bool restore(const StoredSpool& stored);
  /// Of a restored spool: whether the scratch file holds what was stored; reads it all. Before
  /// anything is appended there.
  bool is_as_stored() const;
  /// Of a restored spool that is not as it was stored: ScratchFile::changed().
  Error changed() const { return scratch_->changed(blocks_.empty() ? 0 : blocks_[0].offset()); }

 private:
  /// Where a block's bytes are, in 8 bytes, as large meshes have many blocks. Owns nothing.
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
  /// Of a block, the last one included.
  std::size_t used_bytes(std::size_t block) const;

  ScratchFile* scratch_;
  std::size_t block_bytes_;
  std::byte* end_ = nullptr;  ///< where the next byte goes, while the last block has room
  std::size_t room_ = 0;
  std::uint64_t size_ = 0;
  std::uint64_t checksum_ = 0;  ///< of all blocks, each seeded with those before; without the last
                                ///< one as long as it is open
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
