// A file system that passes every call on to another one: the base of those that differ in a few
// things.
#pragma once

#include "storage/io/file.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

class ForwardingFiles : public FileSystem {
 public:
  /// `others` must outlive this.
  explicit ForwardingFiles(FileSystem& others) : others_(others) {}

  std::unique_ptr<File> open(const std::filesystem::path& path) override {
    return others_.open(path);
  }
  std::unique_ptr<File> create(const std::filesystem::path& path) override {
    return others_.create(path);
  }
  std::unique_ptr<File> reopen(const std::filesystem::path& path) override {
    return others_.reopen(path);
  }
  std::unique_ptr<File> open_stream(const std::filesystem::path& path,
                                    const std::function<void()>& check) override {
    return others_.open_stream(path, check);
  }
  FileIdentity identity(const std::filesystem::path& path) override {
    return others_.identity(path);
  }
  std::unique_ptr<FileLock> try_lock(const std::filesystem::path& path) override {
    return others_.try_lock(path);
  }
  bool is_locked(const std::filesystem::path& path) override { return others_.is_locked(path); }
  bool exists(const std::filesystem::path& path) override { return others_.exists(path); }
  FileKind kind(const std::filesystem::path& path) override { return others_.kind(path); }
  bool is_link(const std::filesystem::path& path) override { return others_.is_link(path); }
  std::filesystem::path canonical(const std::filesystem::path& path) override {
    return others_.canonical(path);
  }
  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override {
    return others_.list(directory);
  }
  bool can_list(const std::filesystem::path& directory) override {
    return others_.can_list(directory);
  }
  std::vector<std::filesystem::path> children(const std::filesystem::path& directory) override {
    return others_.children(directory);
  }
  void make_directories(const std::filesystem::path& path) override {
    others_.make_directories(path);
  }
  void remove_all(const std::filesystem::path& path) override { others_.remove_all(path); }
  void remove_if_empty(const std::filesystem::path& directory) override {
    others_.remove_if_empty(directory);
  }
  void rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    others_.rename(from, to);
  }
  bool rename_new(const std::filesystem::path& from, const std::filesystem::path& to) override {
    return others_.rename_new(from, to);
  }
  bool exchange(const std::filesystem::path& a, const std::filesystem::path& b) override {
    return others_.exchange(a, b);
  }
  void sync_directory(const std::filesystem::path& directory) override {
    others_.sync_directory(directory);
  }
  void sync_tree(const std::filesystem::path& directory) override { others_.sync_tree(directory); }
  std::uint64_t free_bytes(const std::filesystem::path& directory) override {
    return others_.free_bytes(directory);
  }
  std::string why_not_writable(const std::filesystem::path& directory) override {
    return others_.why_not_writable(directory);
  }
  void will_read(std::span<const std::filesystem::path> files) override {
    others_.will_read(files);
  }

 protected:
  FileSystem& others() const { return others_; }

 private:
  FileSystem& others_;
};

}  // namespace meshhier::storage
