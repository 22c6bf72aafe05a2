#include "pipeline/plan/disk_claims.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/neighbours.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <set>
#include <span>
#include <string>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;

/// Digits of the largest number of 64 bits: a claim replaces an older one as a whole.
constexpr std::size_t kClaimDigits = 20;

std::uint64_t read_claim(const fs::path& lock, storage::FileSystem& files) {
  std::string text(kClaimDigits, '\0');
  text.resize(files.open(lock)->read_at(0, std::as_writable_bytes(std::span(text))));
  std::uint64_t bytes = 0;
  std::from_chars(text.data(), text.data() + text.size(), bytes);
  return bytes;
}

/// Returns the bytes of a build's files; 0 if one may not be read.
std::uint64_t written_in(const fs::path& work, storage::FileSystem& files) {
  try {
    return storage::bytes_at(files, work);
  } catch (const Error&) {
    return 0;
  }
}

/// Returns what the build in a work directory will yet take; 0 if none is at work there.
std::uint64_t left_of_claim(const fs::path& work, storage::FileSystem& files) {
  try {
    const fs::path lock = storage::lock_path(work);
    if (!files.is_locked(lock))
      return 0;
    const std::uint64_t claimed = read_claim(lock, files), written = written_in(work, files);
    return files.is_locked(lock) ? claimed - std::min(claimed, written) : 0;
  } catch (const Error&) {  // it has just ended
    return 0;
  }
}

void write_claim(const fs::path& work, std::uint64_t bytes, storage::FileSystem& files,
                 storage::ScratchUse& use) {
  const std::string text = fmt::format("{:0{}}", bytes, kClaimDigits);
  files.reopen(storage::lock_path(work))->write_at(0, std::as_bytes(std::span(text)));
  use.add_written(text.size());
}

/// Returns the work directories of builds, perhaps stopped ones, on a file system: those in one
/// folder, and those that are at work elsewhere.
std::set<fs::path> works_beside(const fs::path& parent, storage::FileSystem& files) {
  std::set<fs::path> works;
  const auto add = [&](const fs::path& work) {
    const auto name = storage::leftover_name(work.filename().string());
    if (name && name->kind == storage::Leftover::build)
      works.insert(files.canonical(work));
  };
  try {
    if (files.can_list(parent)) {
      for (const fs::path& child : files.children(parent))
        add(child);
    }
  } catch (const storage::NotThere&) {  // a build that made it has given up
  }
  if (const auto* shared = dynamic_cast<const storage::SharedFileSystem*>(&files)) {
    for (const fs::path& lock : shared->locked_files(parent, "/" + storage::lock_path("").string()))
      add(lock.parent_path());
  }
  return works;
}

}  // namespace

void claim_disk(const fs::path& work, std::uint64_t bytes, storage::FileSystem& files,
                storage::ScratchUse& use, const std::function<void()>& check) {
  const storage::DeviceTurn turn(work);
  write_claim(work, bytes, files, use);
  try {
    check();
  } catch (...) {
    write_claim(work, 0, files, use);
    throw;
  }
}

std::uint64_t claimed_beside(const fs::path& output, storage::FileSystem& files) {
  const fs::path parent = storage::existing_directory(files, output);
  if (!files.is_directory(parent))
    return 0;
  std::set<fs::path> works = works_beside(parent, files);
  works.erase(files.canonical(storage::work_path(output)));
  std::uint64_t bytes = 0;
  for (const fs::path& work : works)  // what a file says may be anything
    bytes += std::min(left_of_claim(work, files), UINT64_MAX - bytes);
  return bytes;
}

}  // namespace meshhier::pipeline
