#include "mesh_io/gltf_outline.h"

#include "mesh_io/gltf_uri.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/json_characters.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kMostBufferFiles = 65536;
/// Takes buffers[...].uri and extensions.EXT_structural_metadata.schemaUri, and looks for a name
/// among the extensions.
class OutlineVisitor final : public storage::JsonVisitor {
 public:
  std::vector<std::string> uris;
  bool names_ktx2 = false;

  bool string(string_t& value) override {
    const bool is_file = (in_buffers_ && is_uri_) || (has_extensions_ && is_schema_);
    if (depth() == 3 && is_file && uris.size() <= kMostBufferFiles)
      uris.push_back(value);
    if (depth() == 2 && in_extensions_ && value == "KHR_texture_basisu")
      names_ktx2 = true;
    return true;
  }
  bool key(string_t& value) override {
    if (depth() == 1) {
      in_buffers_ = value == "buffers";
      in_extensions_ = value == "extensionsUsed" || value == "extensionsRequired";
      has_extensions_ = value == "extensions";
    }
    is_uri_ = value == "uri";
    is_schema_ = value == "schemaUri";
    return true;
  }

 private:
  bool in_buffers_ = false, in_extensions_ = false, is_uri_ = false;
  bool has_extensions_ = false, is_schema_ = false;
};

/// A file that is not packed, of which no more is read than is asked for.
class AskedStream final : public InputStream {
 public:
  explicit AskedStream(const storage::File& file) : file_(file) {}
  std::size_t read(std::span<std::byte> to) override {
    const std::size_t count = file_.read_at(at_, to);
    at_ += count;
    return count;
  }

 private:
  const storage::File& file_;
  std::uint64_t at_ = 0;
};

std::unique_ptr<InputStream> open_json(const storage::File& file) {
  if (is_gzip(file))
    return open_stream({file, file.size()}, {});
  return std::make_unique<AskedStream>(file);
}

}  // namespace

MeshOutline outline_of_gltf(const storage::File& file) {
  const auto stream = open_json(file);
  JsonCharacters characters(*stream);
  OutlineVisitor found;
  storage::visit_json([&] { return characters.next(); }, found);
  if (found.uris.size() > kMostBufferFiles)
    fail_file(file.path(), fmt::format("has more than {} buffers in files", kMostBufferFiles));
  MeshOutline outline{.names_ktx2 = found.names_ktx2};
  std::vector<std::filesystem::path>& paths = outline.buffers;
  for (const std::string& uri : found.uris) {
    const auto path = base64_of(uri) ? std::nullopt : file_of_uri(uri, file.path().parent_path());
    if (path && std::ranges::find(paths, *path) == paths.end())
      paths.push_back(*path);
  }
  return outline;
}

}  // namespace meshhier::mesh_io
