#include "mesh_io/mesh_format.h"

#include "hierarchy/small_letters.h"
#include "hierarchy/text_mark.h"
#include "mesh_io/coordinate_range.h"
#include "mesh_io/foreign_format.h"
#include "mesh_io/input_error.h"
#include "mesh_io/json_characters.h"
#include "mesh_io/obj_reader.h"
#include "mesh_io/off_reader.h"
#include "mesh_io/stl_reader.h"
#include "mesh_io/text_chars.h"
#include "storage/io/json_text.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// Comments may come before the first word of an OBJ or OFF file: some have licences there.
constexpr std::size_t kLookedAt = std::size_t{1} << 16;
/// A name in the header of a binary STL has at most 80 bytes; the counts and numbers behind it are
/// no text.
constexpr std::size_t kTextProof = 1024;

constexpr std::string_view kBlanks = " \t\v\f\r\n";

/// The first word that is in no comment.
std::string_view first_word(std::string_view text) {
  text = without_mark(text);
  for (;;) {
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos)
      return {};
    text.remove_prefix(begin);
    if (text[0] != '#')
      return text.substr(0, text.find_first_of(kBlanks));
    text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
  }
}

bool is_text(std::string_view start) {
  return std::ranges::all_of(start.substr(0, kTextProof), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= ' ' || kBlanks.find(c) != std::string_view::npos;
  });
}

/// The size that a binary STL of that start has.
std::optional<std::uint64_t> stl_size(std::string_view start) {
  if (start.size() < kStlHeaderBytes)
    return std::nullopt;
  std::uint32_t count = 0;
  for (std::size_t i = 4; i-- > 0;)
    count = count << 8 | static_cast<unsigned char>(start[kStlHeaderBytes - 4 + i]);
  return kStlHeaderBytes + std::uint64_t{count} * kStlFacetBytes;
}

/// Whether numbers of the first facets are such as meshes have.
bool has_facets(std::string_view start) {
  constexpr std::size_t kLooked = 16;
  constexpr std::size_t kNormalBytes = 12, kNumbers = 9;
  constexpr float kLeast = 1e-25F;
  for (std::size_t facet = 0; facet < kLooked; ++facet) {
    const std::size_t begin = kStlHeaderBytes + facet * kStlFacetBytes;
    if (begin + kStlFacetBytes > start.size())
      return facet > 0;
    for (std::size_t i = 0; i < kNumbers; ++i) {
      const auto number = storage::load_little<float>(std::as_bytes(std::span(start)).data() +
                                                      begin + kNormalBytes + i * sizeof(float));
      if (!is_coordinate(number) || (number != 0 && std::abs(number) < kLeast))
        return false;
    }
  }
  return true;
}

/// Whether a file is a binary STL although its header's count, by which it would have `size` bytes,
/// does not say so: bytes of another kind follow, fewer than the facets have, or the count is 0.
bool is_stl_with_more(std::string_view start, std::uint64_t size, std::uint64_t file_bytes) {
  if (file_bytes <= size || !has_facets(start))
    return false;
  const std::uint64_t more = file_bytes - size;
  return size == kStlHeaderBytes ? more % kStlFacetBytes == 0 : more < size;
}

bool is_ply(std::string_view start) {
  return start.starts_with("ply") && start.size() > 3 && kBlanks.find(start[3]) != kBlanks.npos;
}

/// A PLY that does not begin at once, or in capitals: a line of the word alone.
bool is_odd_ply(std::string_view start) {
  start = without_mark(start);
  start.remove_prefix(std::min(start.find_first_not_of(kBlanks), start.size()));
  const std::size_t end = start.find_first_of("\r\n");
  const std::string_view line = start.substr(0, end);
  return end != std::string_view::npos &&
         small_letters(line.substr(0, line.find_last_not_of(kBlanks) + 1)) == "ply";
}

/// Of a text what is before the zeros that fill it up.
std::string_view without_padding(std::string_view start) {
  const std::string_view text = start.substr(0, start.find_last_not_of('\0') + 1);
  const bool has_lines = text.find_first_of("\r\n") != std::string_view::npos;
  return has_lines ? text : start;
}

bool begins_as_object(std::string_view start) {
  start = without_mark(start);
  start.remove_prefix(std::min(start.find_first_not_of(kBlanks), start.size()));
  return start.starts_with('{');
}

/// Looks at the keys of an object of JSON until they tell a glTF from a tileset.
class JsonKeys final : public storage::JsonVisitor {
 public:
  /// Of one that was read to its end or to its first defect, too.
  std::optional<MeshKind> kind() const {
    if (is_gltf_)
      return MeshKind::gltf;
    const bool is_tileset = has_error_ || (has_root_ && has_asset_);
    return is_tileset ? std::optional(MeshKind::tileset) : std::nullopt;
  }

  bool key(string_t& value) override {
    if (depth() == 1)
      look_at(value);
    return !is_gltf_ && !(has_root_ && has_asset_);
  }

 private:
  void look_at(std::string_view key) {
    static constexpr std::array<std::string_view, 14> kGltf{
        "accessors", "animations", "bufferViews", "buffers", "cameras", "images", "materials",
        "meshes",    "nodes",      "samplers",    "scene",   "scenes",  "skins",  "textures"};
    is_gltf_ = std::ranges::find(kGltf, key) != kGltf.end();
    has_root_ = has_root_ || key == "root";
    has_asset_ = has_asset_ || key == "asset";
    has_error_ = has_error_ || key == "geometricError";
  }

