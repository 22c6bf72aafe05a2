#include "storage/format/layout.h"

#include <algorithm>
#include <charconv>
#include <system_error>

#include <fmt/format.h>

namespace meshhier::storage {

namespace {

constexpr std::string_view kMark = ".meshhier-";
constexpr std::size_t kMostDigits = 10;    // an index is below 2^32
constexpr std::uint32_t kMostLevel = 255;  // a Level has no more; trees have 33
constexpr std::string_view kVerify = "verify-";
constexpr std::string_view kStoryEnding = ".story.json";

/// Takes `least` digits or more off the front; returns false if there are not so many, or if there
/// are more and the first is 0.
bool take_digits(std::string_view& text, std::size_t least) {
  std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
  const bool is_padded = count > least && text.front() == '0';
  const bool is_there = count >= least && count <= kMostDigits && !is_padded;
  text.remove_prefix(count);
  return is_there;
}

bool take(std::string_view& text, std::string_view start) {
  const bool is_there = text.starts_with(start);
  text.remove_prefix(is_there ? start.size() : 0);
  return is_there;
}

/// Whether it is "tilesets/LL/NNNNNN.json".
bool is_tileset_file(std::string_view name) {
  return take(name, "tilesets/") && take_digits(name, 2) && take(name, "/") &&
         take_digits(name, 6) && name == ".json";
}

/// Takes the number that `text` begins with.
std::optional<std::uint32_t> take_number(std::string_view& text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{})
    return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

/// Returns the directory for tiles from `first` on.
std::filesystem::path tile_directory(const std::filesystem::path& hierarchy, Level level,
                                     std::uint32_t first) {
  const std::filesystem::path directory = level_directory(hierarchy, level);
  return first == 0 ? directory : directory / fmt::format("{:06}", first);
}

}  // namespace

std::filesystem::path manifest_path(const std::filesystem::path& hierarchy) {
  return hierarchy / "hierarchy.json";
}
std::filesystem::path index_path(const std::filesystem::path& hierarchy) {
  return hierarchy / "tiles.bin";
}
std::filesystem::path outline_path(const std::filesystem::path& hierarchy) {
  return hierarchy / "outline.glb";
}

std::filesystem::path preview_path(const std::filesystem::path& hierarchy) {
  return hierarchy / "preview.webp";
}

std::filesystem::path objects_path(const std::filesystem::path& hierarchy) {
  return hierarchy / "objects.bin";
}

std::filesystem::path object_words_path(const std::filesystem::path& hierarchy) {
  return hierarchy / "object_words.bin";
}

std::filesystem::path tileset_path(const std::filesystem::path& hierarchy) {
  return hierarchy / "tileset.json";
}

std::filesystem::path tileset_path(const std::filesystem::path& hierarchy, NodeId node) {
  return hierarchy / "tilesets" / fmt::format("{:02}", raw(node.level)) /
         fmt::format("{:06}.json", node.index);
}

std::filesystem::path level_directory(const std::filesystem::path& hierarchy, Level level) {
  return hierarchy / "tiles" / fmt::format("{:02}", raw(level));
}

std::vector<std::filesystem::path> tile_directories(const std::filesystem::path& hierarchy,
                                                    Level level, std::uint32_t nodes) {
  std::vector<std::filesystem::path> directories{level_directory(hierarchy, level)};
  for (std::uint64_t first = kTilesADirectory; first < nodes; first += kTilesADirectory)
    directories.push_back(tile_directory(hierarchy, level, static_cast<std::uint32_t>(first)));
  return directories;
}

std::filesystem::path tile_path(const std::filesystem::path& hierarchy, NodeId node) {
  const std::uint32_t first = node.index / kTilesADirectory * kTilesADirectory;
  return tile_directory(hierarchy, node.level, first) / fmt::format("{:06}.glb", node.index);
}

std::filesystem::path progressive_index_path(const std::filesystem::path& stream) {
  return stream / "progressive.json";
}

std::filesystem::path detail_path(const std::filesystem::path& stream, std::uint32_t step) {
  return stream / (step == 0 ? std::string("base.bin") : fmt::format("detail_{:02}.bin", step));
}

std::optional<NodeId> tile_of(std::string_view name) {
  std::string_view rest = name;
  if (!take(rest, "tiles/"))
    return std::nullopt;
  const auto level = take_number(rest);
  rest.remove_prefix(std::min(rest.rfind('/'), rest.size()));
  if (!level || *level > kMostLevel || !take(rest, "/"))
    return std::nullopt;
  const auto index = take_number(rest);
  if (!index)
    return std::nullopt;
  const NodeId node{static_cast<Level>(*level), *index};
  return tile_path({}, node).generic_string() == name ? std::optional(node) : std::nullopt;
}

bool is_hierarchy_file(std::string_view name) {
  return name == manifest_path({}) || name == index_path({}) || name == outline_path({}) ||
         name == preview_path({}) || name == objects_path({}) || name == object_words_path({}) ||
         name == tileset_path({}) || is_tileset_file(name) || tile_of(name);
}

std::filesystem::path story_path(const std::filesystem::path& hierarchy) {
  return hierarchy.parent_path() / (hierarchy.filename().string() + std::string(kStoryEnding));
}

std::optional<std::string_view> told_of(std::string_view story) {
  if (!story.ends_with(kStoryEnding))
    return std::nullopt;
  story.remove_suffix(kStoryEnding.size());
  if (story.empty() || story.ends_with('/'))
    return std::nullopt;
  return story;
}

bool is_stream_file(std::string_view name) {
  if (name == progressive_index_path({}) || name == detail_path({}, 0))
    return true;
  return take(name, "detail_") && take_digits(name, 2) && name == ".bin";
}

std::filesystem::path work_path(const std::filesystem::path& output) {
  return output.parent_path() / fmt::format(".{}.meshhier-work", output.filename().string());
}

std::filesystem::path input_note_path(const std::filesystem::path& output) {
  return output.parent_path() / fmt::format(".{}.meshhier-input", output.filename().string());
}

std::filesystem::path replaced_path(const std::filesystem::path& output) {
  return output.parent_path() / fmt::format(".{}.meshhier-old", output.filename().string());
}

std::filesystem::path verify_scratch_path(const std::filesystem::path& hierarchy,
                                          std::uint32_t run) {
  return hierarchy.parent_path() /
         fmt::format(".{}.meshhier-verify-{:08x}", hierarchy.filename().string(), run);
}

std::filesystem::path lock_path(const std::filesystem::path& work) {
  return work / "lock";
}
std::filesystem::path journal_path(const std::filesystem::path& work) {
  return work / "journal";
}
std::filesystem::path set_aside_path(const std::filesystem::path& work, std::uint64_t checksum) {
  return work / fmt::format("journal.{:016x}", checksum);
}
std::filesystem::path built_path(const std::filesystem::path& work) {
  return work / "hierarchy";
}
std::filesystem::path packed_path(const std::filesystem::path& work) {
  return work / "archive";
}

std::filesystem::path imported_path(const std::filesystem::path& work) {
  return work / "import.ply";
}

std::filesystem::path imported_objects_path(const std::filesystem::path& work) {
  return work / "import.objects";
}

std::filesystem::path task_plan_path(const std::filesystem::path& work) {
  return work / "plan.json";
}

std::filesystem::path segments_path(const std::filesystem::path& work) {
  return work / "segments";
}

std::filesystem::path attempts_path(const std::filesystem::path& work) {
  return work / "attempts";
}

std::optional<LeftoverName> leftover_name(std::string_view name) {
  const std::size_t mark = name.rfind(kMark);
  if (!name.starts_with('.') || mark == std::string_view::npos || mark < 2)
    return std::nullopt;
  const std::string output(name.substr(1, mark - 1));
  const std::string_view kind = name.substr(mark + kMark.size());
  if (kind == "work")
    return LeftoverName{Leftover::build, output};
  if (kind == "old")
    return LeftoverName{Leftover::replaced, output};
  if (kind == "input")
    return LeftoverName{Leftover::input_note, output};
  if (kind == "part" || kind == "scratch" || kind == "lock")
    return LeftoverName{Leftover::unfinished, output};
  if (kind.size() == kVerify.size() + 8 && kind.starts_with(kVerify))
    return LeftoverName{Leftover::verify, output};
  return std::nullopt;
}

bool is_manifest_at_work(std::string_view name) {
  const auto known = leftover_name(name);
  return known && known->kind == Leftover::unfinished && known->output == manifest_path({});
}

}  // namespace meshhier::storage
