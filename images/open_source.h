// Opens pictures at the places that a material list gives.
#pragma once

#include "images/image_codec.h"
#include "images/material_list.h"
#include "storage/io/file.h"

#include <memory>

namespace meshhier::images {

/// Opens a picture; `source` must outlive the reader if it holds the bytes. Throws as open_image(),
/// Error(io).
std::unique_ptr<ImageReader> open_source(const ImageSource& source, storage::FileSystem& files);

}  // namespace meshhier::images
