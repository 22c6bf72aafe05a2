#include "import/name_objects.h"

#include "base/error.h"
#include "base/named_value.h"
#include "base/plain_text.h"
#include "import/input_record.h"
#include "import/kept_objects.h"
#include "import/object_corners.h"
#include "import/object_labels.h"
#include "import/object_list.h"
#include "import/place_lookup.h"
#include "import/property_table.h"
#include "mesh_io/input_error.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::ObjectSource;

constexpr std::size_t kMostToldBytes = 200;  // of a name in a message

/// What an input has none of, for messages.
constexpr std::array kMissing{
    NamedValue{"nodes of a glTF that show a mesh", ObjectSource::node},
    NamedValue{"groups (\"g\" of an OBJ file)", ObjectSource::group},
    NamedValue{"objects (\"o\" of an OBJ file)", ObjectSource::object},
    NamedValue{"materials of an OBJ file or a glTF", ObjectSource::material},
    NamedValue{"files of meshes", ObjectSource::file},
    NamedValue{"solids of an ASCII STL file", ObjectSource::solid},
    NamedValue{"features of a glTF or b3dm", ObjectSource::feature},
    NamedValue{"labels", ObjectSource::label}};

class Namer {
 public:
  Namer(RawMesh& mesh, const ObjectNaming& naming)
      : mesh_(mesh), naming_(naming), list_(naming.room.scratch) {}

  std::optional<NamedObjects> run(RawMesh& whole, std::span<std::uint64_t> ends) {
    MeshObjects& objects = *mesh_.objects;
    if (objects.choice.from == ObjectSource::label)
      find_label_objects(objects.choice.label, mesh_, naming_.room);
    if (!are_there())
      return std::nullopt;
    objects.fill(mesh_.triangles.size());
    if (!keep())
      list();
    RunCursor runs(objects.runs);
    SpoolLookup<std::uint32_t> numbers(list_.numbers);
    const std::uint64_t split = put_objects(
        mesh_, whole, [&](std::uint64_t triangle) { return numbers.at(runs.object_of(triangle)); },
        ends, naming_.room);
    count("split_vertices", split);
    tell_dropped(objects.properties);
    return std::move(named_);
  }

 private:
  bool are_there() const {
    const MeshObjects& objects = *mesh_.objects;
    if (objects.choice.is_evident() ? objects.names.are_different() : objects.names.has_any())
      return true;
    if (!objects.choice.is_evident())
      fail(fmt::format("has no {}", name_in(kMissing, objects.choice.from)));
    if (!naming_.table.empty())
      fail("has no objects that are evident, to which the rows of \"objects.table\" could belong");
    return false;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::input,
                fmt::format("objects.from: {} {}; say what objects are made from, or \"none\"",
                            naming_.input, what));
  }

  void count(std::string_view name, std::uint64_t count) { add_count(named_.counts, name, count); }

  /// Takes the objects from the table of a hierarchy; returns false if it is another table. A label
  /// that has their numbers says nothing more then.
  bool keep() {
    if (naming_.table.empty())
      return false;
    auto file = naming_.files.input().open(naming_.table);
    if (!is_object_table(*file))
      return false;
    const MeshObjects& objects = *mesh_.objects;
    const auto to = naming_.files.create(naming_.to);
    keep_objects(objects, storage::ObjectTable(std::move(file)), naming_.table, *to, list_,
                 naming_.room.cancel);
    to->sync();
    if (objects.choice.from == ObjectSource::label) {
      const auto& values = mesh_.layout.values;
      const auto label = std::ranges::find(values, objects.choice.label, &ScalarAttribute::name);
      drop_value(mesh_, static_cast<std::size_t>(label - values.begin()), naming_.room);
    }
    named_.imported = {naming_.to, list_.facts};
    return true;
  }

  PropertyTable::Ids ids() const {
    const MeshObjects& objects = *mesh_.objects;
    if (!objects.names.have_ids())
      return PropertyTable::Ids::none;
    return objects.choice.from == ObjectSource::label ? PropertyTable::Ids::numbers
                                                      : PropertyTable::Ids::texts;
  }

  void list() {
    MeshObjects& objects = *mesh_.objects;
    PropertyTypes types;
    std::optional<PropertyTable> table;
    if (!naming_.table.empty()) {
      table.emplace(ids(), objects.properties, types, naming_.room, naming_.room.sort_bytes / 2);
      const auto file = naming_.files.input().open(naming_.table);
      const auto stream = mesh_io::open_stream({*file, file->size()},
                                               [&](std::uint64_t) { naming_.room.cancel.check(); });
      table->read(*stream, naming_.table);
    }
    const auto to = naming_.files.create(naming_.to);
    list_objects(objects, table ? &*table : nullptr, types, *to, list_, naming_.room);
    to->sync();  // a build that goes on later, and tasks, trust it
    named_.imported = {naming_.to, list_.facts};
    if (table)
      tell(table->counts());
  }

  void tell_dropped(const PropertyNames& properties) {
    count("dropped_properties", properties.dropped());
    if (properties.dropped() > 0)
      named_.warnings.push_back(fmt::format(
          "{}: {} of objects left out: {}; up to {} are kept, with names of 1 to {} bytes",
          naming_.input, counted(properties.dropped(), "properties"), properties.dropped_names(),
          kMostObjectProperties, kMostPropertyNameBytes));
  }

  void tell(const PropertyTableCounts& counts) {
    count("table_rows", counts.read.records);
    count("fields_not_utf8", counts.read.foreign);
    count("unmatched_rows", counts.unmatched);
    count("duplicate_rows", counts.duplicate);
    count("ragged_rows", counts.read.ragged);
    count("objects_without_row", list_.without_row);
    const auto warn = [&](const std::string& message) {
      named_.warnings.push_back(mesh_io::file_message(naming_.table, message));
    };
    if (counts.read.records == 0)
      warn("has no rows");
    if (counts.read.foreign > 0)
      warn(fmt::format("{} no UTF-8: their odd bytes are taken for Windows-1252; save it as UTF-8",
                       counted(counts.read.foreign, "fields with")));
    if (counts.read.ragged > 0)
      warn(fmt::format("{} more or fewer fields than its first line has (line {} is the first)",
                       counted(counts.read.ragged, "rows with"), counts.read.first_ragged));
    if (counts.duplicate > 0)
      warn(fmt::format("{} the id or name of an earlier one, which counts",
                       counted(counts.duplicate, "rows with")));
    if (counts.unmatched > 0)
      warn(fmt::format("{} {} to no object", counted(counts.unmatched, "rows"),
                       counts.unmatched == 1 ? "belongs" : "belong"));
    if (list_.without_row > 0)
      warn(fmt::format("has no row for {}; the first is \"{}\"",
                       counted(list_.without_row, "objects"),
                       plain_text(list_.first_without_row, kMostToldBytes)));
  }

  RawMesh& mesh_;
  const ObjectNaming& naming_;
  ObjectList list_;
  NamedObjects named_;
};

}  // namespace

std::optional<NamedObjects> name_objects(RawMesh& mesh, RawMesh& whole,
                                         std::span<std::uint64_t> ends,
                                         const ObjectNaming& naming) {
  return Namer(mesh, naming).run(whole, ends);
}

}  // namespace meshhier::importing
