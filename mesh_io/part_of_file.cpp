#include "mesh_io/part_of_file.h"

#include "hierarchy/error.h"

#include <algorithm>
#include <span>
#include <utility>

namespace meshhier::mesh_io {
namespace {

class PartOfFile final : public storage::File {
 public:
  PartOfFile(std::shared_ptr<const storage::File> file, std::uint64_t offset, std::uint64_t bytes)
      : File(file->path()), file_(std::move(file)), offset_(offset), bytes_(bytes) {}

  std::uint64_t size() const override { return bytes_; }
  void sync() override {}

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    if (offset >= bytes_)
      return 0;
    const std::uint64_t most = std::min<std::uint64_t>(bytes.size(), bytes_ - offset);
    return file_->read_at(offset_ + offset, bytes.first(static_cast<std::size_t>(most)));
  }
  std::size_t write_some(std::uint64_t /*offset*/, std::span<const std::byte> /*bytes*/) override {
    throw Error(ErrorCode::internal, path().string() + " is to be read only");
  }

 private:
  std::shared_ptr<const storage::File> file_;
  std::uint64_t offset_;
  std::uint64_t bytes_;
};

}  // namespace

std::unique_ptr<storage::File> part_of(std::shared_ptr<const storage::File> file,
                                       std::uint64_t offset, std::uint64_t bytes) {
  return std::make_unique<PartOfFile>(std::move(file), offset, bytes);
}

}  // namespace meshhier::mesh_io
