#include "import/gltf_picture_forms.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "import/open_picture.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace meshhier::importing {
namespace {

using mesh_io::GltfFile;
using mesh_io::GltfPicture;

struct FormHead {
  std::uint64_t texels = 0;  ///< 0: the picture is not there, or broken
  std::string missing{};     ///< as ImageReader::missing()
};

FormHead read_head(const GltfPicture& picture, const GltfFile& file) {
  if (!picture.is_there())
    return {};
  try {
    const images::ImageSource source = source_of(picture);
    const auto reader = open_picture(source, file.room().files);
    return {std::uint64_t{reader->info().width} * reader->info().height, reader->missing()};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input)
      throw;
    return {};
  }
}

[[noreturn]] void fail_missing(const GltfFile& file, const std::string& picture,
                               const std::string& missing) {
  constexpr std::size_t kLongest = 255;
  throw Error(ErrorCode::io, plain_text(file.path().string(), kLongest) + ": " + picture + ": " +
                                 missing +
                                 "; or leave pictures out with \"texture\": {\"use\": false}");
}

}  // namespace

images::ImageSource source_of(GltfPicture picture) {
  return {std::move(picture.name), picture.file.value_or(""), picture.offset,
          picture.bytes,           std::move(picture.data),   picture.is_packed};
}

GltfPicture best_picture(GltfFile& file, const mesh_io::GltfTexture& texture) {
  GltfPicture best = file.picture(texture.forms[0]);
  if (texture.forms.size() == 1 && !texture.has_ktx2)
    return best;
  FormHead head = read_head(best, file);
  for (std::size_t i = 1; i < texture.forms.size(); ++i) {
    GltfPicture form = file.picture(texture.forms[i]);
    FormHead other = read_head(form, file);
    if (other.texels <= head.texels && (best.is_there() || !form.is_there()))
      continue;
    best = std::move(form);
    head = std::move(other);
  }
  if (!head.missing.empty())
    fail_missing(file, best.name, head.missing);
  return best;
}

}  // namespace meshhier::importing
