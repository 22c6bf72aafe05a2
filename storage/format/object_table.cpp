#include "storage/format/object_table.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/utf8.h"
#include "storage/format/gzip.h"
#include "storage/format/object_block.h"
#include "storage/format/object_magic.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

// objects.bin, little endian:
//
//   offset        bytes  what
//   0             8      magic "MHTABLE\n"
//   8             4      version, 1
//   12                   blocks, one behind the other; each is one gzip member
//   size - 24 - d d      directory: one gzip member
//   size - 24     8      d
//   size - 16     8      bytes of the directory, unpacked
//   size - 8      8      XXH3-64 of the directory as it is in the file
constexpr std::uint32_t kTableVersion = 1;
constexpr std::size_t kTableHeadBytes = 12;
constexpr std::size_t kTableEndBytes = 24;

/// Unpacked blocks that a reader keeps: neighbours by name are often asked for together.
constexpr std::size_t kKeptBlocks = 16;
/// Bytes of a name in a message.
constexpr std::size_t kShownNameBytes = 60;

[[maybe_unused]] bool is_sound(const ObjectValue& value) {
  if (const auto* number = std::get_if<double>(&value))
    return std::isfinite(*number);
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr || is_utf8(*text);
}

/// Whether the writer may take a row, but for its length.
[[maybe_unused]] bool is_sound(const ObjectRow& row, std::span<const ObjectProperty> properties) {
  return is_utf8(row.name) && std::isfinite(row.area) && row.area >= 0 &&
         std::ranges::equal(properties, row.values,
                            [](const ObjectProperty& property, const ObjectValue& value) {
                              return is_value_of(property.type, value) && is_sound(value);
                            });
}

}  // namespace

ObjectTableWriter::ObjectTableWriter(File& file, std::vector<ObjectProperty> properties)
    : file_(file), directory_{std::move(properties), {}} {
  assert(directory_.properties.size() <= kMostObjectProperties);
  std::array<std::byte, kTableHeadBytes> head{};
  std::ranges::copy(std::as_bytes(std::span(kObjectTableMagic)), head.begin());
  store_little(kTableVersion, head.data() + kObjectTableMagic.size());
  append(head);
}

void ObjectTableWriter::append(std::span<const std::byte> bytes) {
  file_.write_at(end_, bytes);
  end_ += bytes.size();
  sum_.add(bytes);
}

void ObjectTableWriter::add(ObjectRow row) {
  assert(is_sound(row, directory_.properties));
  assert(rows_.empty() || rows_.back().name < row.name);
  const std::size_t bytes = text_bytes(row);
  if (bytes > kMostObjectTextBytes) {
    throw Error(ErrorCode::input,
                fmt::format("object \"{}\" has a name and texts of {} bytes; at most {} are kept: "
                            "shorten them",
                            plain_text(row.name, kShownNameBytes), bytes, kMostObjectTextBytes));
  }
  if (rows_.size() == kMostBlockObjects ||
      (!rows_.empty() && text_bytes_ + bytes > kMostBlockTextBytes))
    flush();
  if (directory_.objects() + rows_.size() == kMostObjects) {
    throw Error(ErrorCode::input,
                fmt::format("there are more than {} objects: choose larger ones", kMostObjects));
  }
  text_bytes_ += bytes;
  rows_.push_back(std::move(row));
}

void ObjectTableWriter::flush() {
  const std::vector<std::byte> bytes = encode_object_block(rows_, directory_.properties);
  const std::vector<std::byte> packed = gzip(bytes);
  directory_.blocks.push_back({end_, static_cast<std::uint32_t>(packed.size()),
                               static_cast<std::uint32_t>(bytes.size()), directory_.objects(),
                               static_cast<std::uint32_t>(rows_.size()), storage::checksum(packed),
                               std::string(key_of(rows_.front().name))});
  append(packed);
  rows_.clear();
  text_bytes_ = 0;
}

ObjectTableFacts ObjectTableWriter::finish() {
  if (!rows_.empty())
    flush();
  const std::vector<std::byte> bytes = encode_object_directory(directory_);
  const std::vector<std::byte> directory = gzip(bytes);
  ObjectTableFacts facts{
      0, 0, directory_.objects(), directory.size(), checksum(directory), directory_.properties};
  append(directory);
  std::array<std::byte, kTableEndBytes> end;
  store_little(facts.directory_bytes, end.data());
  store_little(std::uint64_t{bytes.size()}, end.data() + 8);
  store_little(facts.directory_checksum, end.data() + 16);
  append(end);
  facts.bytes = end_;
  facts.checksum = sum_.value();
  return facts;
}

ObjectTable::ObjectTable(std::unique_ptr<const File> file, const ObjectTableFacts* expected)
    : file_(std::move(file)) {
  const Place place = read_place();
  read_directory(place);
  if (expected != nullptr)
    require_same(place, *expected);
}

void ObjectTable::fail(const std::string& what) const {
  throw Error(ErrorCode::corrupt, file_->path().string() + ": " + what);
}

