#include "support/memory_files.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>

namespace meshhier::tests {
namespace {

class MemoryFile final : public storage::File {
 public:
  MemoryFile(const std::filesystem::path& path, std::shared_ptr<std::string> content)
      : File(path), content_(std::move(content)) {}

  std::uint64_t size() const override { return content_->size(); }
  void sync() override {}

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= content_->size())
      return 0;
    const std::size_t count = std::min<std::uint64_t>(bytes.size(), content_->size() - offset);
    std::memcpy(bytes.data(), content_->data() + offset, count);
    return count;
  }
  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
    if (content_->size() < offset + bytes.size())
      content_->resize(offset + bytes.size());
    std::memcpy(content_->data() + offset, bytes.data(), bytes.size());
    return bytes.size();
  }

 private:
  std::shared_ptr<std::string> content_;
};

}  // namespace

std::unique_ptr<storage::File> MemoryFiles::open(const std::filesystem::path& path) {
  const auto found = contents_.find(path.string());
  if (found == contents_.end())
    throw Error(ErrorCode::io, "no such file: " + path.string());
  return std::make_unique<MemoryFile>(path, found->second);
}

std::unique_ptr<storage::File> MemoryFiles::create(const std::filesystem::path& path) {
  put(path.string(), {});
  return open(path);
}

std::unique_ptr<storage::File> MemoryFiles::reopen(const std::filesystem::path& path) {
  return open(path);
}

storage::FileIdentity MemoryFiles::identity(const std::filesystem::path& path) {
  return {open(path)->size(), 0};
}

bool MemoryFiles::exists(const std::filesystem::path& path) {
  return contents_.contains(path.string());
}

void MemoryFiles::remove_all(const std::filesystem::path& path) {
  contents_.erase(path.string());
}

void MemoryFiles::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  contents_[to.string()] = contents_.at(from.string());
  contents_.erase(from.string());
}

void MemoryFiles::put(const std::string& name, std::string content) {
  contents_[name] = std::make_shared<std::string>(std::move(content));
}

}  // namespace meshhier::tests
