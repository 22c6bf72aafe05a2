#include "storage/format/archive_check.h"

#include "storage/format/glb.h"
#include "storage/format/gzip.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

constexpr std::size_t kCheckedBlock = std::size_t{1} << 20;
static_assert(kCheckedBlock > kLocalHeaderBytes + kLongestArchiveName);

struct CheckJob {
  const Archive& archive;
  const std::function<void()>& check;
  const std::function<void(const std::string&)>& tell;
  std::vector<std::byte> block;

  std::span<const std::byte> read(std::uint64_t offset, std::uint64_t bytes) {
    check();
    block.resize(std::min<std::uint64_t>(kCheckedBlock, bytes));
    archive.file().read_exact(offset, block);
    return block;
  }
  void add(const std::string& name, const std::string& what) const {
    tell(fmt::format("{}: {}: {}", archive.file().path().string(), name, what));
  }
};

void check_header(CheckJob& job, const ArchiveEntry& entry) {
  std::vector<std::byte> expected;
  append_local_header(expected, entry);
  const auto found = job.read(entry.offset, expected.size());
  if (!std::equal(found.begin(), found.end(), expected.begin()))
    job.add(entry.name, fmt::format("its header at byte {} is damaged", entry.offset));
}

void check_content(CheckJob& job, const ArchiveEntry& entry) {
  std::uint32_t crc = 0;
  for (std::uint64_t at = entry.content(); at < entry.end(); at += job.block.size())
    crc = crc32(job.read(at, entry.end() - at), crc);
  if (crc != entry.crc)
    job.add(entry.name, fmt::format("CRC-32 is {:08x}, expected {:08x}", crc, entry.crc));
}

/// Returns the name that a header at an offset of the archive has; nothing if there is no header.
std::optional<std::string> name_at(const CheckJob& job, std::uint64_t offset, std::uint64_t end) {
  std::vector<std::byte> header(std::min<std::uint64_t>(kLocalHeaderBytes + kLongestArchiveName,
                                                        end - std::min(offset, end)));
  if (header.size() <= kLocalHeaderBytes)
    return std::nullopt;
  job.archive.file().read_exact(offset, header);
  const std::size_t bytes = load_little<std::uint16_t>(header.data() + 26);
  if (bytes > header.size() - kLocalHeaderBytes)
    return std::nullopt;
  return std::string(reinterpret_cast<const char*>(header.data()) + kLocalHeaderBytes, bytes);
}

bool leads_to(const CheckJob& job, const IndexPlace& place, std::uint64_t offset,
              const std::optional<std::string>& name) {
  if (!name || index_place(*name, offset) != place)
    return false;
  const auto listed = job.archive.find(*name);
  return listed && listed->offset == offset + kLocalHeaderBytes + name->size();
}

/// Checks that each place leads to a header with its name, and that places ascend: as there are as
/// many as files, each file has one.
void check_index(CheckJob& job, const ArchiveEntry& index) {
  std::optional<IndexPlace> last;
  for (std::uint64_t at = index.content(); at < index.end(); at += sizeof(IndexPlace)) {
    job.check();
    IndexPlace place;
    job.archive.file().read_exact(at, place);
    const auto offset = load_little<std::uint64_t>(place.data() + 16);
    const std::optional<std::string> name = name_at(job, offset, index.offset);
    if (!leads_to(job, place, offset, name) || (last && !comes_before(*last, place))) {
      return job.add(index.name, fmt::format("its place at byte {} is damaged", at));
    }
    last = place;
  }
}

/// Announces what will be read.
void announce(const Archive& archive) {
  std::vector<File::Range> ranges;
  archive.for_each([&](const ArchiveEntry& entry) {
    std::uint64_t begin = entry.offset;
    for (std::uint64_t end = entry.content(); end < entry.end(); begin = end) {
      end += std::min<std::uint64_t>(kCheckedBlock, entry.end() - end);
      ranges.push_back({begin, end - begin});
    }
  });
  archive.file().will_read(ranges);
}

}  // namespace

void check_archive(const Archive& archive, const std::function<void()>& check,
                   const std::function<void(const std::string&)>& tell) {
  announce(archive);
  CheckJob job{archive, check, tell, {}};
  archive.for_each([&](const ArchiveEntry& entry) {
    check_header(job, entry);
    check_content(job, entry);
    if (entry.name == kArchiveIndexName)
      check_index(job, entry);
  });
}

}  // namespace meshhier::storage
