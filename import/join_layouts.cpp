#include "import/join_layouts.h"

#include "hierarchy/attribute_names.h"
#include "import/material_colours.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
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

/// But for texture coordinates and colours of materials: what all files must have.
AttributeLayout kept_layout(const JoinedFile& file) {
  AttributeLayout layout = file.layout.without_texcoords();
  if (file.is_painted)
    layout.colour = ColourType::none;
  return layout;
}

/// Materials without pictures, one for each colour.
class PlainMaterials {
 public:
  explicit PlainMaterials(MaterialTable& table) : table_(table) {}

  float number(PlainColour colour) {
    const auto [known, is_new] = numbers_.emplace(colour, 0);
    if (is_new) {
      images::Material material;
      for (std::size_t c = 0; c < colour.channels.size(); ++c)
        material.colour[c] = static_cast<float>(colour.channels[c]) / 255;
      known->second = table_.add(std::move(material));
    }
    return static_cast<float>(known->second);
  }

 private:
  MaterialTable& table_;
  std::map<PlainColour, std::uint32_t> numbers_;
};

/// Calls `append` for each vertex of a file, from `channel` on, with its channels.
template <class Append>
void for_each_row(const JoinedFile& file, const storage::RecordSpool<float>& from,
                  std::uint64_t channel, const ImportRoom& room, const Append& append) {
  const auto channels = static_cast<std::size_t>(file.layout.channels());
  std::vector<float> block;
  for (std::uint64_t first = 0; first < file.vertices; first += kBlockVertices) {
    room.cancel.check();
    const std::uint64_t count = std::min(kBlockVertices, file.vertices - first);
    block.resize(count * channels);
    from.read(channel + first * channels, block);
    for (std::uint64_t i = 0; i < count; ++i)
      append(std::span<const float>(block).subspan(i * channels, channels));
  }
}

PlainColour colour_of(const JoinedFile& file, std::span<const float> row) {
  PlainColour colour;
  if (file.is_painted) {
    const auto values = row.subspan(static_cast<std::size_t>(file.layout.colour_offset()));
    for (std::size_t c = 0; c < colour.channels.size(); ++c)
      colour.channels[c] = static_cast<std::uint8_t>(values[c]);
  }
  return colour;
}

/// Appends the vertices of an untextured file as a textured mesh has them.
void append_textured(const JoinedFile& file, const storage::RecordSpool<float>& from,
                     std::uint64_t channel, PlainMaterials& plain, storage::RecordSpool<float>& to,
                     const ImportRoom& room) {
  const auto kept = static_cast<std::size_t>(kept_layout(file).channels());
  for_each_row(file, from, channel, room, [&](std::span<const float> row) {
    to.append(row.first(kept));
    to.append(std::array{0.0F, 0.0F, plain.number(colour_of(file, row))});
  });
}

/// Appends the vertices of a file without colours as white ones.
void append_white(const JoinedFile& file, const storage::RecordSpool<float>& from,
                  std::uint64_t channel, storage::RecordSpool<float>& to, const ImportRoom& room) {
  const auto before = static_cast<std::size_t>(file.layout.colour_offset());
  for_each_row(file, from, channel, room, [&](std::span<const float> row) {
    to.append(row.first(before));
    to.append(PlainColour().values());
    to.append(row.subspan(before));
  });
}

/// So many channels from `first` on.
void copy(const storage::RecordSpool<float>& from, std::uint64_t first, std::uint64_t count,
          storage::RecordSpool<float>& to, const ImportRoom& room) {
  std::vector<float> block;
  for (std::uint64_t i = 0; i < count; i += block.size()) {
    room.cancel.check();
    block.resize(std::min<std::uint64_t>(kBlockVertices * kMaxChannels, count - i));
    from.read(first + i, block);
    to.append(block);
  }
}

}  // namespace

void require_joinable(std::span<const JoinedFile> files) {
  if (kept_layout(files.back()) != kept_layout(files[0]))
    fail(files[0], files.back());
}

std::uint64_t join_layouts(std::span<const JoinedFile> files, RawMesh& mesh,
                           const ImportRoom& room) {
  const auto is_textured = [](const JoinedFile& file) { return file.layout.material; };
  mesh.layout = files.empty() ? AttributeLayout() : files[0].layout;
  if (std::ranges::all_of(files,
                          [&](const JoinedFile& file) { return file.layout == files[0].layout; }))
    return 0;
  const auto textured = static_cast<std::uint64_t>(std::ranges::count_if(files, is_textured));
  if (textured > 0) {
    mesh.layout = std::ranges::find_if(files, is_textured)->layout;
  } else {
    const auto other = std::ranges::find_if(files, [&](const JoinedFile& file) {
      return file.layout.texcoords != files[0].layout.texcoords;
    });
    if (other != files.end())
      fail(files[0], *other);
    mesh.layout = std::ranges::find_if(files, &JoinedFile::is_painted)->layout;
  }
  PlainMaterials plain(mesh.materials);
  storage::RecordSpool<float> joined(room.scratch, kImportSpoolBytes);
  std::uint64_t channel = 0;
  for (const JoinedFile& file : files) {
    const std::uint64_t count = file.vertices * static_cast<std::uint64_t>(file.layout.channels());
    if (file.layout == mesh.layout)
      copy(mesh.attributes, channel, count, joined, room);
    else if (textured > 0)
      append_textured(file, mesh.attributes, channel, plain, joined, room);
    else
      append_white(file, mesh.attributes, channel, joined, room);
    channel += count;
  }
  mesh.attributes.clear();
  copy(joined, 0, joined.size(), mesh.attributes, room);
  return textured > 0 ? files.size() - textured : 0;
}

}  // namespace meshhier::importing
