#include "mesh_io/formats.h"

#include "base/small_letters.h"
#include "mesh_io/beside_raster.h"
#include "mesh_io/geotiff_place.h"
#include "mesh_io/gltf_outline.h"
#include "mesh_io/height_raster.h"
#include "mesh_io/hgt_name.h"
#include "mesh_io/inflated_file.h"
#include "mesh_io/input_error.h"
#include "mesh_io/obj_reader.h"
#include "mesh_io/off_reader.h"
#include "mesh_io/osgb_file.h"
#include "mesh_io/other_formats.h"
#include "mesh_io/recognition.h"
#include "mesh_io/stl_reader.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr Certainty sure_if(bool is_so) {
  return is_so ? Certainty::sure : Certainty::none;
}

/// Returns whether a file has the length that its count of facets asks for: then it is a binary
/// STL, whatever stands in the 80 bytes that makers may fill.
bool has_length_of_stl(const MeshContent& c) {
  return !c.is_gzip() && c.stl_bytes() == c.file().size();
}

bool begins_as_tiff(std::string_view start) {
  using namespace std::string_view_literals;
  return start.starts_with("II*\0"sv) || start.starts_with("MM\0*"sv) ||
         start.starts_with("II+\0"sv) || start.starts_with("MM\0+"sv);
}

bool begins_as_asc(const MeshContent& c) {
  const std::string word = small_letters(c.first_word());
  return c.is_text() && (word == "ncols" || word == "nrows");
}

/// Files of SRTM have no mark: their name and their size tell.
Certainty look_for_hgt(MeshContent& c) {
  const storage::File& file = c.file();
  const std::string name = file.path().filename().string();
  const bool is_named =
      c.is_gzip() ? is_packed_hgt_name(name) : small_letters(name).ends_with(".hgt");
  return sure_if(is_named && hgt_corner(name) &&
                 hgt_side(c.is_gzip() ? told_bytes(file) : file.size()));
}

