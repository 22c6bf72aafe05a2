// Where a task works until what it made is sealed.
#pragma once

#include "execution/cancel.h"
#include "storage/format/segment.h"
#include "storage/io/file.h"

#include <filesystem>

namespace meshhier::pipeline {

/// A directory that no other attempt has; it goes with its object.
class Attempt {
 public:
  /// In the plan's directory `work`, or in `scratch` unless that is empty.
  Attempt(storage::FileSystem& files, std::filesystem::path work,
          const std::filesystem::path& scratch);
  Attempt(const Attempt&) = delete;
  Attempt& operator=(const Attempt&) = delete;
  ~Attempt();

  const std::filesystem::path& directory() const { return directory_; }
  /// In the plan's directory, made when it is asked for: for what gets its name by being renamed.
  std::filesystem::path shared_directory();

  /// Makes `data`, a file in directory() or none, with its entries the segment of that name, on
  /// disk. If another attempt has sealed one before, that stays.
  void seal(const storage::SegmentWriter& entries, const std::filesystem::path& data,
            const storage::SegmentName& name, const execution::CancelToken& cancel);

 private:
  storage::FileSystem& files_;
  std::filesystem::path work_;
  std::filesystem::path directory_;
  std::filesystem::path shared_;
};

}  // namespace meshhier::pipeline
