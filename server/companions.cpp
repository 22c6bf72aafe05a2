#include "server/companions.h"

#include "storage/io/file_checksum.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

namespace meshhier::server {

bool is_untouched(const storage::FileIdentity& a, const storage::FileIdentity& b) {
  return a == b && a.changed_ns == b.changed_ns;
}

std::optional<storage::FileIdentity> Companions::identity(const std::filesystem::path& path) const {
  const std::filesystem::path place = folder_ / path;
  if (files_.kind(place) != storage::FileKind::regular)
    return std::nullopt;
  return files_.identity(place);
}

bool Companions::has_appeared(const storage::InputNote& note) const {
  return std::ranges::any_of(note.awaited, [this](const auto& path) {
    return files_.kind(folder_ / path) == storage::FileKind::regular;
  });
}

std::uint64_t Companions::mark(const storage::InputNote& note) const {
  if (note.files.size() <= 1 && note.awaited.empty())
    return 0;
  std::vector<std::uint64_t> numbers{has_appeared(note) ? 1U : 0U};
  for (std::size_t i = 1; i < note.files.size(); ++i) {
    const auto now = identity(note.files[i].path).value_or(storage::FileIdentity{});
    numbers.insert(numbers.end(), {now.bytes, std::bit_cast<std::uint64_t>(now.modified_ns),
                                   std::bit_cast<std::uint64_t>(now.changed_ns)});
  }
  return storage::checksum(std::as_bytes(std::span(numbers)));
}

Companions::Comparison Companions::compare(storage::InputNote& note, bool may_read,
                                           const std::function<void()>& check) const {
  Comparison result{.is_same = !has_appeared(note)};
  for (std::size_t i = 1; i < note.files.size() && result.is_same; ++i) {
    storage::NotedFile& noted = note.files[i];
    const auto now = identity(noted.path);
    if (!now || is_untouched(*now, noted.identity))
      continue;
    result.is_same = may_read && now->bytes == noted.identity.bytes;
    if (!result.is_same)
      break;
    const auto file = files_.open(folder_ / noted.path);
    result.is_same = storage::FileChecksum(file->size()).complete(*file, check) == noted.checksum;
    result.was_read = true;
    noted.identity = *now;
  }
  return result;
}

}  // namespace meshhier::server
