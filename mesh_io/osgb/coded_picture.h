// Pictures of OpenSceneGraph as files of pictures.
#pragma once

#include <string>

#include <osg/Image>

namespace meshhier::mesh_io::osgb {

/// Returns a picture as a file: as it came, if it lay there as one, but a DDS; else as a PNG, whose
/// first row is the last in memory: texture coordinates go up there. Empty if it has no texels.
/// Throws std::runtime_error if it has a format that is not read.
std::string coded_picture(const osg::Image& image);

/// Returns the first bytes of that file, which tell its size, or all of it if it is not made:
/// nothing is decoded. Empty and throws as coded_picture().
std::string picture_start(const osg::Image& image);

}  // namespace meshhier::mesh_io::osgb
