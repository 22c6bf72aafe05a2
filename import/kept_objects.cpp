#include "import/kept_objects.h"

#include "base/error.h"
#include "base/number_text.h"
#include "base/plain_text.h"
#include "execution/spool_cursor.h"
#include "hierarchy/object_set.h"
#include "hierarchy/value_channels.h"
#include "mesh_io/input_error.h"
#include "storage/format/object_magic.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

constexpr std::size_t kShownNumberBytes = 60;

std::uint32_t row_named(std::string_view name, std::uint32_t rows,
                        const std::filesystem::path& path) {
  const auto row = parse_number<std::uint32_t>(name);
  if (!row || *row >= rows) {
    mesh_io::fail_file(path, fmt::format("is the table of a hierarchy: what the mesh has are to be "
                                         "numbers of its {} rows, and \"{}\" is none",
                                         rows, plain_text(name, kShownNumberBytes)));
  }
  return *row;
}

/// What the build finds out by itself is left out.
ObjectRow imported(ObjectRow row) {
  return {std::move(row.name), std::move(row.values), std::nullopt, 0, 0};
}

}  // namespace

bool is_object_table(const storage::File& file) {
  constexpr std::string_view magic = storage::kObjectTableMagic;
  std::array<std::byte, magic.size()> begin{};
  if (file.size() < begin.size())
    return false;
  file.read_exact(0, begin);
  return std::ranges::equal(begin, std::as_bytes(std::span(magic)));
}

void keep_objects(const MeshObjects& objects, const storage::ObjectTable& table,
                  const std::filesystem::path& path, storage::File& file, ObjectList& list,
                  const execution::CancelToken& cancel) {
  ObjectSet kept(table.size());
  objects.names.for_each([&](std::uint32_t, const FoundObject& object) {
    cancel.check();
    kept.add(row_named(object.name, table.size(), path));
  });
  kept.close();
  storage::ObjectTableWriter writer(file, table.properties());
  kept.for_each([&](std::uint32_t row) {
    cancel.check();
    writer.add(imported(table.row(row)));
  });
  list.facts = writer.finish();
  objects.names.for_each([&](std::uint32_t, const FoundObject& object) {
    cancel.check();
    list.numbers.append(kept.place_of(row_named(object.name, table.size(), path)));
  });
}

void drop_value(RawMesh& mesh, std::size_t value, const ImportRoom& room) {
  const PlacedValue place = placed_values(mesh.layout)[value];
  const std::size_t before = mesh.channels();
  storage::RecordSpool<float> left(room.scratch, kImportSpoolBytes);
  {
    execution::SpoolCursor attributes(mesh.attributes, room.cancel);
    for (std::uint64_t i = 0; i < attributes.size(); ++i) {
      const std::size_t channel = i % before;
      if (channel < place.channel || channel >= place.channel + place.channels())
        left.append(attributes.at(i));
    }
  }
  mesh.attributes.clear();
  execution::SpoolCursor attributes(left, room.cancel);
  for (std::uint64_t i = 0; i < attributes.size(); ++i)
    mesh.attributes.append(attributes.at(i));
  mesh.layout.values.erase(mesh.layout.values.begin() + static_cast<std::ptrdiff_t>(value));
}

}  // namespace meshhier::importing
