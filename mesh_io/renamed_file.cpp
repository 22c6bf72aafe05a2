#include "mesh_io/renamed_file.h"

#include <utility>

namespace meshhier::mesh_io {
namespace {

class RenamedFile final : public storage::ReadOnlyFile {
 public:
  RenamedFile(std::unique_ptr<storage::File> file, std::filesystem::path name)
      : ReadOnlyFile(std::move(name)), file_(std::move(file)) {}

  std::uint64_t size() const override { return file_->size(); }
  storage::FileVersion version() const override { return file_->version(); }

 protected:
  std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const override {
    return file_->read_at(offset, bytes);
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
