// Files that live in memory.
#pragma once

#include "storage/file.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace meshhier::tests {

/// A file system whose files are strings. Only what readers and writers use is there.
class MemoryFiles : public storage::FileSystem {
 public:
  std::unique_ptr<storage::File> open(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> create(const std::filesystem::path& path) override;
  std::unique_ptr<storage::File> reopen(const std::filesystem::path& path) override;
  storage::FileIdentity identity(const std::filesystem::path& path) override;
  std::unique_ptr<storage::FileLock> try_lock(const std::filesystem::path&) override {
    return std::make_unique<storage::FileLock>();
  }
  bool exists(const std::filesystem::path& path) override;
  std::filesystem::path canonical(const std::filesystem::path& path) override { return path; }
  std::vector<std::filesystem::path> list(const std::filesystem::path&) override { return {}; }
  std::vector<std::filesystem::path> children(const std::filesystem::path&) override { return {}; }
  void make_directories(const std::filesystem::path&) override {}
  void remove_all(const std::filesystem::path& path) override;
  void rename(const std::filesystem::path& from, const std::filesystem::path& to) override;
  void sync_tree(const std::filesystem::path&) override {}
  std::uint64_t free_bytes(const std::filesystem::path&) override { return 0; }

  void put(const std::string& name, std::string content);
  const std::string& content(const std::string& name) const { return *contents_.at(name); }

 private:
  std::map<std::string, std::shared_ptr<std::string>> contents_;
};

}  // namespace meshhier::tests
