#include "storage/format/archive_writer.h"

#include "base/error.h"
#include "storage/format/gzip.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// Bytes that are copied at once; most tiles have fewer.
constexpr std::size_t kCopiedBlock = std::size_t{1} << 20;

}  // namespace

void ArchiveWriter::append(std::string_view name, std::uint64_t bytes, const ReadContent& read) {
  assert(is_archive_name(name));
  if (bytes > kMostFileBytes) {
    throw Error(ErrorCode::usage,
                fmt::format("{} has {} bytes; a file in a 3tz archive has at most {}: store the "
                            "hierarchy as files",
                            name, bytes, kMostFileBytes));
  }
  ArchiveEntry entry{std::string(name), end_, static_cast<std::uint32_t>(bytes), 0};
  for (std::uint64_t done = 0; done < bytes; done += block_.size()) {
    check_();
    block_.resize(std::min<std::uint64_t>(kCopiedBlock, bytes - done));
    read(done, block_);
    entry.crc = crc32(block_, entry.crc);
    archive_.write_at(entry.content() + done, block_);
  }
  // The header stands before the content, but has its CRC: so it is written after it.
  std::vector<std::byte> header;
  append_local_header(header, entry);
  archive_.write_at(entry.offset, header);
  end_ = entry.end();
}

void ArchiveWriter::add(std::string_view name, const File& content) {
  index_.push_back(index_place(name, end_));
  append(name, content.size(), [&](std::uint64_t offset, std::span<std::byte> bytes) {
    content.read_exact(offset, bytes);
  });
}

void ArchiveWriter::finish() {
  std::sort(index_.begin(), index_.end(), comes_before);
  const auto index = std::as_bytes(std::span(index_));
  append(kArchiveIndexName, index.size(), [&](std::uint64_t offset, std::span<std::byte> bytes) {
    std::copy_n(index.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
  });
  write_directory();
}

/// Makes the directory from the local headers in the file, so that no names are kept in memory.
void ArchiveWriter::write_directory() {
  ArchiveEnd end{index_.size() + 1, end_, 0};
  block_.clear();
  const auto flush = [&] {
    check_();
    archive_.write_at(end_, block_);
    end_ += block_.size();
    block_.clear();
  };
  std::vector<std::byte> header(kLocalHeaderBytes + kLongestArchiveName);
  for (std::uint64_t offset = 0; offset < end.directory;) {
    const std::size_t count = archive_.read_at(offset, header);
    const ArchiveEntry entry =
        parse_local_header(std::span(header).first(count), offset, archive_.path().string());
    append_central_header(block_, entry);
    if (block_.size() >= kCopiedBlock)
      flush();
    offset = entry.end();
  }
  flush();
  end.directory_bytes = end_ - end.directory;
  block_ = encode_archive_end(end);
  flush();
}

}  // namespace meshhier::storage
