#include "storage/io/remote_files.h"

#include "base/error.h"
#include "storage/io/paths.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

namespace fs = std::filesystem;

/// Bytes that are asked for when a file is opened: most tiles have fewer. An archive is read in
/// parts, so that less is asked for.
constexpr std::uint64_t kStart = std::uint64_t{1} << 20;
constexpr std::uint64_t kArchiveStart = std::uint64_t{1} << 16;

class RemoteFile final : public ReadOnlyFile {
 public:
  RemoteFile(fs::path path, std::shared_ptr<RemoteContent> content, std::shared_ptr<IoCounters> use)
      : ReadOnlyFile(std::move(path)), content_(std::move(content)), use_(std::move(use)) {}

  std::uint64_t size() const override { return content_->size(); }
  void will_read(std::span<const Range> ranges) const override { content_->will_read(ranges); }

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    const std::size_t count = content_->read(offset, bytes);
    use_->bytes_read += count;
    return count;
  }

 private:
  std::shared_ptr<RemoteContent> content_;
  std::shared_ptr<IoCounters> use_;
};

std::unique_ptr<File> make_temporary(FileSystem& files, const fs::path& path) {
  std::unique_ptr<File> file = files.create(path);
  files.remove_all(path);
  return file;
}

/// Whether it is a file's among the names that hierarchies have; all others are directories'.
bool is_name_of_file(const fs::path& path) {
  const std::string ending = path.extension().string();
  constexpr std::array<std::string_view, 4> kEndings{".bin", ".glb", ".json", ".webp"};
  return std::ranges::find(kEndings, ending) != kEndings.end();
}

/// JSON says what the other files are: who opens it again wants what it says by then.
bool may_change(const fs::path& path) {
  return path.extension() == ".json";
}

/// Tiles may be stored as gzip: what a host calls their encoding is the file.
bool is_packed_itself(const fs::path& path) {
  return path.extension() == ".glb";
}

bool is_archive(const fs::path& path) {
  return lower_extension(path) == ".3tz";
}

}  // namespace

RemoteFiles::RemoteFiles(FileSystem& others, const std::string& address, const fs::path& scratch,
                         HttpOptions options, std::function<void()> check)
    : ForwardingFiles(others),
      client_(std::make_unique<HttpClient>(std::move(options), std::move(check))),
      parts_(std::make_unique<FetchedParts>(make_temporary(others, scratch))) {
  const std::string whole = address.substr(0, address.find('#'));
  const std::size_t query = whole.find('?');
  behind_ = query == std::string::npos ? "" : whole.substr(query);
  const std::string place = whole.substr(0, query);
  const std::size_t host = place.find("//") + 2;
  const std::size_t path = std::min(place.find('/', host), place.size());
  const std::size_t user = place.substr(0, path).rfind('@');
  const bool has_user = user != std::string::npos && user >= host;
  host_ = place.substr(0, host);
  before_ = has_user ? place.substr(0, user + 1) : host_;
  root_ = host_ + place.substr(has_user ? user + 1 : host);
  ahead_ = std::make_unique<ReadAhead<fs::path, Content>>(
      kFetchedAtOnce, kFetchedAhead, [this](const fs::path& file) { return load(file); },
      [](const Content& content) { return content ? std::min(content->size(), kStart) : 0; });
}
RemoteFiles::~RemoteFiles() {
  client_->stop();  // nobody asks any more for files that are fetched ahead
}

bool RemoteFiles::is_remote(const fs::path& path) const {
  return path.native().starts_with(root_.native());
}

HttpAddress RemoteFiles::address_of(const fs::path& path) const {
  const std::string& shown = path.native();
  return {before_ + shown.substr(host_.size()) + behind_, shown};
}

RemoteFiles::Content RemoteFiles::load(const fs::path& path) {
  const std::uint64_t asked = is_archive(path) ? kArchiveStart : kStart;
  const auto start = client_->find(address_of(path), 0, asked);
  if (!start)
    return nullptr;
  if (!start->encoding.empty() && !is_packed_itself(path))
    throw Error(ErrorCode::io, fmt::format("{}: {}", path.string(), kSentPacked));
  auto content =
      std::make_shared<RemoteContent>(*client_, address_of(path), *parts_, *start, asked);
  const std::lock_guard lock(mutex_);
  return contents_.try_emplace(path, std::move(content)).first->second;
}

RemoteFiles::Content RemoteFiles::find(const fs::path& path) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = contents_.find(path); found != contents_.end())
      return found->second;
  }
  const auto ready = ahead_->take([&](const fs::path& one) { return one == path; });
  return ready ? *ready : load(path);
}

bool RemoteFiles::is_there(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  return contents_.contains(path);
}

std::unique_ptr<File> RemoteFiles::open(const fs::path& path) {
  if (!is_remote(path))
    return others().open(path);
  Content content = find(path);
  if (!content)
    throw Error(ErrorCode::io, fmt::format("{}: there is no such file on the host", path.string()));
  if (may_change(path)) {
    const std::lock_guard lock(mutex_);
    contents_.erase(path);
  }
  return std::make_unique<RemoteFile>(path, std::move(content), counters_);
}

FileIdentity RemoteFiles::identity(const fs::path& path) {
  if (!is_remote(path))
    return others().identity(path);
  return {.bytes = open(path)->size()};
}

bool RemoteFiles::exists(const fs::path& path) {
  if (!is_remote(path))
    return others().exists(path);
  return !is_name_of_file(path) || find(path) != nullptr;
}

FileKind RemoteFiles::kind(const fs::path& path) {
  if (!is_remote(path))
    return others().kind(path);
  if (!is_name_of_file(path) && !is_archive(path))
    return FileKind::directory;
  return exists(path) ? FileKind::regular : FileKind::none;
}

bool RemoteFiles::is_link(const fs::path& path) {
  return !is_remote(path) && others().is_link(path);
}

fs::path RemoteFiles::canonical(const fs::path& path) {
  return is_remote(path) ? path : others().canonical(path);
}

std::vector<fs::path> RemoteFiles::list(const fs::path& directory) {
  if (!is_remote(directory))
    return others().list(directory);
  throw Error(ErrorCode::io,
              fmt::format("{}: on the web nothing can be listed", directory.string()));
}

bool RemoteFiles::can_list(const fs::path& directory) {
  return !is_remote(directory) && others().can_list(directory);
}

std::vector<fs::path> RemoteFiles::children(const fs::path& directory) {
  return is_remote(directory) ? list(directory) : others().children(directory);
}

void RemoteFiles::will_read(std::span<const fs::path> files) {
  std::vector<fs::path> far;
  std::ranges::copy_if(files, std::back_inserter(far),
                       [&](const fs::path& file) { return is_remote(file) && !is_there(file); });
  ahead_->announce(std::move(far));
}

}  // namespace meshhier::storage
