// Encodes a whole picture by a writer of rows.
#pragma once

#include "images/image.h"
#include "images/row_writer.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::images {

/// `open(sink)` returns a RowWriter for a picture of this size.
template <class Open>
std::vector<std::byte> encode_rows(const Image& image, const Open& open) {
  std::vector<std::byte> file;
  const auto writer = open([&](std::span<const std::byte> bytes) {
    file.insert(file.end(), bytes.begin(), bytes.end());
  });
  for (std::uint32_t y = 0; y < image.height; ++y)
    writer->write_row(image.at(0, y));
  writer->finish();
  return file;
}

}  // namespace meshhier::images