ObjectTable::Place ObjectTable::read_place() const {
  const std::uint64_t size = file_->size();
  if (size < kTableHeadBytes + kTableEndBytes)
    fail(fmt::format("has {} bytes, too few for a table of objects", size));
  std::array<std::byte, kTableHeadBytes> head;
  std::array<std::byte, kTableEndBytes> end;
  file_->read_exact(0, head);
  file_->read_exact(size - end.size(), end);
  if (!std::ranges::equal(std::as_bytes(std::span(kObjectTableMagic)),
                          std::span(head).first(kObjectTableMagic.size())))
    fail("does not start with MHTABLE: no table of objects");
  const auto version = load_little<std::uint32_t>(head.data() + kObjectTableMagic.size());
  if (version != kTableVersion) {
    fail(fmt::format("version is {}, expected {}{}", version, kTableVersion,
                     version > kTableVersion ? " (written by a newer meshhier)" : ""));
  }
  const auto number = [&](std::size_t i) { return load_little<std::uint64_t>(end.data() + 8 * i); };
  Place place{0, number(0), number(1), number(2)};
  if (place.bytes > size - head.size() - end.size() || place.unpacked > kMostDirectoryBytes)
    fail(fmt::format("a directory of {} bytes, unpacked {}, does not fit", place.bytes,
                     place.unpacked));
  place.offset = size - end.size() - place.bytes;
  return place;
}

void ObjectTable::read_directory(const Place& place) {
  const std::string name = file_->path().string() + ": directory";
  const auto bytes = unpack({place.offset, place.bytes}, place.unpacked, place.checksum, name);
  directory_ = decode_object_directory(bytes, kTableHeadBytes, place.offset, name);
}

void ObjectTable::require_same(const Place& place, const ObjectTableFacts& expected) const {
  if (expected.bytes != file_->size() || expected.directory_bytes != place.bytes ||
      expected.directory_checksum != place.checksum || expected.objects != size() ||
      expected.properties != properties())
    fail("it is not the table that the manifest tells of");
}

std::vector<std::byte> ObjectTable::unpack(File::Range range, std::uint64_t unpacked,
                                           std::uint64_t sum, const std::string& name) const {
  std::vector<std::byte> packed(range.bytes);
  file_->read_exact(range.offset, packed);
  if (checksum(packed) != sum)
    throw Error(ErrorCode::corrupt, name + ": has another checksum: the file is damaged");
  std::vector<std::byte> bytes = gunzip(packed, unpacked, name);
  if (bytes.size() != unpacked)
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: has {} bytes, expected {}", name, bytes.size(), unpacked));
  return bytes;
}

ObjectTable::Rows ObjectTable::read_rows(const ObjectBlock& block) const {
  const std::string name =
      fmt::format("{}: block of object {}", file_->path().string(), block.first);
  const auto bytes = unpack({block.offset, block.bytes}, block.unpacked, block.checksum, name);
  auto rows = decode_object_block(bytes, block.count, directory_.properties, name);
  if (key_of(rows.front().name) != block.key)
    throw Error(ErrorCode::corrupt, name + ": does not begin with the name in the directory");
  return std::make_shared<const std::vector<ObjectRow>>(std::move(rows));
}

ObjectTable::Rows ObjectTable::rows_of(std::size_t block) const {
  {
    const std::lock_guard lock(mutex_);
    const auto known = std::ranges::find(kept_, block, &Kept::block);
    if (known != kept_.end()) {
      kept_.splice(kept_.begin(), kept_, known);
      return known->rows;
    }
  }
  // Two threads may read the same block at once, each for itself.
  Rows rows = read_rows(directory_.blocks[block]);
  const std::lock_guard lock(mutex_);
  kept_.push_front({block, rows});
  if (kept_.size() > kKeptBlocks)
    kept_.pop_back();
  return rows;
}

ObjectRow ObjectTable::row(std::uint32_t object) const {
  assert(object < size());
  const auto behind = std::ranges::upper_bound(directory_.blocks, object, {}, &ObjectBlock::first);
  const auto block = static_cast<std::size_t>(behind - directory_.blocks.begin()) - 1;
  return (*rows_of(block))[object - directory_.blocks[block].first];
}

std::uint32_t ObjectTable::first_not(const IsBefore& is_before) const {
  const auto begins_before = [&](const ObjectBlock& block) {
    if (block.key.size() < kMostKeyBytes)
      return is_before(block.key);
    const auto number = static_cast<std::size_t>(&block - directory_.blocks.data());
    return is_before(rows_of(number)->front().name);
  };
  const auto behind = std::ranges::partition_point(directory_.blocks, begins_before);
  if (behind == directory_.blocks.begin())
    return 0;
  const auto number = static_cast<std::size_t>(behind - directory_.blocks.begin()) - 1;
  const Rows rows = rows_of(number);
  const auto found = std::ranges::partition_point(*rows, is_before, &ObjectRow::name);
  return directory_.blocks[number].first + static_cast<std::uint32_t>(found - rows->begin());
}

std::optional<std::uint32_t> ObjectTable::find(std::string_view name) const {
  const std::uint32_t object = first_not([&](std::string_view other) { return other < name; });
  if (object == size() || row(object).name != name)
    return std::nullopt;
  return object;
}

ObjectTable::Range ObjectTable::range_of_prefix(std::string_view prefix) const {
  return {
      first_not([&](std::string_view name) { return name < prefix; }),
      first_not([&](std::string_view name) { return name < prefix || name.starts_with(prefix); })};
}

void ObjectTable::for_each(
    const std::function<void(std::uint32_t object, const ObjectRow& row)>& visit) const {
  std::string before;
  for (const ObjectBlock& block : directory_.blocks) {
    const Rows rows = read_rows(block);
    if (block.first > 0 && !(before < rows->front().name))
      fail(fmt::format("the name of object {} is not behind the one before", block.first));
    before = rows->back().name;
    for (std::size_t i = 0; i < rows->size(); ++i)
      visit(block.first + static_cast<std::uint32_t>(i), (*rows)[i]);
  }
}

}  // namespace meshhier::storage
