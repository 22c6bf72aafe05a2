// Files on the web, read like those of a disk.
#pragma once

#include "storage/io/forwarding_files.h"
#include "storage/io/http_client.h"
#include "storage/io/read_ahead.h"
#include "storage/io/remote_content.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// A file system in which the files below one address of the web can be read. Its path is the
/// address without user and query, "https://host/david.3tz", so that no message has secrets; files
/// below it are asked for with the same user and query. Paths elsewhere are the other file
/// system's. Nothing can be listed. Archives are taken to be there, until they are opened; a name
/// without a file's ending is taken for a directory. Fetched bytes are kept in a temporary file and
/// are not fetched again, but for JSON, which is asked for at each open().
class RemoteFiles final : public ForwardingFiles {
 public:
  /// `others` must outlive this, and this the files that it opens. `scratch`: a path for the
  /// temporary file, whose name is removed at once and whose space comes back with this object.
  /// `check` is as HttpClient's. Throws Error(io) if the temporary file cannot be made.
  RemoteFiles(FileSystem& others, const std::string& address, const std::filesystem::path& scratch,
              HttpOptions options, std::function<void()> check);
  ~RemoteFiles() override;

  /// The path that stands for the address.
  const std::filesystem::path& root() const { return root_; }
  const HttpCounters& counters() const { return client_->counters(); }

  /// Makes one request, or none for what was announced by will_read() or has been fetched. Reads of
  /// the file throw Error(io) if the host has another version of it by then.
  std::unique_ptr<File> open(const std::filesystem::path& path) override;
  FileIdentity identity(const std::filesystem::path& path) override;
  /// Where a name is a file's, both ask the host; so even kind() throws Error(io) if it does not
  /// answer.
  bool exists(const std::filesystem::path& path) override;
  FileKind kind(const std::filesystem::path& path) override;
  bool is_link(const std::filesystem::path& path) override;
  std::filesystem::path canonical(const std::filesystem::path& path) override;
  std::vector<std::filesystem::path> list(const std::filesystem::path& directory) override;
  bool can_list(const std::filesystem::path& directory) override;
  std::vector<std::filesystem::path> children(const std::filesystem::path& directory) override;
  void will_read(std::span<const std::filesystem::path> files) override;

 private:
  using Content = std::shared_ptr<RemoteContent>;

  bool is_remote(const std::filesystem::path& path) const;
  HttpAddress address_of(const std::filesystem::path& path) const;
  /// Both return null if there is no such file.
  Content load(const std::filesystem::path& path);
  Content find(const std::filesystem::path& path);
  bool is_there(const std::filesystem::path& path);

  std::filesystem::path root_;
  std::string before_;  ///< scheme, and the user if there is one
  std::string host_;    ///< scheme and host as root_ has them
  std::string behind_;  ///< the query
  std::unique_ptr<HttpClient> client_;
  std::unique_ptr<FetchedParts> parts_;
  std::mutex mutex_;  ///< guards contents_
  std::map<std::filesystem::path, Content> contents_;
  std::unique_ptr<ReadAhead<std::filesystem::path, Content>> ahead_;
};

}  // namespace meshhier::storage
