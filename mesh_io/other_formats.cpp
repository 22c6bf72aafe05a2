#include "mesh_io/other_formats.h"

#include "base/small_letters.h"
#include "base/text_mark.h"
#include "hierarchy/image_format.h"
#include "mesh_io/formats.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace meshhier::mesh_io {
namespace {

using namespace std::string_view_literals;

/// A mark that a file is known by: bytes at a place, or a word in the first part of a text that
/// begins in some way.
struct Mark {
  std::string_view bytes;
  std::size_t offset = 0;
  std::string_view begins{};  ///< the text; empty: `bytes` stand at `offset`
};

struct OtherFormat {
  std::string_view name;
  std::string_view advice{};
  std::vector<std::string_view> endings{};
  std::vector<Mark> marks{};
  bool is_picture = false;
};

constexpr std::string_view kUnpack = "unpack it, and build the mesh in it";
constexpr std::string_view kUnzip = "unpack it (`unzip FILE`), and build the mesh in it";
constexpr std::string_view kExport = "export it as glTF, OBJ or PLY from the program that made it";
constexpr std::string_view kTriangulate =
    "make a mesh of its points first, as by Poisson reconstruction";
constexpr std::string_view kTileset = "build the tileset.json that lists it";
constexpr std::string_view kHierarchy =
    "it is part of what a build makes: `meshhier inspect` and `serve` take its directory";
constexpr std::string_view kOfMesh = "give the mesh that it belongs to";
constexpr std::string_view kPicture =
    "give the mesh that it belongs to, or if its values are heights, what `gdal_translate FILE "
    "heights.tif` makes of it";
constexpr std::string_view kRaster = "give what `gdal_translate FILE heights.tif` makes of it";

/// A file is of the first row with a mark in its bytes, else of the first one with a word in it.
std::vector<OtherFormat> make_others() {
  return {
      {"a zip archive (perhaps 3MF, USDZ or KMZ; a tileset in one is read if its name ends in "
       ".3tz)",
       kUnzip,
       {".zip", ".3mf", ".usdz"},
       {{"PK\x03\x04"sv}}},
      {"a database of SQLite (perhaps a tileset, .3dtiles)",
       "unpack that by `npx 3d-tiles-tools convert -i NAME.3dtiles -o FOLDER`, and build its "
       "tileset.json",
       {".3dtiles"},
       {{"SQLite format 3\0"sv}}},
      {"a zip archive without files", "nothing is in it", {}, {{"PK\x05\x06"sv}}},
      {"a 7z archive", kUnpack, {".7z"}, {{"7z\xBC\xAF\x27\x1C"sv}}},
      {"a RAR archive", kUnpack, {".rar"}, {{"Rar!\x1A\x07"sv}}},
      {"a tar archive", kUnpack, {".tar", ".tgz"}, {{"ustar"sv, 257}}},
      {"a file in gzip", {}, {".gz"}},
      {"a file in bzip2", kUnpack, {".bz2"}, {{"BZh"sv}}},
      {"a file in xz",
       kUnpack,
       {".xz"},
       {{"\xFD"
         "7zXZ\0"sv}}},
      {"a file in zstd", kUnpack, {".zst"}, {{"\x28\xB5\x2F\xFD"sv}}},
      {"a file in LZ4", kUnpack, {}, {{"\x04\x22\x4D\x18"sv}}},
      {"an FBX file", kExport, {".fbx"}, {{"Kaydara FBX Binary"sv}, {"; FBX"sv}}},
      {"a Blender file", kExport, {".blend"}, {{"BLENDER"sv}}},
      {"a USD file", kExport, {".usd", ".usda", ".usdc"}, {{"PXR-USDC"sv}, {"#usda"sv}}},
      {"an Alembic file", kExport, {".abc"}, {{"Ogawa"sv}}},
      {"a VRML file", kExport, {".wrl"}, {{"#VRML"sv}}},
      {"an X3D file", kExport, {".x3d"}, {{"#X3D"sv}, {"<X3D"sv, 0, "<"}}},
      {"a STEP file", kExport, {".step", ".stp"}, {{"ISO-10303-21"sv}}},
      {"a Rhino file", kExport, {}, {{"3D Geometry File Format"sv}}},
      {"a SketchUp file", kExport, {}, {{"\xFF\xFE\xFF\x0ES\0k\0e\0t\0c\0h\0U\0p\0"sv}}},
      {"a compound document, as of Revit, SolidWorks or 3ds Max",
       kExport,
       {},
       {{"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv}}},
      {"a 3DS file", {}, {".3ds"}},
      {"a DWG drawing", kExport, {}, {{"AC10"sv}}},
      {"a DXF drawing",
       kExport,
       {".dxf"},
       {{"AutoCAD Binary DXF"sv}, {"SECTION"sv, 0, "0"}, {"SECTION"sv, 0, "999"}}},
      {"a Draco mesh", "put it into a glTF (KHR_draco_mesh_compression)", {".drc"}, {{"DRACO"sv}}},
      {"an OpenCTM mesh", kExport, {".ctm"}, {{"OCTM"sv}}},
      {"a VTK file", kExport, {".vtk"}, {{"# vtk DataFile"sv}, {"<VTKFile"sv, 0, "<"}}},
      {"a Gmsh mesh", kExport, {}, {{"$MeshFormat"sv}}},
      {"a Collada file", kExport, {".dae"}, {{"<COLLADA"sv, 0, "<"}}},
      {"a LandXML file", kExport, {}, {{"<LandXML"sv, 0, "<"}}},
      {"a CityGML file", kExport, {}, {{"CityModel"sv, 0, "<"}}},
      {"a CityJSON file", kExport, {}, {{"\"CityJSON\""sv, 0, "{"}}},
      {"a GeoJSON file", kExport, {}, {{"\"FeatureCollection\""sv, 0, "{"}}},
      {"a KML file", "give the mesh that it places", {}, {{"<kml"sv, 0, "<"}}},
      {"metadata of a model",
       "give it as `placement.metadata`, and the mesh as the input",
       {},
       {{"<ModelMetadata"sv, 0, "<"}}},
      {"a point cloud (LAS or LAZ)", kTriangulate, {".las", ".laz"}, {{"LASF"sv}}},
      {"a point cloud (E57)", kTriangulate, {".e57"}, {{"ASTM-E57"sv}}},
      {"a point cloud (PCD)", kTriangulate, {".pcd"}, {{"# .PCD"sv}}},
      {"a tile of 3D Tiles", kTileset, {".b3dm"}, {{"b3dm"sv}, {"i3dm"sv}, {"cmpt"sv}}},
      {"a tile of 3D Tiles with points", kTriangulate, {}, {{"pnts"sv}}},
      {"the index of a hierarchy", kHierarchy, {}, {{"MHTILES\n"sv}}},
      {"a file of a progressive stream", kHierarchy, {}, {{"MHDETAIL"sv}}},
      {"the manifest of a hierarchy", kHierarchy, {}, {{"\"format\": \"meshhier"sv, 0, "{"}}},
      {"a hierarchy", {}, {".hier", ".3tz"}},
      {"a PNG picture, damaged as by a transfer as text", kOfMesh, {}, {{"\x89PNG"sv}}, true},
      {"a TIFF in gzip",
       kUnpack,
       {".tif", ".tiff"},
       {{"II*\0"sv}, {"MM\0*"sv}, {"II+\0"sv}, {"MM\0+"sv}},
       true},
      {"a text grid in gzip", kUnpack, {}, {{"ncols"sv}, {"NCOLS"sv}, {"nrows"sv}, {"NROWS"sv}}},
      {"a raster of ERDAS", kRaster, {".img"}, {{"EHFA_HEADER_TAG"sv}}},
      {"a raster of GDAL (VRT)", kRaster, {".vrt"}, {{"<VRTDataset"sv, 0, "<"}}},
      {"a raster in netCDF", kRaster, {".nc"}, {{"CDF\x01"sv}, {"CDF\x02"sv}}},
      {"a file in HDF5, perhaps a raster in netCDF", kRaster, {}, {{"\x89HDF\r\n"sv}}},
      {"a raster in GRIB", kRaster, {}, {{"GRIB"sv}}},
      {"a raster in DTED", kRaster, {".dt1", ".dt2"}, {{"UHL1"sv}}},
      {"a grid of Surfer", kRaster, {".grd"}, {{"DSAA"sv}, {"DSBB"sv}, {"DSRB"sv}}},
      {"a picture in JPEG 2000", kPicture, {".jp2"}, {{"\0\0\0\x0CjP  "sv}}},
      {"a BMP picture", {}, {".bmp"}, {}, true},
      {"a GIF picture", kOfMesh, {".gif"}, {{"GIF8"sv}}, true},
      {"a TGA picture", {}, {".tga"}, {}, true},
      {"a DDS picture", kOfMesh, {".dds"}, {{"DDS "sv}}, true},
      {"an SVG picture", "give a mesh", {}, {{"<svg"sv, 0, "<"}}},
      {"a PDF document", kExport, {".pdf"}, {{"%PDF"sv}}},
      {"a web page",
       "the download of the mesh may have failed",
       {".htm", ".html"},
       {{"<html"sv, 0, "<"}, {"<!DOCTYPE html"sv, 0, "<"}}},
      {"an XML file", kExport, {".xml"}, {{"<?xml"sv, 0, "<"}}},
      {"a document of JSON", {}, {".json"}},
      {"a table", {}, {".csv"}},
      {"a program",
       "give a mesh",
       {},
       {{"\x7F"
         "ELF"sv}}},
      {"a text in UTF-16", "save it as UTF-8", {}, {{"\xFF\xFE"sv}, {"\xFE\xFF"sv}}},
      {"a pointer of Git LFS, not the file itself",
       "fetch that by `git lfs pull`",
       {},
       {{"version https://git-lfs"sv}}},
      {"a material library", "give the OBJ that names it", {}, {{"newmtl"sv}}},
  };
}

const std::vector<OtherFormat>& others() {
  static const std::vector<OtherFormat> all = make_others();
  return all;
}

constexpr std::size_t kWordsWithin = 4096;

std::string_view without_blanks(std::string_view text) {
  text = without_mark(text);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text;
}

/// Returns whether the first line has three numbers or more, and nothing else.
bool is_row_of_numbers(std::string_view text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  if (line.find_first_not_of("0123456789+-.eE,; \t") != std::string_view::npos)
    return false;
  std::size_t numbers = 0;
  bool inside = false;
  for (const char c : line) {
    const bool is_part = c != ' ' && c != '\t' && c != ',' && c != ';';
    numbers += is_part && !inside ? 1 : 0;
    inside = is_part;
  }
  return numbers >= 3;
}

std::string told(std::string_view name, std::string_view advice) {
  return std::string(name) + "; " + std::string(advice);
}

/// The first row with a mark that `is_there`; null if none has one.
template <class IsThere>
const OtherFormat* first_with(const IsThere& is_there) {
  const auto found = std::ranges::find_if(others(), [&](const OtherFormat& other) {
    return std::ranges::any_of(other.marks, is_there);
  });
  return found == others().end() ? nullptr : &*found;
}

}  // namespace

std::string other_format(std::string_view start) {
  for (const ImageFormatRow& row : kImageFormats) {
    if (row.file.is_start(start))
      return told("a " + std::string(row.file.title) + " picture", kPicture);
  }
  const std::string_view text = without_blanks(start);
  const std::string_view head = text.substr(0, kWordsWithin);
  const OtherFormat* found = first_with([&](const Mark& mark) {
    return mark.begins.empty() && start.size() > mark.offset &&
           start.substr(mark.offset).starts_with(mark.bytes);
  });
  if (found == nullptr) {
    found = first_with([&](const Mark& mark) {
      return !mark.begins.empty() && text.starts_with(mark.begins) &&
             head.find(mark.bytes) != std::string_view::npos;
    });
  }
  if (found != nullptr)
    return told(found->name, found->advice);
  if (is_row_of_numbers(text))
    return told("rows of numbers, perhaps the points of a cloud", kTriangulate);
  return "";
}

bool is_known_ending(std::string_view ending) {
  const auto has = [&](const std::vector<std::string_view>& endings) {
    return std::ranges::find(endings, ending) != endings.end();
  };
  return has(mesh_endings()) || has(companion_picture_endings()) ||
         std::ranges::any_of(others(), has, &OtherFormat::endings);
}

bool may_be_picture(std::string_view name) {
  const std::string small = small_letters(name);
  return std::ranges::any_of(companion_picture_endings(),
                             [&](std::string_view ending) { return small.ends_with(ending); });
}

std::vector<std::string_view> companion_picture_endings() {
  std::vector<std::string_view> all;
  for (const ImageFormatRow& row : kImageFormats) {
    std::ranges::copy_if(row.file.endings, std::back_inserter(all),
                         [](std::string_view ending) { return !ending.empty(); });
  }
  for (const OtherFormat& other : others()) {
    if (other.is_picture)
      all.insert(all.end(), other.endings.begin(), other.endings.end());
  }
  return all;
}

}  // namespace meshhier::mesh_io
