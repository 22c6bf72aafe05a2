// A file system in memory: fast enough to damage every byte of a hierarchy and look what happens,
// and for hundreds of builds, of which each would wait for a disk.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::tests {

/// Paths are taken as they are written, normalized; there are no links. Has a directory /models
/// from the start. Thread-safe.
class MemoryFiles : public storage::FileSystem {
 public:
  using Bytes = std::vector<std::byte>;

  std::unique_ptr<storage::File> open(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> create(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> reopen(const std::filesystem::path& path) override;
  storage::FileIdentity identity(const std::filesystem::path& path) override;
  std::unique_ptr<storage::FileLock> try_lock(const std::filesystem::path& path) override;
  bool is_locked(const std::filesystem::path& path) override { return exists(path); }
  bool exists(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> open_stream(const std::filesystem::path& path,
                                             const std::function<void()>&) override {
    return open(path);
  }
  storage::FileKind kind(const std::filesystem::path& path) override;
  std::filesystem::path canonical(const std::filesystem::path& path) override;
  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override;
  std::vector<std::filesystem::path> children(const std::filesystem::path& directory) override;
  void make_directories(const std::filesystem::path& path) override;
  void remove_all(const std::filesystem::path& path) override;
  void remove_if_empty(const std::filesystem::path& directory) override {
    if (list(directory).empty())
      remove_all(directory);
  }
  void rename(const std::filesystem::path& from, const std::filesystem::path& to) override;
  bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) override;
  bool exchange(const std::filesystem::path&, const std::filesystem::path&) override {
    return false;
  }
  void sync_directory(const std::filesystem::path&) override {}
  void sync_tree(const std::filesystem::path&) override {}
  std::uint64_t free_bytes(const std::filesystem::path&) override { return std::uint64_t{1} << 40; }

  /// A file's content, to be looked at and changed while nobody else does. Requires the file to be
  /// there.
  Bytes& bytes(const std::filesystem::path& path);

  /// The same as text.
  void put(const std::filesystem::path& path, std::string_view content);
  std::string content(const std::filesystem::path& path);

  struct Content {
    Bytes bytes;
    std::mutex mutex;
  };

 private:
  bool has_directory(const std::filesystem::path& path) const;

  std::mutex mutex_;  ///< guards the members below
  std::map<std::filesystem::path, std::shared_ptr<Content>> files_;
  /// Those made, and the three that are there from the start; others are there by their files.
  std::set<std::filesystem::path> directories_{"/", ".", "/models"};
};

}  // namespace meshhier::tests
