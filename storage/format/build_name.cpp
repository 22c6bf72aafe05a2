#include "storage/format/build_name.h"

#include "storage/format/load_manifest.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

namespace meshhier::storage {
namespace {

/// The end of a sealed text, behind the digits.
constexpr std::string_view kBehindName = "\"\n}\n";
constexpr std::size_t kNameDigits = 16;

/// Returns the manifest that is there now; nothing if none can be read.
std::optional<Manifest> manifest_now(FileSystem& files, const std::filesystem::path& hierarchy) {
  try {
    return load_manifest(files, hierarchy);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::corrupt && error.code() != ErrorCode::io)
      throw;
    return std::nullopt;
  }
}

/// Whether all files but the manifest are the same.
bool is_same_build(const Manifest& a, const Manifest& b) {
  const auto sums = [](const Manifest& manifest) {
    return std::tuple(manifest.index_checksum, manifest.outline_checksum, manifest.tileset_checksum,
                      manifest.preview ? manifest.preview->checksum : 0);
  };
  return sums(a) == sums(b);
}

}  // namespace

std::string build_name(const std::string& manifest_text) {
  const std::size_t behind = kBehindName.size() + kNameDigits;
  return manifest_text.substr(manifest_text.size() - std::min(behind, manifest_text.size()),
                              kNameDigits);
}

Replaced::Replaced(const std::filesystem::path& hierarchy)
    : Error(ErrorCode::io,
            fmt::format("{}: another hierarchy has taken its place while it was read; nothing is "
                        "made of the two: run the command again",
                        hierarchy.string())) {}

void require_same_build(FileSystem& files, const std::filesystem::path& hierarchy,
                        const Manifest& opened) {
  const std::optional<Manifest> now = manifest_now(files, hierarchy);
  if (now && !is_same_build(*now, opened))
    throw Replaced(hierarchy);
}

}  // namespace meshhier::storage
