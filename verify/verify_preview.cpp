#include "base/error.h"
#include "base/plain_text.h"
#include "images/image_codec.h"
#include "storage/format/layout.h"
#include "verify/verify_parts.h"

#include <cstddef>
#include <span>
#include <string>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

/// Throws Error(corrupt) unless it is the picture that the manifest tells of.
void check_picture(std::span<const std::byte> bytes, const storage::Preview& told,
                   const std::string& name) {
  constexpr std::uint64_t kMostTexels =
      std::uint64_t{storage::kMostPreviewSide} * storage::kMostPreviewSide;
  const images::Image picture = images::decode_image(bytes, name, kMostTexels);
  if (picture.width != told.width || picture.height != told.height) {
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: {} x {} pixels, the manifest says {} x {}", name, picture.width,
                            picture.height, told.width, told.height));
  }
}

}  // namespace

void verify_preview(const VerifyJob& job) {
  const auto& told = job.reader.manifest().preview;
  if (!told)
    return;
  try {
    const std::string name = storage::preview_path(job.reader.directory()).string();
    check_picture(job.reader.read_preview(), *told, name);
    job.checks.push_back(fmt::format("preview: {}, {} x {} pixels", counted(told->bytes, "bytes"),
                                     told->width, told->height));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted)
      throw;
    job.problems.add(error.what());
  }
}

}  // namespace meshhier::verifying
