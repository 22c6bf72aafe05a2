// The plan for reading a PLY file: the properties that are taken of each element, and the checks
// that a header must pass for it.
#pragma once

#include "hierarchy/attributes.h"
#include "mesh_io/attribute_choice.h"
#include "mesh_io/ply_header.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

/// The slot that a vertex property goes to: coordinates are slots 0, 1, 2, attribute channel c is
/// slot 3 + c; a value of two channels has the first one's.
inline constexpr int kSkipped = -1;
inline constexpr int kFirstAttributeSlot = 3;

struct PlyElementPlan {
  enum class Role : std::uint8_t {
    skipped,
    vertices,
    polygons,
    strips,
    texture_vertices,  ///< which corners of texture faces name
    texture_faces      ///< places of polygons in pictures, in an element of their own
  };

  PlyElement element;
  Role role = Role::skipped;
  std::vector<int> slots;   ///< one per property: kSkipped, or the slot of a vertex property
  std::size_t corners = 0;  ///< the property with the vertex indices, of faces of any kind
  std::optional<std::size_t> texcoords;  ///< the property with those of the corners; polygons only
  std::optional<std::size_t> texnumber;  ///< the texture's number; polygons and texture faces
  std::optional<std::size_t> face;  ///< the property with the face's number; texture faces only;
                                    ///< none: they stand in the faces' order
  std::array<std::size_t, 2> texcoord{};  ///< the properties u and v; texture vertices only
  std::vector<std::size_t> colour;        ///< the three or four properties; polygons only
  std::vector<std::size_t> values;  ///< the properties for PlyPlan::face_values; polygons only
  /// Bytes of a row with all lists empty; in text the fewest characters.
  std::uint64_t min_row_bytes = 0;
  std::optional<std::uint64_t> stride;  ///< bytes of every row: binary, and no property is a list

  bool has_faces() const { return role == Role::polygons || role == Role::strips; }
  /// Returns whether PlyBody::read_rows() reads a property.
  bool takes(std::size_t property) const;
};

/// The checks of vertex rows besides those that are always made.
struct RowChecks {
  bool colours = false;  ///< must be integers from 0 to 255
  bool places = true;    ///< coordinates must be finite; else rows where one is not are let through
};

/// The element in which coordinates in pictures stand.
enum class PlyTexcoords : std::uint8_t { none, of_vertices, of_faces, of_texture_faces };

struct PlyPlan {
  PlyEncoding encoding{};
  std::vector<PlyElementPlan> elements;  ///< in the order of the file
  std::size_t vertex_element = 0;
  AttributeLayout attributes;
  bool wide_coordinates = false;  ///< a coordinate is double, int or uint
  /// None if no picture is shown; then `attributes` alone tells of coordinates of vertices.
  PlyTexcoords texcoords = PlyTexcoords::none;
  /// Empty if no picture is shown, or if `texcoords` is of_texture_faces and none is named.
  std::vector<std::string> texture_files;
  RowChecks checks;  ///< colours are checked if the stored type holds values that
                     ///< `attributes.colour` has not
  /// Colours of faces are read only if vertices have none; their alpha only with integers.
  ColourType face_colour = ColourType::none;
  bool face_alpha = false;
  std::vector<ScalarAttribute> face_values;  ///< which come behind `attributes.values`
  /// Skipped properties, "vertex.intensity", and elements, "edge".
  std::vector<std::string> unused;
  bool has_unnamed_texcoords = false;        ///< faces have them, and no picture is named
  std::vector<std::string> unused_pictures;  ///< pictures that are named and cannot be shown
  std::uint64_t odd_header_lines = 0;        ///< as PlyHeader's
};

/// Returns what the names of values begin with in files that the import writes, "label:": no other
/// property has a name of that kind.
std::string imported_prefix(ValueKind kind);

/// Returns the names of red, green and blue in files that the import writes.
std::array<std::string_view, 3> imported_colour_names(ColourSpace space, bool tints);

/// The writer of a file. In files of the import the vertices' property `material` is
/// AttributeLayout::material, and colours have imported_colour_names(). A file cannot ask for that
/// itself: only its writer knows that numbers are those of a MaterialList, or light, or factors of
/// pictures.
enum class PlyWrittenBy : std::uint8_t { anyone, import };

/// Vertices with coordinates that are not finite are refused by an error, or visited as they are.
enum class Unplaced : std::uint8_t { refused, visited };

/// Decides what is read:
///
///   element vertex       x y z                           required, any scalar type
///                        nx ny nz                        or normalx ..., or normal_x ...; any
///                                                        scalar type, as given
///                        red green blue [alpha]          or r g b [a], or diffuse_red ... [alpha]
///                        s t | u v | texture_u texture_v | texture_s texture_t | tu tv
///                        material                        behind the coordinates, if asked for
///                        all other scalars               that are chosen: values of their type
///   element face         list vertex_indices | vertex_index
///                        red green blue [alpha]          if vertices have no colour
///                        all other scalars               that are chosen and that vertices do not
///                                                        have: values, but for normals, colours
///                                                        and numbers of textures
///   element tristrips    list vertex_indices | vertex_index
///
/// of which settle_ply_names() has made what means the same, and, if comments name texture files
/// (TextureFile NAME), of polygons also
///
///   list texcoord        or texcoords, texture_coordinates, ...: u v of each corner, or nothing;
///                        any scalar type
///   texnumber            the texture file, from 0 on; -1: none; an integer type
///
/// or, as Artec Studio writes them, instead of these, whether texture files are named or not
///
///   element multi_texture_vertex   u v                              any scalar type
///   element multi_texture_face     list texture_vertex_indices      of a face's corners
///                                  tx, tn                           the texture; the face
///
/// Scalars that are not there as written are looked for without regard to the case of letters.
/// Attributes of which not all parts are there are values like others. The parts of a colour must
/// be of one type, else they are values: uchar is u8, ushort is u16, float and double are f32; the
/// other integer types are read as u8, as 0 to 255 is what files mean by them (other values are
/// errors). Integers of 64 bits are values of f64, and labels as other integers are. Values are not
/// read if they have no sound name (is_attribute_name()), a name that is taken, or do not fit
/// kMaxValueChannels. Everything else is skipped, and listed. Throws Error(input) if the vertices
/// or faces cannot be read, if there are 2^32 vertices or more, or if the declared counts do not
/// fit into `file_bytes`. Allocates nothing that a count sizes.
PlyPlan make_ply_plan(const PlyHeader& header, std::uint64_t file_bytes,
                      const std::filesystem::path& path, PlyWrittenBy writer = PlyWrittenBy::anyone,
                      const AttributeChoice& attributes = {});

}  // namespace meshhier::mesh_io
