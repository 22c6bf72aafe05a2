// meshhier_osgb_maker: makes a folder of OSGB tiles from a mesh, by OpenSceneGraph, as programs of
// photogrammetry write it: for tests.
//
//   OUT/metadata.xml
//      /Data/Tile_+000_+001/Tile_+000_+001.osgb       a node for each quarter: every 4th triangle
//      of
//                                                     it, and as the finer one Tile_…_L1_0.osgb
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <osg/Geode>
#include <osg/Geometry>
#include <osg/Image>
#include <osg/NodeVisitor>
#include <osg/PagedLOD>
#include <osg/Texture2D>
#include <osg/TriangleIndexFunctor>
#include <osgDB/Options>
#include <osgDB/ReadFile>
#include <osgDB/WriteFile>

namespace meshhier {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string input, output;
  unsigned tiles = 1;   ///< along each side
  unsigned levels = 1;  ///< of files below a tile's first one
  std::string pictures = "file";
  std::string compressor;
  std::string srs = "EPSG:32633", origin = "500000,5300000,0";
  bool by_distance = false;
};

/// A surface of one look.
struct Surface {
  osg::ref_ptr<osg::StateSet> state;
  osg::ref_ptr<osg::Vec3Array> positions, normals;
  osg::ref_ptr<osg::Vec2Array> texcoords;
  std::vector<std::array<unsigned, 3>> triangles;
};

struct TriangleList {
  std::vector<std::array<unsigned, 3>> triangles;
  void operator()(unsigned a, unsigned b, unsigned c) { triangles.push_back({a, b, c}); }
};

class SurfaceFinder : public osg::NodeVisitor {
 public:
  SurfaceFinder() : osg::NodeVisitor(TRAVERSE_ALL_CHILDREN) {}
  void apply(osg::Geometry& geometry) override {
    osg::TriangleIndexFunctor<TriangleList> list;
    geometry.accept(list);
    Surface surface;
    surface.state = geometry.getOrCreateStateSet();
    surface.positions = dynamic_cast<osg::Vec3Array*>(geometry.getVertexArray());
    surface.normals = dynamic_cast<osg::Vec3Array*>(geometry.getNormalArray());
    surface.texcoords = dynamic_cast<osg::Vec2Array*>(geometry.getTexCoordArray(0));
    surface.triangles = std::move(list.triangles);
    if (surface.positions)
      found.push_back(std::move(surface));
  }
  std::vector<Surface> found;
};

/// Triangles of all surfaces.
using Selection = std::vector<std::vector<std::size_t>>;

std::size_t count_of(const Selection& selection) {
  std::size_t count = 0;
  for (const auto& part : selection)
    count += part.size();
  return count;
}

/// A rectangle of the plane.
struct Cell {
  double x0, y0, x1, y1;
  Cell part(unsigned column, unsigned row, unsigned side) const {
    const auto at = [side](double from, double to, unsigned i) {
      return i == side ? to : from + (to - from) / side * i;
    };
    return {at(x0, x1, column), at(y0, y1, row), at(x0, x1, column + 1), at(y0, y1, row + 1)};
  }
};

class Maker {
 public:
  explicit Maker(const Arguments& arguments) : arguments_(arguments) {
    const osg::ref_ptr<osgDB::Options> options =
        new osgDB::Options("noRotation noTriStripPolygons noTesselateLargePolygons");
    const osg::ref_ptr<osg::Node> scene = osgDB::readRefNodeFile(arguments.input, options.get());
    if (!scene)
      throw std::runtime_error(arguments.input + " cannot be read");
    SurfaceFinder finder;
    scene->accept(finder);
    surfaces_ = std::move(finder.found);
    prepare_pictures();
    std::string written = arguments.compressor.empty() ? "" : "Compressor=" + arguments.compressor;
    written += arguments.pictures == "file"       ? " WriteImageHint=IncludeFile"
               : arguments.pictures == "external" ? " WriteImageHint=UseExternal"
                                                  : " WriteImageHint=IncludeData";
    write_options_ = new osgDB::Options(written);
  }

