#include "mesh_io/gltf_buffer_files.h"

#include "mesh_io/gltf_uri.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/json_characters.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kMostBufferFiles = 65536;
/// Takes buffers[...].uri.
class BufferUris final : public storage::JsonVisitor {
 public:
  std::vector<std::string> uris;

  bool string(string_t& value) override {
    if (depth() == 3 && in_buffers_ && is_uri_ && uris.size() <= kMostBufferFiles)
      uris.push_back(value);
    return true;
  }
  bool key(string_t& value) override {
    if (depth() == 1)
      in_buffers_ = value == "buffers";
    is_uri_ = value == "uri";
    return true;
  }

 private:
  bool in_buffers_ = false, is_uri_ = false;
};

}  // namespace

std::vector<std::filesystem::path> gltf_buffer_files(const storage::File& file) {
  const auto stream = open_stream({file, file.size()}, {});
  JsonCharacters characters(*stream);
  BufferUris found;
  storage::visit_json([&] { return characters.next(); }, found);
  if (found.uris.size() > kMostBufferFiles)
    fail_file(file.path(), fmt::format("has more than {} buffers in files", kMostBufferFiles));
  std::vector<std::filesystem::path> paths;
  for (const std::string& uri : found.uris) {
    const auto path = base64_of(uri) ? std::nullopt : file_of_uri(uri, file.path().parent_path());
    if (path && std::ranges::find(paths, *path) == paths.end())
      paths.push_back(*path);
  }
  return paths;
}

}  // namespace meshhier::mesh_io
