// A folder in which permissions are missing; tests run as root, who has them all.
#pragma once

#include "base/error.h"
#include "storage/io/file.h"
#include "storage/io/folder.h"
#include "storage/io/system_failure.h"

#include <cerrno>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::tests {

/// Another folder of which nothing can be opened while too many files are open.
class BusyFolder final : public storage::Folder {
 public:
  explicit BusyFolder(std::shared_ptr<const storage::Folder> real)
      : Folder(real->path()), real_(std::move(real)) {}

  bool is_in_place() const override { return real_->is_in_place(); }

  /// So many calls are done as ever, then none; -1: all.
  mutable int calls_left = -1;

  std::unique_ptr<storage::File> open(std::string_view name) const override {
    count();
    return real_->open(name);
  }
  std::vector<storage::FolderEntry> entries(std::string_view name) const override {
    count();
    return real_->entries(name);
  }

 private:
  void count() const {
    if (calls_left == 0)
      storage::fail_system("open", path(), EMFILE);
    if (calls_left > 0)
      --calls_left;
  }

  std::shared_ptr<const storage::Folder> real_;
};

/// Another folder of which some files, and directories ("name/") with all below them, cannot be
/// read.
class RefusingFolder final : public storage::Folder {
 public:
  RefusingFolder(std::shared_ptr<const storage::Folder> real, std::set<std::string> refused)
      : Folder(real->path()), real_(std::move(real)), refused_(std::move(refused)) {}

  bool is_in_place() const override { return real_->is_in_place(); }
  std::unique_ptr<storage::File> open(std::string_view name) const override {
    check(name);
    return real_->open(name);
  }
  std::vector<storage::FolderEntry> entries(std::string_view name) const override {
    check(name);
    return real_->entries(name);
  }

 private:
  void check(std::string_view name) const {
    for (const std::string& refused : refused_) {
      const bool is_directory = refused.ends_with('/');
      if (is_directory ? (std::string(name) + '/').starts_with(refused) : name == refused)
        throw Error(ErrorCode::io, "cannot open " + std::string(name) + ": refused");
    }
  }

  std::shared_ptr<const storage::Folder> real_;
  std::set<std::string> refused_;
};

}  // namespace meshhier::tests
