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

/// A file system in which what is below one address of the web can be read. The path of that is the
/// address without user and query, "https://host/david.3tz", so that no message has secrets; files
/// below it are asked for with the same user and query. All else is done by the other one.
/// Nothing can be listed. Archives are taken to be there, until they are opened; what has no ending
/// of a file is taken for a directory. What is fetched is
/// kept in a temporary file, and is not fetched again.
class RemoteFiles final : public ForwardingFiles {
 public:
  /// `others` must outlive this, and this the files that it opens. `scratch`: of the temporary
  /// file, which is removed at once, and goes when this does.
  RemoteFiles(FileSystem& others, const std::string& address, const std::filesystem::path& scratch,
              HttpOptions options, std::function<void()> check);
  ~RemoteFiles() override;

  /// What the address is called here.
  const std::filesystem::path& root() const { return root_; }
  const HttpCounters& counters() const { return client_->counters(); }

  /// One request, or none of what was announced; Error(io) if it has become another file by the
  /// time a part of it is read.
  std::unique_ptr<File> open(const std::filesystem::path& path) override;
  FileIdentity identity(const std::filesystem::path& path) override;
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
  /// These two: null if there is no such file.
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
