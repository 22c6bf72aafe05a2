// The directory that a task works in until its result is sealed.
#pragma once

#include "execution/cancel.h"
#include "storage/format/segment.h"
#include "storage/io/file.h"

#include <filesystem>

namespace meshhier::pipeline {

/// A directory that no other attempt has; it goes with its object.
class Attempt {
 public:
  /// Makes it in the plan's directory `work`, or in `scratch` unless that is empty. Throws
  /// Error(io).
  Attempt(storage::FileSystem& files, std::filesystem::path work,
          const std::filesystem::path& scratch);
  Attempt(const Attempt&) = delete;
  Attempt& operator=(const Attempt&) = delete;
  ~Attempt();

  const std::filesystem::path& directory() const { return directory_; }
  /// Returns a directory in the plan's directory, made when it is first asked for: files there can
  /// get their names by being renamed.
  std::filesystem::path shared_directory();

  /// Makes `data`, a file in directory() or none, the segment of that name, with its entries, and
  /// forces it to the disk. If another attempt has sealed one before, and it is whole, that stays.
  /// Throws Error(io | interrupted).
  void seal(const storage::SegmentWriter& entries, const std::filesystem::path& data,
            const storage::SegmentName& name, const execution::CancelToken& cancel);

 private:
  storage::FileSystem& files_;
  std::filesystem::path work_;
  std::filesystem::path directory_;
  std::filesystem::path shared_;
};

}  // namespace meshhier::pipeline
