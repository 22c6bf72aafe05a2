// PLY files made in code, and what a mesh source says of them.
#pragma once

#include "mesh_io/mesh_source.h"
#include "mesh_io/ply_header.h"
#include "support/memory_files.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io::tests {

using Bytes = std::string;

using meshhier::tests::MemoryFiles;

/// The name every file of read_bytes() has.
inline constexpr std::string_view kFileName = "mesh.ply";

/// Everything a source hands out.
struct ReadMesh {
  MeshDescription description;
  std::vector<Vec3d> positions;  ///< floats widened
  std::vector<float> attributes;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  FaceCounts counts;
};

/// Reads vertices, then triangles, then both again, then in blocks, and checks that all times
/// agree, that blocks are within their size and consecutive, and that positions are in the right
/// span.
ReadMesh read_mesh(MeshSource& source);
/// Reads vertices in blocks, if there are any, else as a stream; triangles in blocks as far as they
/// are whole. Blocks are read last to first if `backwards`: any order is as good.
ReadMesh read_in_blocks(MeshSource& source, bool backwards);
ReadMesh read_bytes(const Bytes& bytes, const AttributeChoice& attributes = {});

/// The message of the Error(input) that reading throws, as a stream and in blocks alike; fails the
/// test if there is none.
std::string error_of(const Bytes& bytes);

/// Writes PLY data value by value in any encoding. In text every row ends with `line_end`.
class PlyText {
 public:
  explicit PlyText(PlyEncoding encoding, std::string line_end = "\n");

  PlyText& line(const std::string& text);  ///< adds a line to the header
  PlyText& end_header();
  PlyText& value(PlyType type, double number);
  PlyText& end_row();
  /// All values of one type in one row.
  PlyText& row(PlyType type, std::initializer_list<double> numbers);
  /// A row with one list.
  PlyText& list(PlyType count, PlyType item, std::initializer_list<double> numbers);

  const Bytes& bytes() const { return bytes_; }

 private:
  PlyEncoding encoding_;
  std::string line_end_;
  bool row_begun_ = false;
  Bytes bytes_;
};

inline constexpr PlyEncoding kEncodings[] = {PlyEncoding::ascii, PlyEncoding::little_endian,
                                             PlyEncoding::big_endian};
inline constexpr PlyType kTypes[] = {PlyType::i8,  PlyType::u8,  PlyType::i16, PlyType::u16,
                                     PlyType::i32, PlyType::u32, PlyType::f32, PlyType::f64};

/// A tetrahedron: 4 vertices of small whole coordinates, 4 triangles.
Bytes tetrahedron(PlyEncoding encoding, PlyType coordinate = PlyType::f32,
                  PlyType count = PlyType::u8, PlyType index = PlyType::i32);

}  // namespace meshhier::mesh_io::tests