  bool is_gltf_ = false, has_root_ = false, has_asset_ = false;
  bool has_error_ = false;  ///< a geometric one, which nothing but a tileset has
};

/// An object of JSON that begins as a glTF's.
bool begins_as_gltf(std::string_view start) {
  static constexpr std::array<std::string_view, 19> kKeys{
      "accessors",      "animations", "asset",      "bufferViews", "buffers",
      "cameras",        "extras",     "extensions", "images",      "extensionsRequired",
      "extensionsUsed", "materials",  "meshes",     "nodes",       "samplers",
      "scene",          "scenes",     "skins",      "textures"};
  const auto skip_blanks = [&] {
    start.remove_prefix(std::min(start.find_first_not_of(kBlanks), start.size()));
  };
  const auto take = [&](std::string_view word) {
    skip_blanks();
    const bool is_there = start.starts_with(word);
    start.remove_prefix(is_there ? word.size() : 0);
    return is_there;
  };
  take("\xef\xbb\xbf");
  if (!take("{") || !take("\""))
    return false;
  const std::string_view key = start.substr(0, start.find('"'));
  return std::ranges::find(kKeys, key) != kKeys.end();
}

/// Which of both an object of JSON is, wherever the keys stand that tell.
std::optional<MeshKind> json_kind(const storage::File& file, std::string_view start) {
  const auto stream = open_stream({file, file.size()}, {});
  JsonCharacters characters(*stream);
  JsonKeys keys;
  storage::visit_json([&] { return characters.next(); }, keys);
  if (const auto kind = keys.kind())
    return kind;
  return begins_as_gltf(start) ? std::optional(MeshKind::gltf) : std::nullopt;
}

std::optional<MeshKind> kind_of(const storage::File& file, std::string_view start, bool is_gzip) {
  const std::uint64_t file_bytes = file.size();
  if (is_ply(start) || is_odd_ply(start))
    return MeshKind::ply;
  const auto size = stl_size(start);
  if (!is_gzip && size == file_bytes)
    return MeshKind::stl_binary;
  const std::string_view word = first_word(start);
  if (start.starts_with("glTF"))
    return MeshKind::glb;
  if (begins_as_object(start))
    return json_kind(file, start);
  if (is_text(without_padding(start))) {
    if (is_stl_keyword(word, "solid"))
      return MeshKind::stl_text;
    if (is_off_keyword(word))
      return MeshKind::off;
    if (is_obj_statement(word))
      return MeshKind::obj;
    return std::nullopt;
  }
  if (is_off_keyword(word))
    return MeshKind::off;  // a binary one, which its reader refuses by name
  const bool is_stl =
      size &&
      (is_gzip || (is_stl_with_more(start, *size, file_bytes) && foreign_format(start).empty()));
  return is_stl ? std::optional(MeshKind::stl_binary) : std::nullopt;
}

/// What is looked at of the content; a PLY is known by its first bytes.
std::string start_of(const storage::File& file) {
  std::string start(4, '\0');
  start.resize(file.read_at(0, std::as_writable_bytes(std::span(start))));
  if (is_ply(start))
    return start;
  start.resize(kLookedAt);
  start.resize(
      open_stream({file, file.size()}, {})->read(std::as_writable_bytes(std::span(start))));
  return start;
}

std::optional<MeshFormat> format_of(const storage::File& file, std::string_view start) {
  const bool packed = is_gzip(file);
  const auto kind = kind_of(file, start, packed);
  return kind ? std::optional(MeshFormat{*kind, packed}) : std::nullopt;
}

}  // namespace

std::string name_of(const MeshFormat& format) {
  static constexpr const char* kNames[] = {"PLY",  "OBJ", "binary STL", "ASCII STL", "OFF",
                                           "glTF", "GLB", "3D Tiles",   "b3dm"};
  return std::string(kNames[static_cast<std::size_t>(format.kind)]) +
         (format.is_gzip ? " (gzip)" : "");
}

std::optional<MeshFormat> find_format(const storage::File& file) {
  return format_of(file, start_of(file));
}

MeshFormat detect_format(const storage::File& file) {
  const std::uint64_t bytes = file.size();
  const bool packed = is_gzip(file);
  const std::string start = start_of(file);
  if (const auto format = format_of(file, start))
    return *format;
  if (const std::string foreign = foreign_format(start); !foreign.empty()) {
    fail_file(file.path(),
              "expected a mesh (PLY, OBJ, glTF, STL, OFF or a tileset.json), found " + foreign);
  }
  std::string hint;
  if (const auto size = stl_size(start); size && !packed && !is_text(start)) {
    hint =
        fmt::format("; as a binary STL it would have {} bytes, it has {} ({})", *size, bytes,
                    bytes < *size ? "truncated?" : "its count of facets is wrong, or more follows");
  }
  fail_file(file.path(), fmt::format("expected a mesh (PLY, OBJ, glTF, STL or OFF, or one of "
                                     "them packed by gzip), found {}{}",
                                     start.empty() ? "an empty file" : in_quotes(start), hint));
}

}  // namespace meshhier::mesh_io
