// The text header of a PLY file (Turk, "The PLY Polygon File Format", 1994), as a value.
#pragma once

#include "base/named_value.h"
#include "hierarchy/scalar_value.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

/// char uchar short ushort int uint float double, or int8 ... float64; and int64, uint64, which the
/// format does not have.
enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64, i64, u64 };

/// Both enumerations have one order; integers of 64 bits are kept as doubles.
constexpr ValueType value_type(PlyType type) {
  return type > PlyType::f64 ? ValueType::f64 : static_cast<ValueType>(type);
}
constexpr PlyType ply_type(ValueType type) {
  return static_cast<PlyType>(type);
}
static_assert(value_type(PlyType::f64) == ValueType::f64 && ply_type(ValueType::i8) == PlyType::i8);

struct PlyTypeRow {
  std::string_view name;  ///< the name of the 1994 paper, as most files write it
  std::string_view sized_name;
  PlyType value;
  std::uint8_t bytes;
};
inline constexpr std::array kPlyTypes{PlyTypeRow{"char", "int8", PlyType::i8, 1},
                                      PlyTypeRow{"uchar", "uint8", PlyType::u8, 1},
                                      PlyTypeRow{"short", "int16", PlyType::i16, 2},
                                      PlyTypeRow{"ushort", "uint16", PlyType::u16, 2},
                                      PlyTypeRow{"int", "int32", PlyType::i32, 4},
                                      PlyTypeRow{"uint", "uint32", PlyType::u32, 4},
                                      PlyTypeRow{"float", "float32", PlyType::f32, 4},
                                      PlyTypeRow{"double", "float64", PlyType::f64, 8},
                                      PlyTypeRow{"int64", "int64", PlyType::i64, 8},
                                      PlyTypeRow{"uint64", "uint64", PlyType::u64, 8}};
static_assert(are_in_order(kPlyTypes, &PlyTypeRow::value) &&
              kPlyTypes.size() == static_cast<std::size_t>(PlyType::u64) + 1);

constexpr const PlyTypeRow& row_of(PlyType type) {
  return kPlyTypes[static_cast<std::size_t>(type)];
}
constexpr std::uint64_t size_of(PlyType type) {
  return row_of(type).bytes;
}
constexpr bool is_integer(PlyType type) {
  return type != PlyType::f32 && type != PlyType::f64;
}
constexpr bool has_64_bits(PlyType type) {
  return type == PlyType::i64 || type == PlyType::u64;
}
constexpr bool is_unsigned(PlyType type) {
  return type == PlyType::u8 || type == PlyType::u16 || type == PlyType::u32 ||
         type == PlyType::u64;
}
/// Returns the type's name as most files write it: "uchar".
std::string_view name_of(PlyType type);
/// Returns "ASCII", "binary little endian", "binary big endian".
std::string_view name_of(PlyEncoding encoding);

struct PlyProperty {
  std::string name;
  PlyType type{};                     ///< type of the value, or of each item of the list
  std::optional<PlyType> count_type;  ///< type of a list's length, an integer type; none: one value
  /// Length of a list whose length stands in no row (settle_ply_names).
  std::uint8_t fixed_count = 0;

  bool is_list() const { return count_type.has_value() || fixed_count > 0; }
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding{};
  std::vector<PlyElement> elements;        ///< names are unique
  std::vector<std::string> texture_files;  ///< NAME of each "comment TextureFile NAME", in any case
  std::uint64_t data_offset = 0;           ///< byte behind the line end of end_header
  std::uint64_t data_line = 0;  ///< number of the line at data_offset; the first of a file is 1
  std::uint64_t odd_lines = 0;  ///< lines that the format has otherwise
};

/// Real headers have less than 2 KiB, but some writers put metadata (cameras, JSON) into comments.
/// 256 KiB leaves room for them and stops the search for end_header in a large file of other data.
inline constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 18;

/// The longest line of a header: above any real comment, below the point where a message gets
/// absurd.
inline constexpr std::size_t kMaxHeaderLineBytes = std::size_t{1} << 16;

/// Parses the header at the start of a file. `start`: the first min(file size, kMaxHeaderBytes)
/// bytes; `path` is for messages only. Lines end with LF, CRLF, or (if the first line does) CR
/// alone; blanks around lines and blank lines are allowed; a property's name is the rest of its
/// line, so names with spaces, which some writers produce, are read. Lines of no known keyword
/// between the format and the first element are passed over. Read and counted as odd are: a byte
/// order mark or blank lines first; "PLY", with keywords in any case then; types in any case;
/// versions 1, 1.1 and none; types of 64 bits; names that mean the format's (settle_ply_names).
/// Throws Error(input) naming the line. Pure.
PlyHeader parse_ply_header(std::string_view start, const std::filesystem::path& path);

}  // namespace meshhier::mesh_io
