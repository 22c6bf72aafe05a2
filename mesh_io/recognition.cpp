#include "mesh_io/recognition.h"

#include "base/small_letters.h"
#include "base/text_mark.h"
#include "mesh_io/coordinate_range.h"
#include "mesh_io/hgt_name.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/json_characters.h"
#include "mesh_io/other_formats.h"
#include "mesh_io/stl_reader.h"
#include "storage/io/json_text.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace meshhier::mesh_io {
namespace {

constexpr std::size_t kLookedAt = std::size_t{1} << 16;
/// A name in the header of a binary STL has at most 80 bytes; the counts and numbers behind it are
/// no text.
constexpr std::size_t kTextProof = 1024;

constexpr std::string_view kBlanks = " \t\v\f\r\n";

/// Returns whether numbers of the first facets are such as meshes have.
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

/// Returns whether a file is a binary STL although its header's count, by which it would have
/// `size` bytes, does not say so: bytes of another kind follow, fewer than the facets have, or the
/// count is 0.
bool is_stl_with_more(std::string_view start, std::uint64_t size, std::uint64_t file_bytes) {
  if (file_bytes <= size || !has_facets(start))
    return false;
  const std::uint64_t more = file_bytes - size;
  return size == kStlHeaderBytes ? more % kStlFacetBytes == 0 : more < size;
}

bool is_ply(std::string_view start) {
  return start.starts_with("ply") && start.size() > 3 && kBlanks.find(start[3]) != kBlanks.npos;
}

/// Returns the text behind the mark of UTF-8 and blanks.
std::string_view behind_blanks(std::string_view start) {
  start = without_mark(start);
  start.remove_prefix(std::min(start.find_first_not_of(kBlanks), start.size()));
  return start;
}

/// A PLY that does not begin at once, or in capitals: a line of the word alone.
bool is_odd_ply(std::string_view start) {
  start = behind_blanks(start);
  const std::size_t end = start.find_first_of("\r\n");
  const std::string_view line = start.substr(0, end);
  return end != std::string_view::npos &&
         small_letters(line.substr(0, line.find_last_not_of(kBlanks) + 1)) == "ply";
}

/// Returns a text without the zeros that fill it up.
std::string_view without_padding(std::string_view start) {
  const std::string_view text = start.substr(0, start.find_last_not_of('\0') + 1);
  const bool has_lines = text.find_first_of("\r\n") != std::string_view::npos;
  return has_lines ? text : start;
}

/// Looks at the keys of an object of JSON until they tell a glTF from a tileset.
class JsonKeys final : public storage::JsonVisitor {
 public:
  /// Returns the kind by the keys so far; the object may have ended, or broken off at a defect.
  std::optional<MeshKind> kind() const {
    if (has_meshes_)
      return MeshKind::gltf;
    if (has_error_ || (has_root_ && has_asset_))
      return MeshKind::tileset;
    return begins_as_gltf_ ? std::optional(MeshKind::gltf) : std::nullopt;
  }

  bool key(string_t& value) override {
    if (depth() == 1)
      look_at(value);
    return !has_meshes_ && !(has_root_ && has_asset_);
  }

 private:
  static constexpr auto kOfMeshes = std::to_array<std::string_view>(
      {"accessors", "animations", "bufferViews", "buffers", "cameras", "images", "materials",
       "meshes", "nodes", "samplers", "scene", "scenes", "skins", "textures"});
  static constexpr auto kBesideThem = std::to_array<std::string_view>(
      {"asset", "extensions", "extensionsRequired", "extensionsUsed", "extras"});

  void look_at(std::string_view key) {
    has_meshes_ = std::ranges::find(kOfMeshes, key) != kOfMeshes.end();
    has_root_ = has_root_ || key == "root";
    has_asset_ = has_asset_ || key == "asset";
    has_error_ = has_error_ || key == "geometricError";
    if (is_first_)
      begins_as_gltf_ = std::ranges::find(kBesideThem, key) != kBesideThem.end();
    is_first_ = false;
  }
  bool is_first_ = true, begins_as_gltf_ = false;
  bool has_meshes_ = false;  ///< or what belongs to them, which nothing but a glTF has
  bool has_root_ = false, has_asset_ = false;
  bool has_error_ = false;  ///< a geometric one, which nothing but a tileset has
};

/// The first four bytes tell a PLY; else all that is looked at.
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

}  // namespace

MeshContent::MeshContent(const storage::File& file)
    : file_(file), is_gzip_(mesh_io::is_gzip(file)), start_(start_of(file)) {}

std::string_view MeshContent::first_word() const {
  std::string_view text = without_mark(start_);
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

bool MeshContent::is_text() const {
  return std::ranges::all_of(without_padding(start_).substr(0, kTextProof), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= ' ' || kBlanks.find(c) != std::string_view::npos;
  });
}

bool MeshContent::begins_as_object() const {
  return behind_blanks(start_).starts_with('{');
}

std::optional<MeshKind> MeshContent::kind_of_json() {
  if (!kind_of_json_)
    kind_of_json_ = begins_as_object() ? look_into_json() : std::nullopt;
  return *kind_of_json_;
}

std::optional<MeshKind> MeshContent::look_into_json() const {
  const auto stream = open_stream({file_, file_.size()}, {});
  JsonCharacters characters(*stream);
  JsonKeys keys;
  storage::visit_json([&] { return characters.next(); }, keys);
  return keys.kind();
}

std::optional<std::uint64_t> MeshContent::stl_bytes() const {
  if (start_.size() < kStlHeaderBytes)
    return std::nullopt;
  const auto count = storage::load_little<std::uint32_t>(std::as_bytes(std::span(start_)).data() +
                                                         kStlHeaderBytes - sizeof(std::uint32_t));
  return kStlHeaderBytes + std::uint64_t{count} * kStlFacetBytes;
}

bool begins_as_ply(std::string_view start) {
  return is_ply(start) || is_odd_ply(start);
}

bool is_packed_hgt(const MeshContent& content) {
  return content.is_gzip() && is_packed_hgt_name(content.file().path().filename().string());
}

Certainty look_for_binary_stl(MeshContent& content) {
  const auto bytes = content.stl_bytes();
  if (!bytes)
    return Certainty::none;
  const std::uint64_t file_bytes = content.file().size();
  if (!content.is_gzip() && *bytes == file_bytes)
    return Certainty::sure;
  if (content.is_text() || content.begins_as_object())
    return Certainty::none;
  const std::string_view start = content.start();
  const bool is_likely = other_format(start).empty() && !is_packed_hgt(content) &&
                         (content.is_gzip() || is_stl_with_more(start, *bytes, file_bytes));
  return is_likely ? Certainty::likely : Certainty::none;
}

}  // namespace meshhier::mesh_io
