#include "import/content_reader.h"

#include "mesh_io/part_of_file.h"
#include "storage/io/file_checksum.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace meshhier::importing {
namespace {

/// Whether what is wanted of a file is most of it: not one of many tiles in it.
bool wants_most(const InputFileFacts& facts) {
  return !facts.tile || facts.tile->bytes > facts.identity.bytes / 2;
}

}  // namespace

ReadContent ContentReader::read(const InputFileFacts& facts) {
  const bool is_data = facts.tile && facts.tile->data;
  if (is_data || !wants_most(facts) || facts.identity.bytes > most_)
    return {.file = facts.content(files_)};
  ReadContent content{.memory = room_.share(facts.identity.bytes)};
  const auto file = files_.open(facts.path);
  auto bytes = std::make_shared<std::vector<std::byte>>(facts.identity.bytes);
  storage::FileChecksum checksum(bytes->size());
  constexpr std::size_t kBlock = 4 * storage::FileChecksum::kBlockBytes;
  for (std::size_t at = 0; at < bytes->size(); at += kBlock) {
    cancel_.check();
    const auto block = std::span(*bytes).subspan(at, std::min(kBlock, bytes->size() - at));
    file->read_exact(at, block);
    checksum.add(at, block);
  }
  content.checksum = checksum.complete(*file, [] {});
  content.file = mesh_io::file_of_bytes(facts.path, std::move(bytes));
  return content;
}

}  // namespace meshhier::importing
