#include "mesh_io/renamed_file.h"

#include "base/error.h"

#include <utility>

namespace meshhier::mesh_io {
namespace {

class RenamedFile final : public storage::File {
 public:
  RenamedFile(std::unique_ptr<storage::File> file, std::filesystem::path name)
      : File(std::move(name)), file_(std::move(file)) {}

  std::uint64_t size() const override { return file_->size(); }
  storage::FileVersion version() const override { return file_->version(); }
  void sync() override { file_->sync(); }

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    return file_->read_at(offset, bytes);
  }
  std::size_t write_some(std::uint64_t /*offset*/, std::span<const std::byte> /*bytes*/) override {
    throw Error(ErrorCode::internal, path().string() + " is to be read only");
  }

 private:
  std::unique_ptr<storage::File> file_;
};

}  // namespace

std::unique_ptr<storage::File> renamed(std::unique_ptr<storage::File> file,
                                       std::filesystem::path name) {
  return std::make_unique<RenamedFile>(std::move(file), std::move(name));
}

}  // namespace meshhier::mesh_io
