#include "storage/format/archive.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "storage/format/glb.h"
#include "storage/format/layout.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

constexpr std::size_t kDirectoryBlock = std::size_t{1} << 18;

std::vector<std::byte> last_bytes(const File& file) {
  const std::uint64_t size = file.size();
  std::vector<std::byte> last(std::min<std::uint64_t>(size, kLongestArchiveEnd));
  file.read_exact(size - last.size(), last);
  return last;
}

bool means_archive(const File& file, std::span<const std::byte> last) {
  std::vector<std::byte> first(std::min<std::uint64_t>(file.size(), sizeof(std::uint32_t)));
  file.read_exact(0, first);
  return looks_like_archive(first, last);
}

ArchiveEnd find_end(const File& file) {
  const std::vector<std::byte> last = last_bytes(file);
  if (!means_archive(file, last)) {
    throw Error(ErrorCode::io,
                fmt::format("{}: not a hierarchy: neither a directory nor a 3tz archive{}",
                            file.path().string(),
                            file.path().filename() == manifest_path({})
                                ? "; name the directory that it lies in"
                                : ""));
  }
  return parse_archive_end(last, file.size(), file.path().string());
}

/// Walks through the directory, block by block: memory follows what is there, not what is told.
class DirectoryWalk {
 public:
  DirectoryWalk(const File& file, const ArchiveEnd& end)
      : file_(file), at_(end.directory), stop_(end.directory + end.directory_bytes) {}

  bool is_at_end() const { return at_ == stop_ && rest_.empty(); }

  ArchiveEntry next() {
    if (rest_.size() < kLongestCentralHeader && at_ < stop_)
      refill();
    CentralHeader header = parse_central_header(rest_, offset_, file_.path().string());
    rest_ = rest_.subspan(header.bytes);
    offset_ = header.entry.end();
    return std::move(header.entry);
  }
  /// The end of the last entry, where the next one must begin.
  std::uint64_t offset() const { return offset_; }

 private:
  void refill() {
    std::vector<std::byte> block(rest_.begin(), rest_.end());
    const std::size_t more = std::min<std::uint64_t>(kDirectoryBlock, stop_ - at_);
    block.resize(rest_.size() + more);
    file_.read_exact(at_, std::span(block).last(more));
    at_ += more;
    block_ = std::move(block);
    rest_ = block_;
  }

  const File& file_;
  std::uint64_t at_, stop_;
  std::uint64_t offset_ = 0;
  std::vector<std::byte> block_;
  std::span<const std::byte> rest_;
};

[[noreturn]] void refuse_archive(const File& file, const std::string& what) {
  throw Error(ErrorCode::corrupt, fmt::format("{}: {}", file.path().string(), what));
}

/// Throws Error(corrupt) unless the last file is the index and has a place for each other file.
void check_last(const File& file, const ArchiveEnd& end, const ArchiveEntry& last) {
  if (last.name != kArchiveIndexName)
    refuse_archive(file, fmt::format("its last file is not {}", kArchiveIndexName));
  if (last.bytes != (end.entries - 1) * sizeof(IndexPlace))
    refuse_archive(
        file, fmt::format("{} has {} bytes, expected {} for each of {} files", kArchiveIndexName,
                          last.bytes, sizeof(IndexPlace), end.entries - 1));
}

}  // namespace

bool is_archive(const File& file) {
  return means_archive(file, last_bytes(file));
}

Archive::Archive(std::unique_ptr<File> file) : file_(std::move(file)), end_(find_end(*file_)) {
  DirectoryWalk walk(*file_, end_);
  ArchiveEntry last;
  while (!walk.is_at_end()) {
    last = walk.next();
    slots_.push_back({index_place(last.name, last.content()), last.bytes});
  }
  if (slots_.size() != end_.entries) {
    refuse_archive(*file_, fmt::format("it is said to have {} files, but lists {}", end_.entries,
                                       slots_.size()));
  }
  if (walk.offset() != end_.directory) {
    refuse_archive(*file_,
                   fmt::format("its files end at byte {}, the list of them begins at byte {}",
                               walk.offset(), end_.directory));
  }
  check_last(*file_, end_, last);
  const auto before = [](const Slot& a, const Slot& b) { return comes_before(a.place, b.place); };
  std::sort(slots_.begin(), slots_.end(), before);
  if (std::adjacent_find(slots_.begin(), slots_.end(), std::not_fn(before)) != slots_.end())
    refuse_archive(*file_, "it has two files of one name");
}

std::optional<Archive::Place> Archive::find(std::string_view name) const {
  const Slot wanted{index_place(name, 0), 0};
  const auto before = [](const Slot& a, const Slot& b) { return comes_before(a.place, b.place); };
  const auto found = std::lower_bound(slots_.begin(), slots_.end(), wanted, before);
  if (found == slots_.end() || before(wanted, *found))
    return std::nullopt;
  return Place{load_little<std::uint64_t>(found->place.data() + 16), found->bytes};
}

void Archive::for_each(const std::function<void(const ArchiveEntry&)>& visit) const {
  for (DirectoryWalk walk(*file_, end_); !walk.is_at_end();)
    visit(walk.next());
}

bool is_hierarchy_archive(FileSystem& files, const std::filesystem::path& path) {
  if (!files.exists(path) || files.is_directory(path))
    return false;
  const std::unique_ptr<File> file = files.open(path);
  std::vector<std::byte> first(kLocalHeaderBytes + kLongestArchiveName);
  first.resize(file->read_at(0, first));
  try {
    return parse_local_header(first, 0, {}).name == manifest_path({});
  } catch (const Error&) {
    return false;
  }
}

}  // namespace meshhier::storage
