#include "render/png.h"

#include "hierarchy/error.h"

#include <string>

#include <png.h>

namespace meshhier::render {

std::vector<std::byte> encode_png(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = picture.width;
  image.height = picture.height;
  image.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::byte> bytes(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgba.data(), 0, nullptr) ==
      0)
    throw Error(ErrorCode::internal, std::string("libpng: ") + image.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace meshhier::render
