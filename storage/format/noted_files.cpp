#include "storage/format/noted_files.h"

#include "storage/io/file_checksum.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

namespace meshhier::storage {

bool is_untouched(const FileIdentity& a, const FileIdentity& b) {
  return a == b && a.changed_ns == b.changed_ns;
}

std::optional<FileIdentity> NotedFiles::identity(const std::filesystem::path& path) const {
  const std::filesystem::path place = folder_ / path;
  if (files_.kind(place) != FileKind::regular)
    return std::nullopt;
  return files_.identity(place);
}

std::optional<std::filesystem::path> NotedFiles::appeared(const InputNote& note) const {
  const auto found = std::ranges::find_if(note.awaited, [this](const auto& path) {
    return files_.kind(folder_ / path) == FileKind::regular;
  });
  return found == note.awaited.end() ? std::nullopt : std::optional(*found);
}

std::uint64_t NotedFiles::mark(const InputNote& note) const {
  if (note.files.size() <= 1 && note.awaited.empty())
    return 0;
  std::vector<std::uint64_t> numbers{appeared(note) ? 1U : 0U};
  for (std::size_t i = 1; i < note.files.size(); ++i) {
    const auto now = identity(note.files[i].path).value_or(FileIdentity{});
    numbers.insert(numbers.end(), {now.bytes, std::bit_cast<std::uint64_t>(now.modified_ns),
                                   std::bit_cast<std::uint64_t>(now.changed_ns)});
  }
  return checksum(std::as_bytes(std::span(numbers)));
}

bool NotedFiles::has_content(const NotedFile& noted, const std::function<void()>& check) const {
  const auto file = files_.open(folder_ / noted.path);
  return FileChecksum(file->size()).complete(*file, check) == noted.checksum;
}

NotedFiles::Comparison NotedFiles::compare(InputNote& note, const Question& question,
                                           const std::function<void()>& check) const {
  Comparison result{.other = appeared(note)};
  for (std::size_t i = question.from; i < note.files.size() && !result.other; ++i) {
    NotedFile& noted = note.files[i];
    const auto now = identity(noted.path);
    if (now ? is_untouched(*now, noted.identity) : question.gone == Gone::is_same)
      continue;
    if (!now || !question.may_read || now->bytes != noted.identity.bytes ||
        !has_content(noted, check)) {
      result.other = noted.path;
    } else {
      result.was_read = true;
      noted.identity = *now;
    }
  }
  return result;
}

}  // namespace meshhier::storage
