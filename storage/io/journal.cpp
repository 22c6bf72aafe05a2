#include "storage/io/journal.h"

#include "storage/io/hash.h"
#include "storage/io/json_text.h"
#include "storage/io/little_endian.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::storage {
namespace {

constexpr std::array<std::byte, 8> kBegin{std::byte{'m'}, std::byte{'e'}, std::byte{'s'},
                                          std::byte{'h'}, std::byte{'j'}, std::byte{'r'},
                                          std::byte{'n'}, std::byte{1}};
constexpr std::size_t kHeadBytes = 12;

std::optional<Journal::Entry> parse(std::span<const std::byte> bytes) {
  Journal::Entry entry = parse_cbor(bytes);
  if (entry.is_discarded())
    return std::nullopt;
  return entry;
}

}  // namespace

Journal::Journal(FileSystem& files, const std::filesystem::path& path, ScratchUse& use,
                 const std::function<bool(const Entry&)>& take)
    : use_(use) {
  if (files.exists(path)) {
    file_ = files.reopen(path);
    read(take);
  } else {
    file_ = files.create(path);
  }
}

/// Returns false if there are not so many bytes.
bool Journal::read_all(std::uint64_t offset, std::span<std::byte> bytes) {
  const std::size_t count = file_->read_at(offset, bytes);
  use_.add_read(count);
  return count == bytes.size();
}

/// Writes at the end of what counts; what an interrupted run left there is overwritten.
void Journal::write(std::span<const std::byte> bytes) {
  file_->write_at(end_, bytes);
  end_ += bytes.size();
  use_.add_written(bytes.size());
  use_.add_grown(bytes.size());
}

void Journal::read(const std::function<bool(const Entry&)>& take) {
  std::array<std::byte, kBegin.size()> begin{};
  if (!read_all(0, begin) || begin != kBegin)
    return;
  end_ = begin.size();
  const std::uint64_t size = file_->size();
  for (;;) {
    std::array<std::byte, kHeadBytes> head{};
    if (!read_all(end_, head))
      return;
    const auto bytes = load_little<std::uint32_t>(head.data());
    if (bytes > size - end_ - kHeadBytes)
      return;
    std::vector<std::byte> text(bytes);
    if (!read_all(end_ + kHeadBytes, text))
      return;
    const auto expected = load_little<std::uint64_t>(head.data() + 4);
    if (checksum(text, last_checksum_) != expected)
      return;
    const std::optional<Entry> entry = parse(text);
    if (!entry || !take(*entry))
      return;
    end_ += kHeadBytes + bytes;
    last_checksum_ = expected;
  }
}

void Journal::append(const Entry& entry) {
  const std::vector<std::uint8_t> text = cbor_of(entry);
  const std::uint64_t sum = checksum(std::as_bytes(std::span(text)), last_checksum_);
  std::vector<std::byte> bytes;
  bytes.reserve(kBegin.size() + kHeadBytes + text.size());
  if (end_ == 0)
    bytes.assign(kBegin.begin(), kBegin.end());
  append_little(bytes, static_cast<std::uint32_t>(text.size()));
  append_little(bytes, sum);
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), first, first + text.size());
  write(bytes);
  last_checksum_ = sum;
}

}  // namespace meshhier::storage
