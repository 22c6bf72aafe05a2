#include "import/join_layouts.h"

#include "base/srgb.h"
#include "hierarchy/value_channels.h"
#include "import/material_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

constexpr std::uint64_t kBlockVertices = 4096;

/// Returns the type of a file's own colours, other than those of materials.
ColourType own_colour(const JoinedFile& file) {
  return file.is_painted ? ColourType::none : file.layout.colour;
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

PlainColour paint_of(const JoinedFile& file, std::span<const float> row) {
  PlainColour colour;
  if (file.is_painted) {
    const auto values = row.subspan(file.layout.part(AttributeKind::colours).first);
    for (std::size_t c = 0; c < colour.channels.size(); ++c)
      colour.channels[c] = static_cast<std::uint8_t>(values[c]);
  }
  return colour;
}

/// The type that light has of colours of a screen.
ColourType type_of_light(ColourType type) {
  return type == ColourType::u8    ? ColourType::u16
         : type == ColourType::u16 ? ColourType::f32
                                   : type;
}

/// A colour's channel of one layout in the numbers of another one, whose type is not narrower.
float converted(float number, std::size_t channel, const AttributeLayout& from,
                const AttributeLayout& to) {
  constexpr std::size_t kAlpha = 3;
  const bool becomes_light = from.space != to.space && channel != kAlpha;
  if (from.colour == to.colour && !becomes_light)
    return number;
  if (!becomes_light && to.colour == ColourType::u16)
    return number * 257;
  const double part = double{number} / full_number(from.colour);
  const double full = double{full_number(to.colour)} * (becomes_light ? light_of(part) : part);
  return static_cast<float>(to.colour == ColourType::f32 ? full : std::round(full));
}

bool has_own_colours(const JoinedFile& file) {
  return own_colour(file) != ColourType::none;
}

/// Returns whether pictures stay as they are if colours of all files tint them.
bool may_tint(std::span<const JoinedFile> files) {
  return std::ranges::none_of(files, [](const JoinedFile& file) {
    return has_own_colours(file) && file.layout.material && !file.layout.tints;
  });
}

/// Returns none if the layout has not that value.
std::optional<PlacedValue> place_of(const ScalarAttribute& value, const AttributeLayout& layout) {
  const auto found = std::ranges::find(layout.values, value);
  if (found == layout.values.end())
    return std::nullopt;
  return placed_values(layout)[static_cast<std::size_t>(found - layout.values.begin())];
}

AttributeLayout joined_layout(std::span<const JoinedFile> files) {
  AttributeLayout joined;
  for (const AttributeKindRow& row : kAttributeKinds) {
    const auto has_it = [&](const JoinedFile& file) { return file.layout.*row.flag; };
    if (row.flag != nullptr)
      joined.*row.flag = row.kind == AttributeKind::material ? std::ranges::any_of(files, has_it)
                                                             : std::ranges::all_of(files, has_it);
  }
  joined.texcoords = joined.texcoords || joined.material;
  const auto is_light = [](const JoinedFile& file) {
    return file.layout.space == ColourSpace::linear;
  };
  joined.space = std::ranges::any_of(files, is_light) ? ColourSpace::linear : ColourSpace::srgb;
  for (const JoinedFile& file : files) {
    // Beside pictures a material's colour stays one.
    const ColourType colour = joined.material ? own_colour(file) : file.layout.colour;
    joined.colour =
        std::max(joined.colour, file.layout.space == joined.space ? colour : type_of_light(colour));
    joined.alpha = joined.alpha || (colour != ColourType::none && file.layout.alpha);
  }
  joined.values = files[0].layout.values;
  std::erase_if(joined.values, [&](const ScalarAttribute& value) {
    return !std::ranges::all_of(
        files, [&](const JoinedFile& file) { return place_of(value, file.layout).has_value(); });
  });
  joined.tints = joined.material && joined.has_colours() && may_tint(files);
  return joined;
}

/// Vertices of one file on their way to the layout of all.
class RowJoin {
 public:
  RowJoin(const JoinedFile& file, const AttributeLayout& to, PlainMaterials& plain)
      : file_(file), to_(to), given_(file.layout.parts()), parts_(to.parts()), plain_(plain) {
    keeps_paint_ = file.is_painted && !to.material;
    colour_ = keeps_paint_ ? file.layout.colour : own_colour(file);
    for (const ScalarAttribute& value : to.values)
      values_.push_back(*place_of(value, file.layout));
  }

  void append(std::span<const float> row, storage::RecordSpool<float>& joined) const {
    for (const AttributePart& part : parts_) {
      const AttributePart& from = part_of(given_, part.kind);
      const bool is_of_picture =
          part.kind == AttributeKind::texcoords || part.kind == AttributeKind::material;
      if (part.count == 0)
        continue;
      if (part.kind == AttributeKind::colours)
        append_colour(part, from, row, joined);
      else if (part.kind == AttributeKind::values)
        append_values(row, joined);
      else if (!is_of_picture || shows_texcoords())
        joined.append(from.of(row));
      else if (part.kind == AttributeKind::texcoords)
        joined.append(std::array{0.0F, 0.0F});
      else
        joined.append(plain_.number(paint_of(file_, row)));
    }
  }

  void count(JoinCounts& counts) const {
    const std::uint64_t n = file_.vertices;
    const AttributeLayout& from = file_.layout;
    counts.untextured_files += to_.material && !from.material ? 1 : 0;
    for (const AttributeKindRow& row : kAttributeKinds) {
      const bool is_shown =
          row.kind == AttributeKind::texcoords ? shows_texcoords() : row.channels(to_) > 0;
      if (row.flag != nullptr && from.*row.flag && !is_shown)
        counts.dropped_of(row.kind) += n;
    }
    counts.dropped_of(AttributeKind::values) += n * (from.values.size() - to_.values.size());
    if (!to_.has_colours())
      return;
    counts.white_vertices += colour_ == ColourType::none && !to_.material ? n : 0;
    const bool is_plain = !from.material || from.tints;
    counts.hidden_colours +=
        to_.material && !to_.tints && is_plain && has_own_colours(file_) ? n : 0;
    const bool is_converted = colour_ != to_.colour || from.space != to_.space;
    counts.converted_colours += colour_ != ColourType::none && is_converted ? n : 0;
  }

 private:
  bool shows_texcoords() const {
    return to_.texcoords && file_.layout.texcoords && file_.layout.material == to_.material;
  }
  void append_values(std::span<const float> row, storage::RecordSpool<float>& joined) const {
    for (const PlacedValue& value : values_)
      joined.append(row.subspan(value.channel, value.channels()));
  }
  void append_colour(const AttributePart& to, const AttributePart& from, std::span<const float> row,
                     storage::RecordSpool<float>& joined) const {
    const std::size_t given = colour_ == ColourType::none ? 0 : from.count;
    std::array<float, 4> colour;
    colour.fill(full_number(to_.colour));
    for (std::size_t c = 0; c < std::min(given, to.count); ++c)
      colour[c] = converted(row[from.first + c], c, file_.layout, to_);
    joined.append(std::span(colour).first(to.count));
  }

  const JoinedFile& file_;
  const AttributeLayout& to_;
  AttributeParts given_, parts_;  ///< of the file and of all
  PlainMaterials& plain_;
  bool keeps_paint_ = false;
  ColourType colour_{};
  std::vector<PlacedValue> values_;  ///< places in the file's vertices
};

/// Copies so many channels from `first` on.
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

JoinCounts join_layouts(std::span<const JoinedFile> files, RawMesh& mesh, const ImportRoom& room) {
  mesh.layout = files.empty() ? AttributeLayout() : files[0].layout;
  if (std::ranges::all_of(files,
                          [&](const JoinedFile& file) { return file.layout == files[0].layout; }))
    return {};
  mesh.layout = joined_layout(files);
  JoinCounts counts;
  PlainMaterials plain(mesh.materials);
  storage::RecordSpool<float> joined(room.scratch, kImportSpoolBytes);
  std::uint64_t channel = 0;
  for (const JoinedFile& file : files) {
    const std::uint64_t count = file.vertices * static_cast<std::uint64_t>(file.layout.channels());
    const RowJoin join(file, mesh.layout, plain);
    join.count(counts);
    if (file.layout == mesh.layout) {
      copy(mesh.attributes, channel, count, joined, room);
    } else {
      for_each_row(file, mesh.attributes, channel, room,
                   [&](std::span<const float> row) { join.append(row, joined); });
    }
    channel += count;
  }
  mesh.attributes.clear();
  copy(joined, 0, joined.size(), mesh.attributes, room);
  return counts;
}

}  // namespace meshhier::importing
