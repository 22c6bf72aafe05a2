// The input of the target `archive` is taken twice: as an archive, and as what one is made of and
// then changed:
//
//   u8   files, modulo 8; of each: u8 bytes of its name, modulo 24; the name; u8 bytes of content
//        (a name that no file can have, or another one has, is passed over)
//   then changes until the input ends: u16 place from the end on, modulo the size; u8 value
//
// What is accepted is what the writer makes of the same files, to the byte.
#include "storage/format/archive.h"

#include "fuzz/target.h"
#include "fuzz/targets.h"
#include "storage/format/archive_check.h"
#include "storage/format/archive_files.h"
#include "storage/format/archive_writer.h"
#include "support/memory_files.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::tests::fuzz {
namespace {

constexpr const char* kArchive = "a.3tz";
constexpr const char* kContent = "content";

using ArchiveMembers = std::vector<std::pair<std::string, std::string>>;

MemoryFiles::Bytes packed(const ArchiveMembers& members) {
  MemoryFiles files;
  const auto archive = files.create(kArchive);
  storage::ArchiveWriter writer(*archive, [] {});
  for (const auto& [name, content] : members) {
    files.put(kContent, content);
    writer.add(name, *files.open(kContent));
  }
  writer.finish();
  return files.bytes(kArchive);
}

/// All files but the index, in their order.
ArchiveMembers read_members(storage::ArchiveFiles& inside) {
  ArchiveMembers members;
  inside.archive().for_each([&](const storage::ArchiveEntry& entry) {
    const std::filesystem::path path = std::filesystem::path(kArchive) / entry.name;
    const auto bytes = storage::read_file(inside, path, entry.bytes);
    members.emplace_back(entry.name,
                         std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  });
  members.pop_back();
  return members;
}

bool is_accepted(Bytes bytes) {
  MemoryFiles files;
  storage::write_file(files, kArchive, bytes);
  storage::is_hierarchy_archive(files, kArchive);
  bool sound = false;
  const std::string refused = refusal({ErrorCode::corrupt, ErrorCode::io}, "a.3tz: ", [&] {
    storage::ArchiveFiles inside(files, kArchive);
    const ArchiveMembers members = read_members(inside);
    require(inside.list(kArchive).size() == members.size(), "every file is listed");
    std::string problems;
    storage::check_archive(
        inside.archive(), [] {},
        [&](const std::string& problem) {
          require_message(problem, "a.3tz: ");
          problems += problem;
        });
    sound = problems.empty();
    require(!sound || std::ranges::equal(packed(members), bytes), "nothing is left open");
  });
  return sound;
}

ArchiveMembers take_members(Take& take) {
  ArchiveMembers members;
  std::set<std::string> names{std::string(storage::kArchiveIndexName)};
  for (int count = take.upto<std::uint8_t>(7); count > 0; --count) {
    std::string name(take.upto<std::uint8_t>(23), ' ');
    for (char& c : name)
      c = static_cast<char>(take.number<std::uint8_t>());
    const std::string content(take.number<std::uint8_t>(), 'x');
    if (storage::is_archive_name(name) && names.insert(name).second)
      members.emplace_back(name, content);
  }
  return members;
}

}  // namespace

void archive(Bytes input) {
  is_accepted(input);
  Take take(input);
  MemoryFiles::Bytes bytes = packed(take_members(take));
  require(is_accepted(bytes), "what is written is read again");
  while (!take.rest().empty()) {
    const std::size_t place = take.number<std::uint16_t>() % bytes.size();
    bytes[bytes.size() - 1 - place] = static_cast<std::byte>(take.number<std::uint8_t>());
  }
  is_accepted(bytes);
}

}  // namespace meshhier::tests::fuzz
