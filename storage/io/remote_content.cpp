#include "storage/io/remote_content.h"

#include "base/error.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// Bytes that are fetched at once for a small read, so that many of them are few requests.
constexpr std::uint64_t kBlock = std::uint64_t{1} << 16;

/// Returns all blocks that a small range lies in, or a large range itself.
File::Range fetched_for(const File::Range& range, std::uint64_t size) {
  if (range.bytes >= kBlock)
    return range;
  const std::uint64_t first = range.offset / kBlock * kBlock;
  const std::uint64_t end = (range.offset + range.bytes + kBlock - 1) / kBlock * kBlock;
  return {first, std::min(end, size) - first};
}

}  // namespace

std::uint64_t FetchedParts::append(std::span<const std::byte> bytes) {
  std::uint64_t place = 0;
  {
    const std::lock_guard lock(mutex_);
    place = end_;
    end_ += bytes.size();
  }
  file_->write_at(place, bytes);
  return place;
}

RemoteContent::RemoteContent(HttpClient& client, HttpAddress address, FetchedParts& parts,
                             const HttpAnswer& start, std::uint64_t asked)
    : client_(client),
      address_(std::move(address)),
      parts_(parts),
      ahead_(
          kFetchedAtOnce, kFetchedAhead, [this](const File::Range& range) { return fetch(range); },
          [](std::uint64_t bytes) { return bytes; }) {
  const std::uint64_t known = start.bytes.size();
  if (!start.is_whole && !start.total && known == asked)
    fail("the host does not tell how long it is (Content-Range)");
  size_ = start.is_whole ? known : start.total.value_or(known);
  if (size_ < known || (known < asked && known < size_))
    fail("the host sent another length than the file is said to have");
  version_ = start.version;
  keep(0, start.bytes);
}

void RemoteContent::fail(const char* what) const {
  throw Error(ErrorCode::io, fmt::format("{}: {}", address_.shown, what));
}

std::size_t RemoteContent::read(std::uint64_t offset, std::span<std::byte> bytes) {
  if (offset >= size_)
    return 0;
  const std::size_t count = std::min<std::uint64_t>(bytes.size(), size_ - offset);
  const std::span<std::byte> to = bytes.first(count);
  if (read_if_there(offset, to))
    return count;
  const auto covers = [&](const File::Range& range) {
    return range.offset <= offset && offset + count <= range.offset + range.bytes;
  };
  if (!ahead_.take(covers)) {
    if (const File::Range missing = missing_of({offset, count}); missing.bytes > 0)
      fetch(fetched_for(missing, size_));
  }
  const bool is_there = read_if_there(offset, to);
  assert(is_there);
  return is_there ? count : 0;
}

void RemoteContent::will_read(std::span<const File::Range> ranges) {
  std::vector<File::Range> far;
  std::ranges::copy_if(ranges, std::back_inserter(far), [&](const File::Range& range) {
    const bool is_sound = range.offset < size_ && range.bytes <= size_ - range.offset;
    return is_sound && range.bytes >= kBlock && missing_of(range).bytes > 0;
  });
  ahead_.announce(std::move(far));
}

std::uint64_t RemoteContent::fetch(const File::Range& range) {
  const HttpAnswer answer = client_.get(address_, range.offset, range.bytes);
  if (answer.is_whole || answer.version != version_ || answer.total.value_or(size_) != size_)
    fail("it has become another file on the host while it was read");
  if (answer.bytes.size() != range.bytes)
    fail("the host sent less than the part that was asked for");
  keep(range.offset, answer.bytes);
  return answer.bytes.size();
}

void RemoteContent::keep(std::uint64_t offset, std::span<const std::byte> bytes) {
  const std::uint64_t place = parts_.append(bytes);
  const std::lock_guard lock(mutex_);
  Part& part = there_[offset];
  if (part.end < offset + bytes.size())
    part = {offset + bytes.size(), place};
}

std::map<std::uint64_t, RemoteContent::Part>::const_iterator RemoteContent::part_at(
    std::uint64_t offset) const {
  const auto behind = there_.upper_bound(offset);
  if (behind == there_.begin())
    return there_.end();
  const auto before = std::prev(behind);
  return before->second.end > offset ? before : there_.end();
}

File::Range RemoteContent::missing_of(const File::Range& range) const {
  const std::lock_guard lock(mutex_);
  const std::uint64_t end = range.offset + range.bytes;
  std::uint64_t at = range.offset;
  for (auto part = part_at(at); part != there_.end() && at < end; part = part_at(at))
    at = part->second.end;
  return {at, end - std::min(at, end)};
}

bool RemoteContent::read_if_there(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    std::uint64_t place = 0;
    std::size_t count = 0;
    {
      const std::lock_guard lock(mutex_);
      const auto part = part_at(offset);
      if (part == there_.end())
        return false;
      place = part->second.place + (offset - part->first);
      count = std::min<std::uint64_t>(bytes.size(), part->second.end - offset);
    }
    parts_.read(place, bytes.first(count));
    bytes = bytes.subspan(count);
    offset += count;
  }
  return true;
}

}  // namespace meshhier::storage
