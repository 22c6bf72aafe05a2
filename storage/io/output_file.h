// The one file that a command makes.
#pragma once

#include "storage/io/file.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::storage {

/// Stands for standard output on the command line.
inline constexpr const char* kStandardOutput = "-";

struct OutputRequest {
  std::filesystem::path path;                   ///< a file, or kStandardOutput
  bool replace = false;                         ///< a regular file that is there
  std::vector<std::filesystem::path> inputs{};  ///< files and directories that stay as they are
  bool is_own_name =
      false;  ///< nobody has named it: a link or FIFO there is replaced, not followed
};

/// Whether all that is written there goes to standard output, which then can take nothing else.
bool is_standard_output(FileSystem& files, const std::filesystem::path& path);

/// The one rule for all that is written: nothing takes the place of what was read. Throws
/// Error(usage) if the output is one of the inputs, lies in one or holds one, by whatever name: a
/// link, another spelling, a second name of the file. An empty path is none.
void require_apart(FileSystem& files, const std::filesystem::path& output,
                   std::span<const std::filesystem::path> inputs);

/// These return paths beside `file`: its name until it is whole, scratch to make it with, and the
/// lock of the process that makes it.
std::filesystem::path unfinished_path(const std::filesystem::path& file);
std::filesystem::path scratch_path(const std::filesystem::path& file);
std::filesystem::path output_lock_path(const std::filesystem::path& file);

/// Locks output_lock_path(output), which `named` stands for in messages, and calls `check` while
/// another command holds it. Throws Error(locked) if that does not end within 3 s; Error(io).
std::unique_ptr<FileLock> lock_output(FileSystem& files, const std::filesystem::path& output,
                                      const std::filesystem::path& named,
                                      const std::function<void()>& check);

/// A regular file is there complete or not at all: it gets its name when it is published. A FIFO or
/// a character device, such as standard output, takes the bytes as they come. Nothing else is
/// written to. One thread at a time may use an OutputFile; `files` must outlive it.
class OutputFile {
 public:
  /// Refuses now what can be refused before the work: throws Error(usage) if the path is no file's,
  /// and as require_apart(); Error(exists) if there is a file that is not to be replaced;
  /// Error(locked) if another process is writing it, and does not end within 3 s; Error(io) if it
  /// cannot be written. `check` is called every 50 ms while that, or a stream's reader, is waited
  /// for, in writes too, and in publish(); it may throw.
  OutputFile(
      FileSystem& files, const OutputRequest& request, const std::function<void()>& check = [] {});
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Removes what was not published.
  ~OutputFile();

  /// The file to write, from the first byte to the last. Null once it is published.
  const std::shared_ptr<File>& file() const { return file_; }
  /// A path for a temporary file of whoever writes: beside a regular file, else in the system's
  /// directory for temporary files. Who makes a file there removes it.
  const std::filesystem::path& scratch() const { return scratch_; }

  /// Forces the file to the disk and gives it its name; closes a stream. Throws Error(io), and
  /// Error(exists) if a file that is not to be replaced has appeared.
  void publish();
  /// Writes `bytes`, which are the whole file, and publishes it.
  void publish(std::span<const std::byte> bytes);

 private:
  friend void publish_all(std::span<OutputFile* const> outputs);

  void open_stream(const std::filesystem::path& path);
  void open_regular(const OutputRequest& request);
  void force();
  void give_name();
  void give_name_for_now();
  void take_name_back();
  void settle();
  void require_replaceable() const;

  FileSystem& files_;
  std::function<void()> check_;
  bool replace_;
  bool is_own_name_;
  std::filesystem::path target_;     ///< empty: a stream
  std::filesystem::path temporary_;  ///< its name until it is published
  bool has_replaced_ = false;        ///< the temporary one is what it has replaced
  std::filesystem::path scratch_;
  std::filesystem::path own_directory_;  ///< a stream's, in the system's for temporary files
  std::unique_ptr<FileLock> lock_;
  std::shared_ptr<File> file_;
};

/// Publishes files that belong together: all get their names, or none and what they would replace
/// stays. Only a process that ends between two renames, or a file system that cannot exchange
/// files, leaves some of them. Throws as OutputFile::publish().
void publish_all(std::span<OutputFile* const> outputs);

}  // namespace meshhier::storage
