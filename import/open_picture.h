// Pictures that a mesh shows, wherever they lie.
#pragma once

#include "images/image_codec.h"
#include "images/material_list.h"
#include "storage/io/file.h"

#include <memory>

namespace meshhier::importing {

/// Opens a picture as images::open_image(); one within a file in gzip, or that is made of an
/// OSGB, is held in memory, still coded. Throws Error(input) if that file is damaged or does not
/// have it. Messages name the file, and the picture in it.
std::unique_ptr<images::ImageReader> open_picture(const images::ImageSource& source,
                                                  storage::FileSystem& files);

}  // namespace meshhier::importing
