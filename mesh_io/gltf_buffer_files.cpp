#include "mesh_io/gltf_buffer_files.h"

#include "mesh_io/gltf_uri.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kMostBufferFiles = 65536;
/// No path is longer; what is cut from a text is base64.
constexpr std::size_t kMostTextBytes = 8192;
/// No number is longer; a list of them without end would be one token.
constexpr std::size_t kMostNumberBytes = 1024;

/// The JSON of a glTF file, character by character: texts cut to kMostTextBytes.
class JsonCharacters {
 public:
  explicit JsonCharacters(InputStream& stream) : stream_(stream) {
    std::array<std::byte, kGlbJsonOffset> head{};
    const std::size_t got = stream_.read(head);
    if (got == head.size() &&
        std::string_view(reinterpret_cast<const char*>(head.data()), 4) == "glTF") {
      left_ = storage::load_little<std::uint32_t>(head.data() + 12);
    } else {
      block_.assign(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(got));
    }
  }

  /// -1 at the end.
  int next() {
    for (;;) {
      const int c = next_stored();
      if (!in_text_) {
        in_text_ = c == '"';
        token_ = is_number_part(c) ? token_ + 1 : 0;
        return token_ > kMostNumberBytes ? -1 : c;
      }
      if (c < 0 || (c == '"' && !escaped_)) {
        in_text_ = false;
        token_ = 0;
        return c;
      }
      // An escape is kept or cut as a whole; the longest has six characters.
      const bool is_kept = escaped_ ? kept_ : token_ + (c == '\\' ? 6 : 0) < kMostTextBytes;
      kept_ = is_kept;
      escaped_ = !escaped_ && c == '\\';
      ++token_;
      if (is_kept)
        return c;
    }
  }

 private:
  static constexpr std::size_t kGlbJsonOffset = 20;
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

  static bool is_number_part(int c) {
    return c > ' ' && c != ',' && c != ':' && c != '[' && c != ']';
  }

  int next_stored() {
    if (at_ == block_.size() && !load())
      return -1;
    return std::to_integer<int>(block_[at_++]);
  }
  bool load() {
    block_.resize(std::min<std::uint64_t>(kBlockBytes, left_));
    block_.resize(stream_.read(block_));
    left_ -= block_.size();
    at_ = 0;
    return !block_.empty();
  }

  InputStream& stream_;
  std::uint64_t left_ = UINT64_MAX;  ///< of the JSON chunk of a GLB
  std::vector<std::byte> block_;
  std::size_t at_ = 0;
  bool in_text_ = false, escaped_ = false, kept_ = false;
  std::size_t token_ = 0;
};

/// As an iterator, for the parser.
class JsonIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  JsonIterator() = default;
  explicit JsonIterator(JsonCharacters& characters) : characters_(&characters) { ++*this; }
  const char& operator*() const { return c_; }
  JsonIterator& operator++() {
    const int c = characters_->next();
    c_ = static_cast<char>(c);
    if (c < 0)
      characters_ = nullptr;
    return *this;
  }
  JsonIterator operator++(int) {
    const JsonIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const JsonIterator& a, const JsonIterator& b) {
    return a.characters_ == b.characters_;
  }

 private:
  JsonCharacters* characters_ = nullptr;
  char c_ = 0;
};

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
