#include "import/join_layouts.h"

#include "hierarchy/attribute_names.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::uint64_t kBlockVertices = 4096;

[[noreturn]] void fail(const JoinedFile& first, const JoinedFile& other) {
  mesh_io::fail_file(other.path,
                     fmt::format("has attributes: {}; {} has: {}. Files that are joined must have "
                                 "the same",
                                 attribute_names(other.layout), first.path.string(),
                                 attribute_names(first.layout)));
}

/// Appends the vertices of a file from `channel` on, as a textured mesh has them.
void append_textured(const JoinedFile& file, const storage::RecordSpool<float>& from,
                     std::uint64_t channel, float plain, storage::RecordSpool<float>& to,
                     const ImportRoom& room) {
  const auto channels = static_cast<std::size_t>(file.layout.channels());
  const auto kept = static_cast<std::size_t>(file.layout.without_texcoords().channels());
  std::vector<float> block;
  for (std::uint64_t first = 0; first < file.vertices; first += kBlockVertices) {
    room.cancel.check();
    block.resize(std::min(kBlockVertices, file.vertices - first) * channels);
    from.read(channel + first * channels, block);
    if (file.layout.material) {
      to.append(block);
      continue;
    }
    const std::uint64_t count = std::min(kBlockVertices, file.vertices - first);
    for (std::uint64_t i = 0; i < count; ++i) {
      to.append(std::span(block).subspan(i * channels, kept));
      to.append(std::array{0.0F, 0.0F, plain});
    }
  }
}

void copy(const storage::RecordSpool<float>& from, storage::RecordSpool<float>& to,
          const ImportRoom& room) {
  std::vector<float> block;
  for (std::uint64_t i = 0; i < from.size(); i += block.size()) {
    room.cancel.check();
    block.resize(std::min<std::uint64_t>(kBlockVertices * kMaxChannels, from.size() - i));
    from.read(i, block);
    to.append(block);
  }
}

}  // namespace

void require_joinable(std::span<const JoinedFile> files) {
  const JoinedFile& last = files.back();
  if (last.layout.without_texcoords() != files[0].layout.without_texcoords())
    fail(files[0], last);
}

std::uint64_t join_layouts(std::span<const JoinedFile> files, RawMesh& mesh,
                           const ImportRoom& room) {
  const auto is_textured = [](const JoinedFile& file) { return file.layout.material; };
  const auto other = std::ranges::find_if(
      files, [&](const JoinedFile& file) { return file.layout != files[0].layout; });
  mesh.layout = files.empty() ? AttributeLayout() : files[0].layout;
  if (other == files.end())
    return 0;
  if (std::ranges::none_of(files, is_textured))
    fail(files[0], *other);
  mesh.layout = std::ranges::find_if(files, is_textured)->layout;
  const auto plain = static_cast<float>(mesh.materials.add({}));
  storage::RecordSpool<float> joined(room.scratch, kImportSpoolBytes);
  std::uint64_t channel = 0;
  for (const JoinedFile& file : files) {
    append_textured(file, mesh.attributes, channel, plain, joined, room);
    channel += file.vertices * static_cast<std::uint64_t>(file.layout.channels());
  }
  mesh.attributes.clear();
  copy(joined, mesh.attributes, room);
  return static_cast<std::uint64_t>(files.size()) -
         static_cast<std::uint64_t>(std::ranges::count_if(files, is_textured));
}

}  // namespace meshhier::importing
