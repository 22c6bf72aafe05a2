// The plan of a build for the pictures of its input, made from their heads.
#pragma once

#include "base/error.h"
#include "config/config.h"
#include "images/image_codec.h"
#include "images/material_list.h"
#include "storage/io/file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::pipeline {

struct TexturePlan {
  images::MaterialList materials;                 ///< empty: no textures
  std::vector<images::ImageInfo> heads;           ///< one for each picture in `materials`
  std::vector<std::string> broken;                ///< why pictures are left out, a sentence each
  std::vector<storage::FileIdentity> identities;  ///< one for each picture's file

  bool is_textured() const { return !materials.empty(); }
  std::uint64_t texels() const;
  /// Returns the bytes of scratch space that all pictures take, decoded.
  std::uint64_t stored_bytes() const;
  /// Returns the most memory that decoding one of them holds.
  std::uint64_t decoder_bytes() const;
  /// Returns the most memory that storing one of them holds besides.
  std::uint64_t adding_bytes() const;
  /// Throws Error(input) if the picture's file is not what it was.
  void check_unchanged(std::size_t image, storage::FileSystem& files) const;
};

/// Leaves a picture out: its materials show their colours.
void leave_out(std::uint32_t image, images::MaterialList& materials);

/// Returns the same failure, with what can be done about it.
Error with_picture_hint(const Error& broken);

/// Looks at the heads of all pictures. One that is broken is left out with `missing_images` ignore;
/// else throws Error(input) that names it.
TexturePlan plan_textures(images::MaterialList materials, config::MissingImages missing,
                          storage::FileSystem& files);

}  // namespace meshhier::pipeline
