#include "pipeline/plan/disk_claims.h"

#include "base/error.h"
#include "storage/format/layout.h"

#include <algorithm>
#include <charconv>
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

/// Returns what the build in a work directory will yet take; 0 if none is at work there.
std::uint64_t left_of_claim(const fs::path& work, storage::FileSystem& files) {
  try {
    const fs::path lock = storage::lock_path(work);
    if (!files.exists(lock) || files.try_lock(lock) != nullptr)
      return 0;
    const std::uint64_t claimed = read_claim(lock, files);
    return claimed - std::min(claimed, storage::bytes_below(files, work));
  } catch (const Error&) {  // it has just ended
    return 0;
  }
}

}  // namespace

void claim_disk(const fs::path& work, std::uint64_t bytes, storage::FileSystem& files,
                storage::ScratchUse& use) {
  const std::string text = fmt::format("{:0{}}", bytes, kClaimDigits);
  files.reopen(storage::lock_path(work))->write_at(0, std::as_bytes(std::span(text)));
  use.add_written(text.size());
}

std::uint64_t claimed_beside(const fs::path& output, storage::FileSystem& files) {
  const fs::path parent = output.parent_path().empty() ? "." : output.parent_path();
  if (!files.is_directory(parent))
    return 0;
  std::uint64_t bytes = 0;
  for (const fs::path& child : files.children(parent)) {
    const auto name = storage::leftover_name(child.filename().string());
    if (name && name->kind == storage::Leftover::build && name->output != output.filename())
      bytes += left_of_claim(child, files);
  }
  return bytes;
}

}  // namespace meshhier::pipeline