std::vector<FormatRow> make_rows() {
  return {
      {.kind = MeshKind::ply,
       .name = "PLY",
       .format = "PLY",
       .ending = ".ply",
       .look = [](MeshContent& c) { return sure_if(begins_as_ply(c.start())); },
       .kept = "ASCII, binary little and big endian; any scalar types; polygons and triangle "
               "strips; normals, colours, texture coordinates of vertices; colours of faces; "
               "textures; all other numbers of vertices and faces",
       .left_out = "lists, unknown elements: skipped"},
      {.kind = MeshKind::obj,
       .name = "OBJ",
       .format = "OBJ",
       .ending = ".obj",
       .look =
           [](MeshContent& c) { return sure_if(c.is_text() && is_obj_statement(c.first_word())); },
       .companions = {".mtl"},
       .kept = "`v`, `vt`, `vn`, `f`; polygons; vertex colours; materials with their pictures; "
               "objects by `o`, `g` or `usemtl`, and labels if one asks for them",
       .left_out = "points and lines, smoothing groups, curves and surfaces: counted. Unknown "
                   "words: errors"},
      {.kind = MeshKind::gltf,
       .name = "glTF",
       .format = "glTF",
       .ending = ".gltf",
       .look =
           [](MeshContent& c) {
             return sure_if(!has_length_of_stl(c) && c.kind_of_json() == MeshKind::gltf);
           },
       .outline = outline_of_gltf,
       .in_metres = true,
       .names_features = true,
       .companions = {".bin"},
       .kept = "2.0; triangles, strips and fans of the scene at their places, "
               "skins in their pose; normals, `COLOR_0`, texture coordinates and picture of the "
               "base colour, light that is emitted; nodes or features as objects",
       .left_out = "points, lines, morph targets, animations, cameras, other materials"},
      {.kind = MeshKind::glb,
       .name = "GLB",
       .format = "glTF",
       .ending = ".glb",
       .look =
           [](MeshContent& c) {
             return sure_if(!has_length_of_stl(c) && c.start().starts_with("glTF"));
           },
       .outline = outline_of_gltf,
       .in_metres = true,
       .names_features = true},
      {.kind = MeshKind::stl_binary,
       .name = "binary STL",
       .format = "STL",
       .ending = ".stl",
       .look = look_for_binary_stl,
       .kept = "binary and ASCII, also several solids, which are objects; colours of facets",
       .left_out = "facet normals, other attribute bytes: counted"},
      {.kind = MeshKind::stl_text,
       .name = "ASCII STL",
       .format = "STL",
       .ending = ".stl",
       .look =
           [](MeshContent& c) {
             return sure_if(c.is_text() && is_stl_keyword(c.first_word(), "solid"));
           }},
      {.kind = MeshKind::off,
       .name = "OFF",
       .format = "OFF",
       .ending = ".off",
       .look = [](MeshContent& c) { return sure_if(is_off_keyword(c.first_word())); },
       .kept = "`[ST][C][N]OFF` in text",
       .left_out = "binary files and other dimensions: refused"},
      {.kind = MeshKind::tileset,
       .name = "3D Tiles",
       .format = "3D Tiles",
       .ending = ".3tz",
       .look = [](MeshContent& c) { return sure_if(c.kind_of_json() == MeshKind::tileset); },
       .has_place = true,
       .kept = "1.0 and 1.1: the finest tiles of a `tileset.json` or in a `.3tz`, listed or "
               "implicit, where "
               "they stand",
       .left_out = "instances, points"},
      {.kind = MeshKind::b3dm,
       .name = "b3dm",
       .format = "3D Tiles",
       .outline = outline_of_gltf,
       .in_metres = true,
       .names_features = true},
      {.kind = MeshKind::osgb,
       .name = "OSGB",
       .format = "OSGB",
       .ending = ".osgb",
       .look = [](MeshContent& c) { return sure_if(begins_as_osgb(c.start())); },
       .has_place = true,
       .kept = "the finest tiles of a PagedLOD, and of the files that it names; normals, vertex "
               "colours, pictures (JPEG, PNG, DXT) of the first texture",
       .left_out = "points, lines, shapes, other textures"},
      {.kind = MeshKind::geotiff,
       .name = "GeoTIFF",
       .format = "GeoTIFF",
       .ending = ".tif",
       .look = [](MeshContent& c) { return sure_if(!c.is_gzip() && begins_as_tiff(c.start())); },
       .outline =
           [](const storage::File& file) { return MeshOutline{.buffers = place_files_of(file)}; },
       .has_place = true,
       .is_raster = true,
       .companions = {".tfw", ".tifw", ".wld"},
       .kept =
           "heights: one band of integers or floats of 8 to 64 bits, BigTIFF, tiles and strips "
           "in all compressions of libtiff; scale, offset, unit, nodata, masks and alpha; place "
           "and CRS, also in a world file and a `.prj` beside; several files on one grid are "
           "one surface",
       .left_out = "overviews; control points and CRSs that a file defines itself"},
      {.kind = MeshKind::geotiff, .name = "GeoTIFF", .format = "GeoTIFF", .ending = ".tiff"},
      {.kind = MeshKind::hgt,
       .name = "SRTM heights",
       .format = "SRTM",
       .ending = ".hgt",
       .look = look_for_hgt,
       .has_place = true,
       .is_raster = true,
       .kept = "heights of 3 or 1 seconds, also in gzip; the name tells the place "
               "(`N53E027.hgt`)",
       .left_out = "nothing"},
      {.kind = MeshKind::asc,
       .name = "ESRI text grid",
       .format = "ESRI ASCII",
       .ending = ".asc",
       .look = [](MeshContent& c) { return sure_if(!c.is_gzip() && begins_as_asc(c)); },
       .outline =
           [](const storage::File& file) {
             return MeshOutline{.buffers = {crs_file_of(file.path())}};
           },
       .has_place = true,
       .is_raster = true,
       .companions = {".prj"},
       .kept = "heights, place, and the CRS of a `.prj` beside it",
       .left_out = "`.prj` files that are no WKT"},
  };
}

