#include "mesh_io/osgb/kept_scene.h"

#include <istream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include <osg/Notify>
#include <osgDB/Callbacks>
#include <osgDB/ReaderWriter>
#include <osgDB/Registry>

namespace meshhier::mesh_io::osgb {
namespace {

using Result = osgDB::ReaderWriter::ReadResult;

/// Takes pictures of all formats within an OSGB.
class PictureKeeper : public osgDB::ReaderWriter {
 public:
  bool acceptsExtension(const std::string& /*ending*/) const override { return true; }
  Result readImage(std::istream& stream, const Options* /*options*/) const override {
    osg::ref_ptr<KeptImage> image = new KeptImage;
    image->bytes.assign(std::istreambuf_iterator<char>(stream), {});
    return image.get();
  }
};

/// Stands for files elsewhere: pictures by their names, nothing for all others.
class Elsewhere : public osgDB::ReadFileCallback {
 public:
  Result readImage(const std::string& name, const osgDB::Options* /*options*/) override {
    osg::ref_ptr<KeptImage> image = new KeptImage;
    image->name = name;
    return image.get();
  }
  Result openArchive(const std::string&, osgDB::ReaderWriter::ArchiveStatus, unsigned,
                     const osgDB::Options*) override {
    return Result::FILE_NOT_FOUND;
  }
  Result readObject(const std::string&, const osgDB::Options*) override {
    return Result::FILE_NOT_FOUND;
  }
  Result readHeightField(const std::string&, const osgDB::Options*) override {
    return Result::FILE_NOT_FOUND;
  }
  Result readNode(const std::string&, const osgDB::Options*) override {
    return Result::FILE_NOT_FOUND;
  }
  Result readShader(const std::string&, const osgDB::Options*) override {
    return Result::FILE_NOT_FOUND;
  }
};

/// Counts the parts that the library tells to be unknown.
class Warnings : public osg::NotifyHandler {
 public:
  void notify(osg::NotifySeverity /*severity*/, const char* message) override {
    if (std::string_view(message).find("Unsupported wrapper class") != std::string_view::npos)
      ++unknown;
  }
  std::size_t unknown = 0;
};

Warnings* warnings = nullptr;
const osgDB::ReaderWriter* scene_reader = nullptr;
const osgDB::ReaderWriter* dds_reader = nullptr;

}  // namespace

void prepare_reading() {
  warnings = new Warnings;
  osg::setNotifyLevel(osg::WARN);
  osg::setNotifyHandler(warnings);
  osgDB::Registry& registry = *osgDB::Registry::instance();
  scene_reader = registry.getReaderWriterForExtension("osgb");
  dds_reader = registry.getReaderWriterForExtension("dds");
  if (scene_reader == nullptr)
    throw std::runtime_error("OpenSceneGraph has no plug-in for OSGB");
  // The wrappers of nodes are loaded when the first one is looked for.
  if (registry.getObjectWrapperManager()->findWrapper("osg::Geometry") == nullptr)
    throw std::runtime_error("OpenSceneGraph has no plug-in for nodes in OSGB");
  registry.addReaderWriter(new PictureKeeper);
  registry.setReadFileCallback(new Elsewhere);
}

KeptScene read_scene(std::span<const std::byte> file) {
  warnings->unknown = 0;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(file.data()), file.size()));
  Result result = scene_reader->readNode(stream, nullptr);
  if (!result.validNode()) {
    throw std::runtime_error(result.message().empty() ? "it holds no scene"
                                                      : "broken: " + result.message());
  }
  return {result.getNode(), warnings->unknown};
}

osg::ref_ptr<osg::Image> decode_dds(const std::string& bytes) {
  if (dds_reader == nullptr || !bytes.starts_with("DDS "))
    return nullptr;
  std::istringstream stream(bytes);
  Result result = dds_reader->readImage(stream, nullptr);
  return result.validImage() ? result.getImage() : nullptr;
}

}  // namespace meshhier::mesh_io::osgb
