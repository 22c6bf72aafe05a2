#include "mesh_io/foreign_format.h"

#include "hierarchy/text_mark.h"
#include "mesh_io/text_chars.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace meshhier::mesh_io {
namespace {

using namespace std::string_view_literals;

struct Foreign {
  std::string_view name;
  std::string_view advice;
};

constexpr std::string_view kUnpack = "unpack it, and build the mesh in it";
constexpr std::string_view kExport = "export it as glTF, OBJ or PLY from the program that made it";
constexpr std::string_view kTriangulate =
    "make a mesh of its points first, as by Poisson reconstruction";
constexpr std::string_view kTileset = "build the tileset.json that lists it";
constexpr std::string_view kHierarchy =
    "it is part of what a build makes: `meshhier inspect` and `serve` take its directory";
constexpr std::string_view kHeights = "if its values are heights, make a mesh of them first";

/// Of bytes that stand at a known place.
struct Signature {
  std::size_t offset;
  std::string_view bytes;
  Foreign what;
};

constexpr auto kSignatures = std::to_array<Signature>({
    {0, "PK\x03\x04"sv, {"a zip archive (perhaps 3MF, USDZ, KMZ or 3TZ)", kUnpack}},
    {0, "PK\x05\x06"sv, {"a zip archive without files", "nothing is in it"}},
    {0, "7z\xBC\xAF\x27\x1C"sv, {"a 7z archive", kUnpack}},
    {0, "Rar!\x1A\x07"sv, {"a RAR archive", kUnpack}},
    {257, "ustar"sv, {"a tar archive", kUnpack}},
    {0, "BZh"sv, {"a file in bzip2", kUnpack}},
    {0,
     "\xFD"
     "7zXZ\0"sv,
     {"a file in xz", kUnpack}},
    {0, "\x28\xB5\x2F\xFD"sv, {"a file in zstd", kUnpack}},
    {0, "\x04\x22\x4D\x18"sv, {"a file in LZ4", kUnpack}},
    {0, "Kaydara FBX Binary"sv, {"an FBX file", kExport}},
    {0, "; FBX"sv, {"an FBX file", kExport}},
    {0, "BLENDER"sv, {"a Blender file", kExport}},
    {0, "PXR-USDC"sv, {"a USD file", kExport}},
    {0, "#usda"sv, {"a USD file", kExport}},
    {0, "Ogawa"sv, {"an Alembic file", kExport}},
    {0, "#VRML"sv, {"a VRML file", kExport}},
    {0, "#X3D"sv, {"an X3D file", kExport}},
    {0, "ISO-10303-21"sv, {"a STEP file", kExport}},
    {0, "3D Geometry File Format"sv, {"a Rhino file", kExport}},
    {0, "\xFF\xFE\xFF\x0ES\0k\0e\0t\0c\0h\0U\0p\0"sv, {"a SketchUp file", kExport}},
    {0,
     "\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv,
     {"a compound document, as of Revit, SolidWorks or 3ds Max", kExport}},
    {0, "AC10"sv, {"a DWG drawing", kExport}},
    {0, "AutoCAD Binary DXF"sv, {"a DXF drawing", kExport}},
    {0, "DRACO"sv, {"a Draco mesh", "put it into a glTF (KHR_draco_mesh_compression)"}},
    {0, "OCTM"sv, {"an OpenCTM mesh", kExport}},
    {0, "# vtk DataFile"sv, {"a VTK file", kExport}},
    {0, "$MeshFormat"sv, {"a Gmsh mesh", kExport}},
    {0, "LASF"sv, {"a point cloud (LAS or LAZ)", kTriangulate}},
    {0, "ASTM-E57"sv, {"a point cloud (E57)", kTriangulate}},
    {0, "# .PCD"sv, {"a point cloud (PCD)", kTriangulate}},
    {0, "b3dm"sv, {"a tile of 3D Tiles", kTileset}},
    {0, "i3dm"sv, {"a tile of 3D Tiles", kTileset}},
    {0, "pnts"sv, {"a tile of 3D Tiles with points", kTriangulate}},
    {0, "cmpt"sv, {"a tile of 3D Tiles", kTileset}},
    {0, "MHTILES\n"sv, {"the index of a hierarchy", kHierarchy}},
    {0, "MHDETAIL"sv, {"a file of a progressive stream", kHierarchy}},
    {0, "\x89PNG"sv, {"a PNG picture", kHeights}},
    {0, "\xFF\xD8\xFF"sv, {"a JPEG picture", kHeights}},
    {0, "II*\0"sv, {"a TIFF picture", kHeights}},
    {0, "MM\0*"sv, {"a TIFF picture", kHeights}},
    {0, "II+\0"sv, {"a TIFF picture", kHeights}},
    {0, "\xABKTX 20\xBB"sv, {"a KTX2 picture", "give the mesh that it belongs to"}},
    {8, "WEBP"sv, {"a WebP picture", "give the mesh that it belongs to"}},
    {0, "%PDF"sv, {"a PDF document", kExport}},
    {0,
     "\x7F"
     "ELF"sv,
     {"a program", "give a mesh"}},
    {0, "\xFF\xFE"sv, {"a text in UTF-16", "save it as UTF-8"}},
    {0, "\xFE\xFF"sv, {"a text in UTF-16", "save it as UTF-8"}},
    {0,
     "version https://git-lfs"sv,
     {"a pointer of Git LFS, not the file itself", "fetch that by `git lfs pull`"}},
    {0, "newmtl"sv, {"a material library", "give the OBJ that names it"}},
});

/// Of words in the first part of a text that begins in some way.
struct Word {
  std::string_view begins;
  std::string_view word;
  Foreign what;
};

constexpr auto kWords = std::to_array<Word>({
    {"<", "<COLLADA", {"a Collada file", kExport}},
    {"<", "<X3D", {"an X3D file", kExport}},
    {"<", "<VTKFile", {"a VTK file", kExport}},
    {"<", "<LandXML", {"a LandXML file", kExport}},
    {"<", "CityModel", {"a CityGML file", kExport}},
    {"<", "<kml", {"a KML file", "give the mesh that it places"}},
    {"<",
     "<ModelMetadata",
     {"metadata of a model", "give it as `placement.metadata`, and the mesh as the input"}},
    {"<", "<svg", {"an SVG picture", "give a mesh"}},
    {"<", "<html", {"a web page", "the download of the mesh may have failed"}},
    {"<", "<!DOCTYPE html", {"a web page", "the download of the mesh may have failed"}},
    {"<", "<?xml", {"an XML file", kExport}},
    {"{", "\"format\": \"meshhier", {"the manifest of a hierarchy", kHierarchy}},
    {"{", "\"CityJSON\"", {"a CityJSON file", kExport}},
    {"{", "\"FeatureCollection\"", {"a GeoJSON file", kExport}},
    {"0", "SECTION", {"a DXF drawing", kExport}},
    {"999", "SECTION", {"a DXF drawing", kExport}},
});

constexpr std::size_t kWordsWithin = 4096;

std::string_view without_blanks(std::string_view text) {
  text = without_mark(text);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text;
}

/// Three numbers or more, and nothing else in the first line.
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

Foreign find_foreign(std::string_view start) {
  for (const Signature& signature : kSignatures) {
    if (start.size() > signature.offset &&
        start.substr(signature.offset).starts_with(signature.bytes))
      return signature.what;
  }
  const std::string_view text = without_blanks(start);
  const std::string_view head = text.substr(0, kWordsWithin);
  for (const Word& word : kWords) {
    if (text.starts_with(word.begins) && head.find(word.word) != std::string_view::npos)
      return word.what;
  }
  if (is_row_of_numbers(text))
    return {"rows of numbers, perhaps the points of a cloud", kTriangulate};
  return {};
}

}  // namespace

std::string foreign_format(std::string_view start) {
  const Foreign found = find_foreign(start);
  return found.name.empty() ? "" : std::string(found.name) + "; " + std::string(found.advice);
}

}  // namespace meshhier::mesh_io