/// The kind that is the surest, the first one among equals.
std::optional<MeshKind> kind_of(MeshContent& content) {
  std::optional<MeshKind> likely;
  for (const FormatRow& row : format_rows()) {
    const Certainty certainty = row.look == nullptr ? Certainty::none : row.look(content);
    if (certainty == Certainty::sure)
      return row.kind;
    if (certainty == Certainty::likely && !likely)
      likely = row.kind;
  }
  return likely;
}

std::optional<MeshFormat> format_of(MeshContent& content) {
  const auto kind = kind_of(content);
  return kind ? std::optional(MeshFormat{*kind, content.is_gzip()}) : std::nullopt;
}

/// Returns what a file would have to be as a binary STL, if it may be meant for one.
std::string stl_hint(const MeshContent& content) {
  const auto expected = content.stl_bytes();
  if (!expected || content.is_gzip() || content.is_text())
    return "";
  const std::uint64_t bytes = content.file().size();
  return fmt::format(
      "; as a binary STL it would have {} bytes, it has {} ({})", *expected, bytes,
      bytes < *expected ? "truncated?" : "its count of facets is wrong, or more follows");
}

/// Returns "a, b or c".
std::string alternatives(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += i == 0 ? "" : i + 1 < words.size() ? ", " : " or ";
    text += words[i];
  }
  return text;
}

/// Returns a column's texts of the rows with an ending, each once.
std::vector<std::string_view> column(std::string_view FormatRow::*member) {
  std::vector<std::string_view> all;
  for (const FormatRow& row : format_rows()) {
    if (!row.ending.empty() && std::ranges::find(all, row.*member) == all.end())
      all.push_back(row.*member);
  }
  return all;
}

/// Returns 0 if it is no mesh's name.
std::size_t stem_length(std::string_view name) {
  std::string small = small_letters(name);
  if (small.ends_with(".gz"))
    small.resize(small.size() - 3);
  for (const std::string_view ending : mesh_endings()) {
    if (small.ends_with(ending))
      return small.size() - ending.size();
  }
  return 0;
}

}  // namespace

const std::vector<FormatRow>& format_rows() {
  static const std::vector<FormatRow> rows = make_rows();
  return rows;
}

const FormatRow& row_of(MeshKind kind) {
  return *std::ranges::find(format_rows(), kind, &FormatRow::kind);
}

std::string name_of(const MeshFormat& format) {
  return std::string(format.row().name) + (format.is_gzip ? " (gzip)" : "");
}

std::optional<MeshFormat> find_format(const storage::File& file) {
  MeshContent content(file);
  return format_of(content);
}

MeshFormat detect_format(const storage::File& file) {
  MeshContent content(file);
  if (const auto format = format_of(content))
    return *format;
  const std::string_view start = content.start();
  const std::string other = is_packed_hgt(content)
                                ? "SRTM heights in gzip of another size than 1201 or 3601 rows, or "
                                  "without a name such as N53E027.hgt.gz"
                                : other_format(start);
  if (!other.empty()) {
    fail_file(file.path(), fmt::format("expected a mesh ({}, or a tileset.json), found {}",
                                       format_names(), other));
  }
  fail_file(
      file.path(),
      fmt::format("expected a mesh ({}, or one of them packed by gzip), found {}{}", format_names(),
                  start.empty() ? "an empty file" : in_quotes(start), stl_hint(content)));
}

std::string format_names() {
  std::vector<std::string_view> names = column(&FormatRow::format);
  std::erase(names, row_of(MeshKind::tileset).format);
  return alternatives(names);
}

std::string mesh_endings_text() {
  return alternatives(mesh_endings());
}

std::vector<std::string_view> mesh_endings() {
  return column(&FormatRow::ending);
}

bool is_mesh_name(std::string_view name) {
  return !name.starts_with('.') && stem_length(name) > 0;
}

std::string mesh_stem(std::string_view name) {
  return std::string(name.substr(0, stem_length(name)));
}

}  // namespace meshhier::mesh_io
