// A scene of OpenSceneGraph from bytes in memory, which reads nothing else: pictures in it stay as
// they are coded, and other files stay names.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <osg/Image>
#include <osg/Node>
#include <osg/ref_ptr>

namespace meshhier::mesh_io::osgb {

/// A picture that was not decoded.
class KeptImage : public osg::Image {
 public:
  std::string bytes;  ///< its file, as it lies in the OSGB; empty: it lies elsewhere
  std::string name;   ///< of the file elsewhere
};

/// Loads the parts of the library that reading takes. To be called once, first. Throws
/// std::runtime_error if they are not there.
void prepare_reading();

struct KeptScene {
  osg::ref_ptr<osg::Node> root;
  std::size_t unknown = 0;  ///< parts of kinds that the library does not know, which are not there
};

/// Returns the scene of an OSGB file. Throws std::runtime_error if it is none, and what the library
/// throws.
KeptScene read_scene(std::span<const std::byte> file);

/// Decodes a DDS. Returns null if it is none.
osg::ref_ptr<osg::Image> decode_dds(const std::string& bytes);

}  // namespace meshhier::mesh_io::osgb
