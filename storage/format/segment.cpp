#include "storage/format/segment.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/io/hash.h"
#include "storage/io/json_text.h"
#include "storage/io/little_endian.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

constexpr std::array<std::byte, 8> kBegin{std::byte{'m'}, std::byte{'e'}, std::byte{'s'},
                                          std::byte{'h'}, std::byte{'s'}, std::byte{'e'},
                                          std::byte{'g'}, std::byte{1}};
constexpr std::size_t kSealBytes = 40;

std::string file_name(const SegmentName& name) {
  return fmt::format("{}-{:05}", name.stage, name.index);
}

std::uint64_t checksum_of(std::span<const std::byte> entries, const SegmentName& name) {
  const std::string text = file_name(name);
  return checksum(entries, checksum(std::as_bytes(std::span(text)), name.plan));
}

[[noreturn]] void refuse(const std::filesystem::path& path, const char* what) {
  throw Error(ErrorCode::corrupt,
              fmt::format("{} {}: remove it, and run its task again", path.string(), what));
}

}  // namespace

std::filesystem::path segment_path(const std::filesystem::path& work, const SegmentName& name) {
  return segments_path(work) / file_name(name);
}

void SegmentWriter::append(const Entry& entry) {
  const std::vector<std::uint8_t> text = cbor_of(entry);
  append_little(entries_, static_cast<std::uint32_t>(text.size()));
  const auto bytes = std::as_bytes(std::span(text));
  entries_.insert(entries_.end(), bytes.begin(), bytes.end());
}

void SegmentWriter::seal(File& file, std::uint64_t data_bytes) const {
  std::vector<std::byte> end(kBegin.begin(), kBegin.end());
  append_little(end, name_.plan);
  append_little(end, data_bytes);
  append_little(end, std::uint64_t{entries_.size()});
  append_little(end, checksum_of(entries_, name_));
  file.write_at(data_bytes, entries_);
  file.write_at(data_bytes + entries_.size(), end);
  file.sync();
}

std::unique_ptr<Segment> Segment::open(FileSystem& files, const std::filesystem::path& work,
                                       const SegmentName& name) {
  try {
    return std::unique_ptr<Segment>(new Segment(files.open(segment_path(work, name)), name));
  } catch (const NotThere&) {
    return nullptr;
  }
}

bool Segment::is_whole(FileSystem& files, const std::filesystem::path& work,
                       const SegmentName& name) {
  try {
    return open(files, work, name) != nullptr;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt)
      throw;
    return false;
  }
}

Segment::Segment(std::unique_ptr<File> file, const SegmentName& name)
    : path_(file->path()), file_(std::move(file)) {
  const std::uint64_t size = file_->size();
  std::array<std::byte, kSealBytes> seal{};
  if (size < seal.size())
    refuse(path_, "is not whole");
  file_->read_exact(size - seal.size(), seal);
  if (!std::equal(kBegin.begin(), kBegin.end(), seal.begin()))
    refuse(path_, "is not whole");
  const auto number = [&](std::size_t i) { return load_little<std::uint64_t>(&seal[8 * i]); };
  if (number(1) != name.plan)
    refuse(path_, "belongs to another plan");
  data_bytes_ = number(2);
  const std::uint64_t before = size - seal.size();
  if (data_bytes_ > before || number(3) != before - data_bytes_)
    refuse(path_, "is damaged");
  entries_.resize(number(3));
  file_->read_exact(data_bytes_, entries_);
  if (checksum_of(entries_, name) != number(4))
    refuse(path_, "is damaged");
}

void Segment::for_each(const std::function<bool(const EntrySink::Entry&)>& visit) const {
  std::span<const std::byte> left(entries_);
  while (!left.empty()) {
    constexpr std::size_t kLength = 4;
    const std::size_t bytes =
        left.size() < kLength ? left.size() : load_little<std::uint32_t>(left.data());
    if (bytes + kLength > left.size())
      refuse(path_, "is damaged");
    const auto entry = parse_cbor(left.subspan(kLength, bytes));
    if (entry.is_discarded() || !visit(entry))
      refuse(path_, "does not fit the plan");
    left = left.subspan(kLength + bytes);
  }
}

}  // namespace meshhier::storage