  void run() {
    osg::BoundingBox box;
    Selection all(surfaces_.size());
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      for (const osg::Vec3& position : *surfaces_[s].positions)
        box.expandBy(position);
      for (std::size_t t = 0; t < surfaces_[s].triangles.size(); ++t)
        all[s].push_back(t);
    }
    const Cell whole{box.xMin(), box.yMin(), box.xMax(), box.yMax()};
    for (unsigned row = 0; row < arguments_.tiles; ++row) {
      for (unsigned column = 0; column < arguments_.tiles; ++column)
        make_tile(column, row, whole, all);
    }
    fs::create_directories(arguments_.output);
    std::ofstream(fs::path(arguments_.output) / "metadata.xml")
        << "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<ModelMetadata version=\"1\">\n\t<SRS>"
        << arguments_.srs << "</SRS>\n\t<SRSOrigin>" << arguments_.origin
        << "</SRSOrigin>\n</ModelMetadata>\n";
  }

 private:
  void make_tile(unsigned column, unsigned row, const Cell& whole, const Selection& all) {
    const Cell cell = whole.part(column, row, arguments_.tiles);
    const Selection own = part_of(all, cell, whole);
    if (count_of(own) == 0)
      return;
    stem_ = fmt::format("Tile_+{:03}_+{:03}", column, row);
    folder_ = fs::path(arguments_.output) / "Data" / stem_;
    fs::create_directories(folder_);
    numbers_.clear();
    write_file(stem_ + ".osgb", cell, own, 0);
  }

  /// Writes a file of a level; the finest has all of its triangles.
  void write_file(const std::string& name, const Cell& cell, const Selection& own, unsigned level) {
    osg::ref_ptr<osg::Group> group = new osg::Group;
    if (level == arguments_.levels) {
      group->addChild(geometry_of(own, 1).get());
    } else {
      for (unsigned quarter = 0; quarter < 4; ++quarter) {
        const Cell part = cell.part(quarter % 2, quarter / 2, 2);
        const Selection inner = part_of(own, part, cell);
        if (count_of(inner) > 0)
          group->addChild(paged(part, inner, level).get());
      }
    }
    if (!osgDB::writeNodeFile(*group, (folder_ / name).string(), write_options_.get()))
      throw std::runtime_error(name + " cannot be written");
  }

  osg::ref_ptr<osg::PagedLOD> paged(const Cell& cell, const Selection& own, unsigned level) {
    constexpr float kChange = 100, kFar = 1e30F;
    const std::string name = fmt::format("{}_L{}_{}.osgb", stem_, level + 1, numbers_[level + 1]++);
    osg::ref_ptr<osg::PagedLOD> lod = new osg::PagedLOD;
    lod->setRangeMode(arguments_.by_distance ? osg::LOD::DISTANCE_FROM_EYE_POINT
                                             : osg::LOD::PIXEL_SIZE_ON_SCREEN);
    lod->addChild(geometry_of(own, std::size_t{1} << 2 * (arguments_.levels - level)).get());
    lod->setRange(0, arguments_.by_distance ? kChange : 0, arguments_.by_distance ? kFar : kChange);
    lod->setFileName(0, "");
    lod->setFileName(1, name);
    lod->setRange(1, arguments_.by_distance ? 0 : kChange, arguments_.by_distance ? kChange : kFar);
    write_file(name, cell, own, level + 1);
    return lod;
  }

  /// Returns the triangles whose middle lies in a cell; those at its far sides belong to it where
  /// it ends with `around`.
  Selection part_of(const Selection& from, const Cell& cell, const Cell& around) const {
    const auto is_in = [](double x, double from_x, double to, double end) {
      return x >= from_x && (x < to || to >= end);
    };
    Selection part(from.size());
    for (std::size_t s = 0; s < from.size(); ++s) {
      for (const std::size_t t : from[s]) {
        const auto& [a, b, c] = surfaces_[s].triangles[t];
        const osg::Vec3Array& p = *surfaces_[s].positions;
        const osg::Vec3 middle = (p[a] + p[b] + p[c]) / 3;
        if (is_in(middle.x(), cell.x0, cell.x1, around.x1) &&
            is_in(middle.y(), cell.y0, cell.y1, around.y1))
          part[s].push_back(t);
      }
    }
    return part;
  }

  /// Returns each `step`th triangle.
  osg::ref_ptr<osg::Geode> geometry_of(const Selection& selection, std::size_t step) const {
    osg::ref_ptr<osg::Geode> geode = new osg::Geode;
    for (std::size_t s = 0; s < selection.size(); ++s) {
      if (selection[s].empty())
        continue;
      const Surface& surface = surfaces_[s];
      osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
      osg::ref_ptr<osg::Vec3Array> positions = new osg::Vec3Array, normals = new osg::Vec3Array;
      osg::ref_ptr<osg::Vec2Array> texcoords = new osg::Vec2Array;
      osg::ref_ptr<osg::DrawElementsUInt> corners = new osg::DrawElementsUInt(GL_TRIANGLES);
      std::map<unsigned, unsigned> known;
      for (std::size_t i = 0; i < selection[s].size(); i += step) {
        for (const unsigned corner : surface.triangles[selection[s][i]]) {
          const auto [found, is_new] = known.emplace(corner, known.size());
          corners->push_back(found->second);
          if (!is_new)
            continue;
          positions->push_back((*surface.positions)[corner]);
          if (surface.normals)
            normals->push_back((*surface.normals)[corner]);
          if (surface.texcoords)
            texcoords->push_back((*surface.texcoords)[corner]);
        }
      }
      geometry->setVertexArray(positions.get());
      if (surface.normals)
        geometry->setNormalArray(normals.get(), osg::Array::BIND_PER_VERTEX);
      if (surface.texcoords)
        geometry->setTexCoordArray(0, texcoords.get());
      geometry->addPrimitiveSet(corners.get());
      geometry->setStateSet(surface.state.get());
      geode->addDrawable(geometry.get());
    }
    return geode;
  }

  void prepare_pictures() {
    for (const Surface& surface : surfaces_) {
      auto* const texture = dynamic_cast<osg::Texture2D*>(
          surface.state->getTextureAttribute(0, osg::StateAttribute::TEXTURE));
      if (texture == nullptr || texture->getImage() == nullptr)
        continue;
      texture->setUnRefImageDataAfterApply(false);
      if (arguments_.pictures == "dxt")
        texture->setImage(as_dxt1(*texture->getImage()).get());
    }
  }

  /// Codes a picture as DXT1: the ends of a block's colours are the darkest and the brightest.
  static osg::ref_ptr<osg::Image> as_dxt1(const osg::Image& image) {
    const int width = image.s() / 4 * 4, height = image.t() / 4 * 4;
    auto* bytes = new unsigned char[static_cast<std::size_t>(width) * height / 2];
    unsigned char* to = bytes;
    for (int y = 0; y < height; y += 4) {
      for (int x = 0; x < width; x += 4)
        to = code_block(image, x, y, to);
    }
    osg::ref_ptr<osg::Image> coded = new osg::Image;
    coded->setImage(width, height, 1, GL_COMPRESSED_RGB_S3TC_DXT1_EXT,
                    GL_COMPRESSED_RGB_S3TC_DXT1_EXT, GL_UNSIGNED_BYTE, bytes,
                    osg::Image::USE_NEW_DELETE);
    coded->setFileName(image.getFileName());
    return coded;
  }

  static unsigned short packed(const osg::Vec4& colour) {
    const auto bits = [&](int k, int most) {
      return static_cast<int>(colour[k] * static_cast<float>(most) + 0.5F);
    };
    return static_cast<unsigned short>(bits(0, 31) << 11 | bits(1, 63) << 5 | bits(2, 31));
  }

  static unsigned char* code_block(const osg::Image& image, int x, int y, unsigned char* to) {
    std::array<osg::Vec4, 16> colours;
    for (int i = 0; i < 16; ++i)
      colours[i] =
          image.getColor(static_cast<unsigned>(x + i % 4), static_cast<unsigned>(y + i / 4));
    const auto light = [](const osg::Vec4& c) { return c[0] + 2 * c[1] + c[2]; };
    const auto [dark, bright] = std::ranges::minmax_element(colours, {}, light);
    unsigned short first = packed(*bright), second = packed(*dark);
    if (first < second)
      std::swap(first, second);
    const float from = light(*dark), range = std::max(light(*bright) - from, 1e-6F);
    std::uint32_t numbers = 0;
    constexpr std::array<std::uint32_t, 4> kOrder{1, 3, 2, 0};  // from dark to bright
    for (int i = 0; first > second && i < 16; ++i) {
      const auto step = static_cast<std::size_t>((light(colours[i]) - from) / range * 3 + 0.5F);
      numbers |= kOrder[std::min<std::size_t>(step, 3)] << 2 * i;
    }
    for (const std::uint32_t value :
         {std::uint32_t{first} | std::uint32_t{second} << 16, numbers}) {
      for (int k = 0; k < 4; ++k)
        *to++ = static_cast<unsigned char>(value >> 8 * k);
    }
    return to;
  }

  const Arguments& arguments_;
  std::vector<Surface> surfaces_;
  osg::ref_ptr<osgDB::Options> write_options_;
  std::string stem_;
  fs::path folder_;
  std::map<unsigned, unsigned> numbers_;
};

}  // namespace
}  // namespace meshhier

int main(int argc, char** argv) {
  meshhier::Arguments arguments;
  CLI::App parser("Makes a folder of OSGB tiles from a mesh");
  parser.add_option("MESH", arguments.input, "What OpenSceneGraph reads, as OBJ or PLY")
      ->required();
  parser.add_option("-o,--output", arguments.output, "The folder to make")->required();
  parser.add_option("--tiles", arguments.tiles, "Tiles along each side");
  parser.add_option("--levels", arguments.levels, "Levels of files below the first one of a tile");
  parser.add_option("--pictures", arguments.pictures, "How they lie in the files")
      ->check(CLI::IsMember({"file", "data", "dxt", "external"}));
  parser.add_option("--compressor", arguments.compressor, "zlib packs files");
  parser.add_option("--srs", arguments.srs, "The map, for metadata.xml");
  parser.add_option("--origin", arguments.origin, "The offset to it");
  parser.add_flag("--distance", arguments.by_distance, "Ranges are distances, not sizes in pixels");
  CLI11_PARSE(parser, argc, argv);
  try {
    meshhier::Maker(arguments).run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "meshhier_osgb_maker: %s\n", error.what());
    return 1;
  }
  return 0;
}
