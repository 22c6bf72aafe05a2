#include "storage/layout.h"

#include <fmt/format.h>

namespace meshhier::storage {

namespace {

constexpr std::string_view kMark = ".meshhier-";
constexpr std::string_view kVerify = "verify-";

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

std::filesystem::path tile_path(const std::filesystem::path& hierarchy, NodeId node) {
  return level_directory(hierarchy, node.level) / fmt::format("{:06}.glb", node.index);
}

std::filesystem::path progressive_index_path(const std::filesystem::path& stream) {
  return stream / "progressive.json";
}

std::filesystem::path detail_path(const std::filesystem::path& stream, std::uint32_t step) {
  return stream / (step == 0 ? std::string("base.bin") : fmt::format("detail_{:02}.bin", step));
}

std::filesystem::path work_path(const std::filesystem::path& output) {
  return output.parent_path() / fmt::format(".{}.meshhier-work", output.filename().string());
}

std::filesystem::path replaced_path(const std::filesystem::path& output) {
  return output.parent_path() / fmt::format(".{}.meshhier-old", output.filename().string());
}

std::filesystem::path verify_scratch_path(const std::filesystem::path& hierarchy,
                                          std::uint32_t run) {
  return hierarchy.parent_path() /
         fmt::format(".{}.meshhier-verify-{:08x}", hierarchy.filename().string(), run);
}

std::filesystem::path unfinished_path(const std::filesystem::path& file) {
  return file.parent_path() / fmt::format(".{}.meshhier-part", file.filename().string());
}

std::filesystem::path lock_path(const std::filesystem::path& work) {
  return work / "lock";
}
std::filesystem::path journal_path(const std::filesystem::path& work) {
  return work / "journal";
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
  if (kind == "part")
    return LeftoverName{Leftover::unfinished, output};
  if (kind.size() == kVerify.size() + 8 && kind.starts_with(kVerify))
    return LeftoverName{Leftover::verify, output};
  return std::nullopt;
}

}  // namespace meshhier::storage
