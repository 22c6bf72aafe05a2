// A file system that fails on demand: another one, with chosen calls made to go wrong.
#pragma once

#include "storage/io/file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

namespace meshhier::tests {

/// The kinds of calls that can be told to fail.
enum class Call : std::size_t {
  open,
  create,
  size,
  read,
  write,
  sync,
  make_directories,
  remove_all,
  rename,
  sync_tree,
  free_bytes,
  reopen,
  identity,
  lock,
  exists,
  list,
  any  ///< all of them, counted together
};
inline constexpr std::size_t kCallKinds = 17;

/// When calls go wrong. Shared by a file system and its open files; thread-safe.
class FaultPlan {
 public:
  /// Counts one call; true if it is to fail.
  bool strike(Call call);
  /// Bytes that one read or write may move, of so many asked for.
  std::size_t transfer(std::size_t asked) const;
  /// Bytes of a write that still fit on the disk, of so many asked for; they are used up.
  std::size_t claim(std::size_t asked);

 private:
  friend class FaultyFileSystem;
  struct Fault {
    std::uint64_t calls = 0;  ///< so far
    std::uint64_t first = 0;  ///< number of the first call that fails, from 1
    std::uint64_t last = 0;
  };

  mutable std::mutex mutex_;
  std::array<Fault, kCallKinds> faults_;
  std::size_t most_moved_ = std::numeric_limits<std::size_t>::max();
  std::uint64_t room_ = std::numeric_limits<std::uint64_t>::max();
  bool room_is_told_ = true;
};

/// Thread-safe. Forces nothing to the disk, which takes its time and changes nothing as long as the
/// machine runs. A call that is told to fail throws Error(io), "injected", and does nothing; a full
/// disk takes what fits and then throws, as the real one does.
class FaultyFileSystem final : public storage::FileSystem {
 public:
  FaultyFileSystem() : FaultyFileSystem(storage::make_posix_file_system()) {}
  explicit FaultyFileSystem(std::shared_ptr<storage::FileSystem> real) : real_(std::move(real)) {}

  /// From now on the n-th call of the kind (1: the next) and the `times` - 1 after it fail. `fail`
  /// again to change it; times = 0: none does.
  void fail(Call call, std::uint64_t n, std::uint64_t times = 1);
  /// No read or write moves more than so many bytes at once; > 0.
  void limit_transfers(std::size_t most_bytes);
  /// The disk takes so many more bytes of writes. Removing files makes no room.
  void limit_room(std::uint64_t bytes);
  /// As limit_room(), but the disk does not say so.
  void limit_writes(std::uint64_t bytes);
  /// From now on it is one that cannot exchange names.
  void deny_exchange() { can_exchange_ = false; }
  /// Calls of a kind so far, failed ones included.
  std::uint64_t calls(Call call) const;

  std::unique_ptr<storage::File> open(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> create(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> reopen(const std::filesystem::path& path) override;
  storage::FileIdentity identity(const std::filesystem::path& path) override;
  std::unique_ptr<storage::FileLock> try_lock(const std::filesystem::path& path) override;
  bool is_locked(const std::filesystem::path& path) override;  ///< never fails
  bool exists(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> open_stream(const std::filesystem::path& path,
                                             const std::function<void()>& check) override;
  storage::FileKind kind(const std::filesystem::path& path) override;  ///< never fails
  bool is_link(const std::filesystem::path& path) override;            ///< likewise
  std::filesystem::path canonical(const std::filesystem::path& path) override;
  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override;
  std::vector<std::filesystem::path> children(const std::filesystem::path& directory) override;
  void make_directories(const std::filesystem::path& path) override;
  void remove_all(const std::filesystem::path& path) override;
  void remove_if_empty(const std::filesystem::path& directory) override;
  void rename(const std::filesystem::path& from, const std::filesystem::path& to) override;
  bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) override;
  bool exchange(const std::filesystem::path& a, const std::filesystem::path& b) override;
  void sync_directory(const std::filesystem::path& directory) override;
  void sync_tree(const std::filesystem::path& directory) override;
  /// The real figure, or the room left if that is less.
  std::uint64_t free_bytes(const std::filesystem::path& directory) override;

 private:
  void strike(Call call, const std::filesystem::path& path);

  std::shared_ptr<storage::FileSystem> real_;
  bool can_exchange_ = true;
  std::shared_ptr<FaultPlan> plan_ = std::make_shared<FaultPlan>();
};

}  // namespace meshhier::tests
