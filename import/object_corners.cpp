#include "import/object_corners.h"

#include "base/error.h"
#include "execution/spool_cursor.h"
#include "hierarchy/value_channels.h"
#include "import/append_value.h"
#include "import/split_corners.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

void add_corners(const RawMesh& mesh, const std::function<std::uint32_t(std::uint64_t)>& object_of,
                 CornerSplitter& splitter, const ImportRoom& room) {
  execution::SpoolCursor triangles(mesh.triangles, room.cancel);
  for (std::uint64_t i = 0; i < triangles.size(); ++i) {
    CornerParts::Parts parts{};
    parts[CornerParts::kValues] = object_of(i) + 1;
    for (const std::uint32_t corner : triangles.at(i))
      splitter.add({corner, parts});
  }
}

/// Appends the vertices of `from` that are split; objects stand behind the first `before` channels.
void append_objects(const RawMesh& from, const SplitVertices& vertices, std::size_t before,
                    RawMesh& to, std::span<std::uint64_t> ends, const ImportRoom& room) {
  execution::SpoolCursor positions(from.positions, room.cancel);
  execution::SpoolCursor attributes(from.attributes, room.cancel);
  SplitCursor split(vertices, room.cancel);
  const std::size_t channels = from.channels();
  auto end = ends.begin();
  std::vector<float> row, object;
  for (std::uint64_t i = 0; i < split.size(); ++i) {
    const std::uint64_t vertex = split.position(i);
    for (; end != ends.end() && *end <= vertex; ++end)
      *end = i;
    to.positions.append(positions.at(vertex));
    row.clear();
    for (std::size_t c = 0; c < channels; ++c)
      row.push_back(attributes.at(vertex * channels + c));
    object.clear();
    const std::uint32_t part = split.parts(i)[CornerParts::kValues];
    append_value(ValueType::u32, part > 0 ? part - 1 : 0, object);
    row.insert(row.begin() + static_cast<std::ptrdiff_t>(before), object.begin(), object.end());
    to.attributes.append(row);
  }
  std::fill(end, ends.end(), split.size());
}

}  // namespace

std::string object_value_name(const AttributeLayout& layout) {
  const std::string wanted = "object";
  std::string name = wanted;
  for (int number = 2;
       std::ranges::find(layout.values, name, &ScalarAttribute::name) != layout.values.end();
       ++number)
    name = fmt::format("{}_{}", wanted, number);
  return name;
}

std::uint64_t put_objects(RawMesh& mesh, RawMesh& whole,
                          const std::function<std::uint32_t(std::uint64_t)>& object_of,
                          std::span<std::uint64_t> ends, const ImportRoom& room) {
  if (mesh.layout.value_channels() + channels_of(ValueType::u32) > kMaxValueChannels) {
    throw Error(ErrorCode::input,
                "vertices have so many values that none is left for the objects; choose fewer by "
                "\"attributes\", or \"objects\": \"none\"");
  }
  CornerSplitter splitter(mesh.vertex_count(), room);
  add_corners(mesh, object_of, splitter, room);
  mesh.triangles.clear();
  whole.fits_float = mesh.fits_float;
  whole.layout = mesh.layout;
  whole.layout.values.push_back({object_value_name(mesh.layout), ValueType::u32, true, true});
  SplitVertices vertices(room.scratch);
  splitter.split(vertices, whole);
  const std::uint64_t more = vertices.count() - mesh.vertex_count();
  append_objects(mesh, vertices, mesh.layout.part(AttributeKind::values).end(), whole, ends, room);
  mesh.positions.clear();
  mesh.attributes.clear();
  return more;
}

}  // namespace meshhier::importing
