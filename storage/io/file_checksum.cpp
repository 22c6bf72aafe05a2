#include "storage/io/file_checksum.h"

#include "storage/io/hash.h"

#include <algorithm>
#include <array>

namespace meshhier::storage {
namespace {

std::size_t block_count(std::uint64_t file_bytes) {
  return static_cast<std::size_t>((file_bytes + FileChecksum::kBlockBytes - 1) /
                                  FileChecksum::kBlockBytes);
}

std::array<std::byte, 8> little_endian(std::uint64_t value) {
  std::array<std::byte, 8> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(value >> (8 * i));
  return bytes;
}

}  // namespace

FileChecksum::FileChecksum(std::uint64_t file_bytes)
    : file_bytes_(file_bytes), sums_(block_count(file_bytes)), known_(sums_.size()) {}

std::size_t FileChecksum::block_bytes(std::size_t block) const {
  return static_cast<std::size_t>(
      std::min<std::uint64_t>(kBlockBytes, file_bytes_ - std::uint64_t{block} * kBlockBytes));
}

void FileChecksum::add(std::uint64_t offset, std::span<const std::byte> bytes) {
  const std::uint64_t end = offset + bytes.size();
  for (std::uint64_t block = (offset + kBlockBytes - 1) / kBlockBytes; block < sums_.size();
       ++block) {
    const std::uint64_t begin = block * kBlockBytes;
    const std::size_t size = block_bytes(block);
    if (begin + size > end)
      return;
    // One thread computes it, and the others, which may have read the same, go on.
    if (!known_[block].exchange(true))
      sums_[block] = checksum(bytes.subspan(begin - offset, size));
  }
}

std::vector<BlockSums> FileChecksum::known() const {
  std::vector<BlockSums> runs;
  for (std::size_t block = 0; block < sums_.size(); ++block) {
    if (!known_[block])
      continue;
    if (block == 0 || !known_[block - 1])
      runs.push_back({block, {}});
    runs.back().sums.push_back(sums_[block]);
  }
  return runs;
}

bool FileChecksum::add(const BlockSums& sums) {
  if (sums.first > sums_.size() || sums.sums.size() > sums_.size() - sums.first)
    return false;
  for (std::size_t i = 0; i < sums.sums.size(); ++i) {
    sums_[sums.first + i] = sums.sums[i];
    known_[sums.first + i] = true;
  }
  return true;
}

std::uint64_t FileChecksum::missing() const {
  return static_cast<std::uint64_t>(
      std::count_if(known_.begin(), known_.end(), [](const auto& known) { return !known; }));
}

std::uint64_t FileChecksum::complete(const File& file, const std::function<void()>& check) {
  std::vector<std::byte> bytes;
  for (std::size_t block = 0; block < sums_.size(); ++block) {
    if (known_[block])
      continue;
    check();
    bytes.resize(block_bytes(block));
    file.read_exact(std::uint64_t{block} * kBlockBytes, bytes);
    add(std::uint64_t{block} * kBlockBytes, bytes);
  }
  Checksum sum;
  for (const std::uint64_t block : sums_)
    sum.add(little_endian(block));
  return sum.value();
}

}  // namespace meshhier::storage
