// Textures of glTF that have their picture in several forms, as JPEG and as KTX2.
#pragma once

#include "images/material_list.h"
#include "mesh_io/gltf_file.h"

namespace meshhier::importing {

images::ImageSource source_of(mesh_io::GltfPicture picture);

/// Returns the form that is shown, of a texture with one or more: the one with the most texels, as
/// a fallback for old viewers is often smaller; of equal ones the first, as pictures for graphics
/// devices lose the most (ETC1S 30 dB, a JPEG of quality 90 40 dB). A form that is missing or
/// broken yields to another one. Heads are read only if there is a choice, or a form in KTX2.
/// Throws Error(io) if this machine cannot decode the one that is shown, so that no other one makes
/// another hierarchy; as GltfFile::picture().
mesh_io::GltfPicture best_picture(mesh_io::GltfFile& file, const mesh_io::GltfTexture& texture);

}  // namespace meshhier::importing
