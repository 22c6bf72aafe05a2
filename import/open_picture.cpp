#include "import/open_picture.h"

#include "images/open_source.h"
#include "mesh_io/input_error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/part_of_file.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace meshhier::importing {

std::unique_ptr<images::ImageReader> open_picture(const images::ImageSource& source,
                                                  storage::FileSystem& files) {
  if (!source.is_packed)
    return images::open_source(source, files);
  const auto file = files.open(source.file);
  const auto stream = mesh_io::open_stream({*file, file->size()}, {});
  auto bytes = std::make_shared<std::vector<std::byte>>(source.bytes);
  if (mesh_io::skip(*stream, source.offset) < source.offset || stream->read(*bytes) < bytes->size())
    mesh_io::fail_file(source.file, "ends before its picture (truncated?)");
  return images::open_image(
      [bytes](std::uint64_t at, std::span<std::byte> into) {
        const std::size_t count =
            at < bytes->size() ? std::min<std::size_t>(bytes->size() - at, into.size()) : 0;
        std::copy_n(bytes->begin() + static_cast<std::ptrdiff_t>(at < bytes->size() ? at : 0),
                    count, into.begin());
        return count;
      },
      source.name);
}

}  // namespace meshhier::importing
