#include "storage/format/object_directory.h"

#include "base/utf8.h"
#include "storage/format/byte_columns.h"
#include "storage/format/object_block.h"

#include <algorithm>
#include <set>

namespace meshhier::storage {
namespace {

// The columns of a directory (byte_columns.h):
//
//   p, number of properties     one u32
//   b, number of blocks         one u32
//   types of the properties     p u8: 0 number, 1 boolean, 2 text, 3 date
//   names of the properties     p texts
//   objects of the blocks       b u32
//   bytes of the blocks         b u32, in the file
//   unpacked bytes              b u32
//   checksums of the blocks     b u64
//   keys of the blocks          b texts

std::vector<ObjectProperty> read_properties(ColumnReader& columns, std::size_t count) {
  const std::vector<std::uint8_t> types = columns.numbers<std::uint8_t>(count);
  const std::vector<std::string_view> names = columns.texts(count);
  std::vector<ObjectProperty> properties;
  std::set<std::string_view> known;
  for (std::size_t i = 0; i < count; ++i) {
    if (types[i] >= kObjectPropertyTypes)
      columns.fail("a property has an unknown type");
    if (names[i].empty() || names[i].size() > kMostPropertyNameBytes || !is_utf8(names[i]))
      columns.fail("a property's name is empty, too long or no UTF-8");
    if (!known.insert(names[i]).second)
      columns.fail("two properties have the same name");
    properties.push_back({std::string(names[i]), static_cast<ObjectPropertyType>(types[i])});
  }
  return properties;
}

/// Whether the keys of blocks that follow each other may be these.
bool may_follow(std::string_view key, std::string_view before) {
  return before < key || (before == key && key.size() == kMostKeyBytes);
}

std::vector<ObjectBlock> read_blocks(ColumnReader& columns, std::size_t count) {
  const std::vector<std::uint32_t> objects = columns.numbers<std::uint32_t>(count);
  const std::vector<std::uint32_t> bytes = columns.numbers<std::uint32_t>(count);
  const std::vector<std::uint32_t> unpacked = columns.numbers<std::uint32_t>(count);
  const std::vector<std::uint64_t> checksums = columns.numbers<std::uint64_t>(count);
  const std::vector<std::string_view> keys = columns.texts(count);
  std::vector<ObjectBlock> blocks(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (objects[i] == 0 || objects[i] > kMostBlockObjects)
      columns.fail("a block has no objects, or too many");
    if (bytes[i] == 0 || std::max(bytes[i], unpacked[i]) > kMostObjectBlockBytes)
      columns.fail("a block has no bytes, or too many");
    if (keys[i].size() > kMostKeyBytes || (i > 0 && !may_follow(keys[i], keys[i - 1])))
      columns.fail("the keys of the blocks do not ascend");
    blocks[i] = {0, bytes[i], unpacked[i], 0, objects[i], checksums[i], std::string(keys[i])};
  }
  return blocks;
}

}  // namespace

std::string_view key_of(std::string_view name) {
  return name.substr(0, kMostKeyBytes);
}

std::vector<std::byte> encode_object_directory(const ObjectDirectory& directory) {
  const auto& [properties, blocks] = directory;
  ColumnWriter columns;
  std::vector<std::string_view> names, keys;
  for (const ObjectProperty& property : properties)
    names.push_back(property.name);
  for (const ObjectBlock& block : blocks)
    keys.push_back(block.key);
  columns.number(static_cast<std::uint32_t>(properties.size()));
  columns.number(static_cast<std::uint32_t>(blocks.size()));
  columns.numbers<std::uint8_t>(properties | std::views::transform([](const auto& property) {
                                  return static_cast<std::uint8_t>(property.type);
                                }));
  columns.texts(names);
  columns.numbers<std::uint32_t>(blocks | std::views::transform(&ObjectBlock::count));
  columns.numbers<std::uint32_t>(blocks | std::views::transform(&ObjectBlock::bytes));
  columns.numbers<std::uint32_t>(blocks | std::views::transform(&ObjectBlock::unpacked));
  columns.numbers<std::uint64_t>(blocks | std::views::transform(&ObjectBlock::checksum));
  columns.texts(keys);
  return columns.bytes();
}

ObjectDirectory decode_object_directory(std::span<const std::byte> bytes, std::uint64_t offset,
                                        std::uint64_t end, const std::string& name) {
  ColumnReader columns(bytes, name);
  const auto properties = columns.number<std::uint32_t>();
  const auto blocks = columns.number<std::uint32_t>();
  if (properties > kMostObjectProperties)
    columns.fail("it has too many properties");
  ObjectDirectory directory{read_properties(columns, properties), read_blocks(columns, blocks)};
  columns.finish();
  std::uint32_t first = 0;
  for (ObjectBlock& block : directory.blocks) {
    block.offset = offset;
    block.first = first;
    offset += block.bytes;
    if (block.count > kMostObjects - first)
      columns.fail("it has too many objects");
    first += block.count;
  }
  if (offset != end)
    columns.fail("its blocks do not fill the file");
  return directory;
}

}  // namespace meshhier::storage
