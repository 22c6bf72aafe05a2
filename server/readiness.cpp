#include "server/readiness.h"

#include "base/error.h"
#include "execution/size_text.h"

#include <fmt/format.h>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;

/// A server shows the folder that it opened when it began, whatever takes its place.
std::string why_not_shown(const storage::Folder& folder) {
  try {
    folder.entries("");
    return folder.is_in_place() ? ""
                                : "it is not the one that was there at the start: start the server "
                                  "again";
  } catch (const Error&) {
    return "it cannot be listed";
  }
}

std::string why_not_readable(const fs::path& folder, storage::FileSystem& files) {
  try {
    files.children(folder);
    return {};
  } catch (const Error&) {
    return "it cannot be listed";
  }
}

std::string why_not_writable(const fs::path& folder, storage::FileSystem& files) {
  const std::string cause = files.why_not_writable(folder);
  return cause.empty() ? cause : "nothing can be written into it: " + cause;
}

std::string first_of(std::string reason, const std::string& next) {
  return reason.empty() ? next : reason;
}

Check check_disk(const ReadinessOptions& options, storage::FileSystem& files) {
  const auto why_low = [&](const fs::path& folder) {
    return why_below_floor(folder, options.disk_floor, 0, files);
  };
  try {
    const std::string reason = why_low(options.folder->path());
    return {"disk", options.takes_uploads ? first_of(reason, why_low(options.inbox)) : reason};
  } catch (const Error&) {
    return {"disk", "it does not tell what is free"};
  }
}

}  // namespace

std::string why_below_floor(const fs::path& folder, std::uint64_t floor, std::uint64_t more,
                            storage::FileSystem& files) {
  const std::uint64_t free = files.free_bytes(folder);
  if (free >= floor && free - floor >= more)
    return "";
  return fmt::format("{} are free, and {} must stay free (--disk-floor)",
                     execution::rounded_size_text(free), execution::exact_size_text(floor));
}

std::vector<Check> check_readiness(const ReadinessOptions& options, storage::FileSystem& files) {
  Check folder{"folder", why_not_shown(*options.folder)};
  if (options.inbox.empty())
    return {folder};
  folder.reason = first_of(folder.reason, why_not_writable(options.folder->path(), files));
  Check inbox{"inbox", why_not_readable(options.inbox, files)};
  if (options.takes_uploads)
    inbox.reason = first_of(inbox.reason, why_not_writable(options.inbox, files));
  return {folder, inbox, check_disk(options, files)};
}

}  // namespace meshhier::server
