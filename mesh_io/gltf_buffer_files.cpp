#include "mesh_io/gltf_buffer_files.h"

#include "mesh_io/gltf_uri.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/json_characters.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kMostBufferFiles = 65536;
/// Takes buffers[...].uri.
class BufferUris final : public nlohmann::json_sax<nlohmann::json> {
 public:
  std::vector<std::string> uris;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool string(string_t& value) override {
    if (depth_ == 3 && in_buffers_ && is_uri_ && uris.size() <= kMostBufferFiles)
      uris.push_back(value);
    return true;
  }
  bool start_object(std::size_t) override { return begin(); }
  bool end_object() override { return end(); }
  bool start_array(std::size_t) override { return begin(); }
  bool end_array() override { return end(); }
  bool key(string_t& value) override {
    if (depth_ == 1)
      in_buffers_ = value == "buffers";
    is_uri_ = value == "uri";
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override {
    return false;
  }

 private:
  static constexpr std::size_t kMostDepth = 1000;

  bool begin() { return ++depth_ <= kMostDepth; }
  bool end() {
    --depth_;
    return true;
  }

  std::size_t depth_ = 0;
  bool in_buffers_ = false, is_uri_ = false;
};

}  // namespace

std::vector<std::filesystem::path> gltf_buffer_files(const storage::File& file) {
  const auto stream = open_stream({file, file.size()}, {});
  JsonCharacters characters(*stream);
  BufferUris found;
  nlohmann::json::sax_parse(JsonIterator(characters), JsonIterator(), &found);
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
