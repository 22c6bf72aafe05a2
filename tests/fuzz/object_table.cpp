// A table of objects.
//
// First a byte: the input is a file, the bytes of a block or of a directory, or rows to be written,
// a line each.
#include "storage/format/object_table.h"

#include "base/utf8.h"
#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "storage/format/object_block.h"
#include "support/memory_files.h"

#include <cstdint>
#include <set>
#include <string>

namespace meshhier::tests::fuzz {
namespace {

constexpr const char* kFile = "/models/objects.bin";

void walk(const storage::ObjectTable& table) {
  std::uint32_t next = 0;
  table.for_each([&](std::uint32_t object, const ObjectRow& row) {
    require(object == next++, "objects come in order");
    require(row.values.size() == table.properties().size(), "a value of each property");
    require(table.find(row.name) == object, "an object is found by its name");
  });
  require(next == table.size(), "each object is there");
}

void read(MemoryFiles& files) {
  refusal({ErrorCode::corrupt}, kFile, [&] { walk(storage::ObjectTable(files.open(kFile))); });
}

void read_file(Take& take) {
  MemoryFiles files;
  files.put(kFile, text_of(take.rest()));
  read(files);
}

void read_block(Take& take) {
  std::vector<ObjectProperty> properties(take.upto<std::uint8_t>(4));
  for (ObjectProperty& property : properties)
    property.type = ObjectPropertyType{take.upto<std::uint8_t>(kObjectPropertyTypes - 1)};
  const auto count = std::size_t{1} + take.number<std::uint8_t>();
  const Bytes bytes = take.rest();
  refusal({ErrorCode::corrupt}, "block: ", [&] {
    const auto rows = storage::decode_object_block(bytes, count, properties, "block");
    require(std::ranges::equal(storage::encode_object_block(rows, properties), bytes),
            "nothing is lost");
  });
}

void read_directory(Take& take) {
  const auto blocks_bytes = take.number<std::uint32_t>();
  const Bytes bytes = take.rest();
  refusal({ErrorCode::corrupt}, "directory: ", [&] {
    const auto directory =
        storage::decode_object_directory(bytes, 12, 12 + std::uint64_t{blocks_bytes}, "directory");
    require(directory.objects() <= kMostObjects, "not too many objects");
    require(std::ranges::equal(storage::encode_object_directory(directory), bytes),
            "nothing is lost");
  });
}

void write_rows(Take& take) {
  std::set<std::string> names;
  std::string line;
  for (const char c : text_of(take.rest())) {
    line += c;
    if (c == '\n' && is_utf8(line))
      names.insert(line);
    if (c == '\n')
      line.clear();
  }
  MemoryFiles files;
  const auto file = files.create(kFile);
  storage::ObjectTableWriter writer(*file, {{"text", ObjectPropertyType::text}});
  for (const std::string& name : names)
    writer.add({name, {name.size() % 2 == 0 ? ObjectValue(name) : ObjectValue()}, {}, 1, 0});
  const storage::ObjectTableFacts facts = writer.finish();
  const storage::ObjectTable table(files.open(kFile), &facts);
  require(table.size() == names.size(), "each name is an object");
  walk(table);
}

}  // namespace

void object_table(Bytes input) {
  Take take(input);
  switch (take.upto<std::uint8_t>(3)) {
    case 0:
      return read_file(take);
    case 1:
      return read_block(take);
    case 2:
      return read_directory(take);
    default:
      return write_rows(take);
  }
}

}  // namespace meshhier::tests::fuzz
