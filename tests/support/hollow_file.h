// A file of any size in memory, of which only what is not zero is kept: for offsets beyond 4 GiB.
#pragma once

#include "storage/io/file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>

namespace meshhier::tests {

class HollowFile final : public storage::File {
 public:
  explicit HollowFile(std::uint64_t size = 0) : File("hollow"), size_(size) {}

  std::uint64_t size() const override { return size_; }
  void sync() override {}
  using File::sync;

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= size_)
      return 0;
    const std::size_t count = part(offset, std::min<std::uint64_t>(bytes.size(), size_ - offset));
    const auto page = pages_.find(offset / kPage);
    if (page == pages_.end())
      std::memset(bytes.data(), 0, count);
    else
      std::copy_n(page->second.begin() + offset % kPage, count, bytes.begin());
    return count;
  }
  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
    const std::size_t count = part(offset, bytes.size());
    static constexpr std::array<std::byte, kPage> kZeros{};
    if (std::memcmp(bytes.data(), kZeros.data(), count) != 0 || pages_.contains(offset / kPage))
      std::copy_n(bytes.begin(), count, pages_[offset / kPage].begin() + offset % kPage);
    size_ = std::max(size_, offset + count);
    return count;
  }

 private:
  static constexpr std::size_t kPage = 65536;
  static std::size_t part(std::uint64_t offset, std::uint64_t bytes) {
    return std::min<std::uint64_t>(bytes, kPage - offset % kPage);
  }

  std::uint64_t size_;
  std::map<std::uint64_t, std::array<std::byte, kPage>> pages_;
};

}  // namespace meshhier::tests
