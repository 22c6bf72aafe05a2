#include "export/glb_objects.h"

#include "base/error.h"
#include "storage/format/tile_values.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <utility>

namespace meshhier::exporting {
namespace {

/// So few rows, with all columns and the longest texts, fit the table of a tile, which would
/// otherwise leave columns out.
constexpr std::size_t kRowsAtOnce = 200;
constexpr std::size_t kColumnBlockBytes = 65536;

template <class Record>
void put_spool(const storage::RecordSpool<Record>& spool, ByteStream& to) {
  std::vector<Record> block;
  std::uint64_t bytes = 0;
  for (std::uint64_t first = 0; first < spool.size(); first += block.size()) {
    block.resize(std::min<std::uint64_t>(kColumnBlockBytes, spool.size() - first));
    spool.read(first, block);
    to.put(std::as_bytes(std::span(block)));
    bytes += std::span(block).size_bytes();
  }
  to.put(std::vector<std::byte>((8 - bytes % 8) % 8));
}

}  // namespace

GlbObjects::Column::Column(storage::ScratchFile& scratch)
    : values(scratch, kColumnBlockBytes), starts(scratch, kColumnBlockBytes) {}

GlbObjects::GlbObjects(const PartsJob& job)
    : job_(job),
      place_(placed_object(job.reader.tile_format().attributes).value()),
      table_(job.reader.open_objects()),
      shown_(table_->size()),
      pool_(job.memory_budget / 4),
      scratch_(job.files, job.output.scratch(), pool_) {}

std::uint32_t GlbObjects::object_of(std::span<const float> attributes) const {
  const double object = place_.in(attributes.data());
  if (!(object >= 0 && object < table_->size()))
    throw Error(ErrorCode::corrupt, "a tile has an object that the table of objects does not have");
  return static_cast<std::uint32_t>(object);
}

std::uint32_t GlbObjects::add(const CutPart& part) {
  std::vector<std::uint32_t> objects;
  for (std::size_t v = 0; v < part.vertices.size(); ++v) {
    const std::uint32_t object = object_of(part.vertices.attributes_of(v));
    if (objects.empty() || objects.back() != object)
      objects.push_back(object);
    shown_.add(object);
  }
  std::ranges::sort(objects);
  return static_cast<std::uint32_t>(std::unique(objects.begin(), objects.end()) - objects.begin());
}

void GlbObjects::make_table() {
  shown_.close();
  std::vector<std::uint32_t> objects;
  shown_.for_each([&](std::uint32_t object) {
    objects.push_back(object);
    if (objects.size() == kRowsAtOnce)
      add_rows(std::exchange(objects, {}));
  });
  if (!objects.empty())
    add_rows(objects);
  std::vector<std::uint64_t> text_bytes;
  for (const auto& column : made_) {
    if (column->starts.size() > 0)
      text_bytes.push_back(column->values.size());
  }
  columns_.emplace(storage::ObjectTableShape{table_->properties(), rows(),
                                             static_cast<std::uint32_t>(made_.size()),
                                             std::move(text_bytes)});
}

void GlbObjects::add_rows(const std::vector<std::uint32_t>& objects) {
  job_.cancel.check();
  const TileObjects rows = storage::make_tile_objects(
      objects, table_->properties(), [&](std::uint32_t object) { return table_->row(object); });
  const storage::ObjectColumns columns(
      {table_->properties(), objects.size(), rows.columns, rows.text_bytes});
  const std::span table(rows.table);
  for (std::size_t c = 0; c < columns.columns.size(); ++c) {
    const storage::ObjectColumn& from = columns.columns[c];
    if (c == made_.size())
      made_.push_back(std::make_unique<Column>(scratch_));
    Column& to = *made_[c];
    const auto before = static_cast<std::uint32_t>(to.values.size());
    // The end of the texts of the rows before is the first place of these.
    for (std::uint64_t at = to.starts.size() > 0 ? sizeof before : 0; at < from.start_bytes;
         at += sizeof before)
      to.starts.append(before +
                       storage::load_little<std::uint32_t>(table.data() + from.starts + at));
    to.values.append(table.subspan(from.values, from.value_bytes));
  }
}

nlohmann::ordered_json GlbObjects::metadata(std::size_t first_view) const {
  nlohmann::ordered_json metadata;
  metadata["schema"] = {{"id", "meshhier"}};
  metadata["schema"]["classes"]["object"] = object_class(*columns_);
  metadata["propertyTables"] =
      nlohmann::ordered_json::array({object_table_json(*columns_, first_view)});
  return metadata;
}

void GlbObjects::write(ByteStream& to) const {
  for (const auto& column : made_) {
    put_spool(column->values, to);
    if (column->starts.size() > 0)
      put_spool(column->starts, to);
  }
}

}  // namespace meshhier::exporting
