#include "mesh_io/obj_reader.h"

#include "mesh_io/input_error.h"
#include "mesh_io/number_text.h"
#include "mesh_io/polygon_cut.h"
#include "mesh_io/word_stream.h"

#include <algorithm>
#include <charconv>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

constexpr std::string_view kRead[] = {"v", "vt",     "vn",     "f", "fo", "g",
                                      "o", "usemtl", "mtllib", "p", "l"};
constexpr std::string_view kIgnored[] = {
    "s",     "vp",    "mg",       "cstype",     "deg",      "bmat",   "step",   "curv",
    "curv2", "surf",  "parm",     "trim",       "hole",     "scrv",   "sp",     "end",
    "con",   "bevel", "c_interp", "d_interp",   "lod",      "maplib", "usemap", "call",
    "csh",   "ctech", "stech",    "shadow_obj", "trace_obj"};

constexpr std::string_view kPolypaint = "#MRGB";

constexpr std::uint64_t kMostElements = UINT32_MAX;  // the last value means none

bool is_one_of(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

/// One of the three kinds of things that corners refer to.
struct Kind {
  const char* name;
  std::uint64_t count = 0;
  std::uint64_t highest = 0;       ///< number, from 1 on, that was referred to
  std::uint64_t highest_line = 0;  ///< where that was
};

class ObjReader {
 public:
  ObjReader(InputStream& stream, const std::filesystem::path& path, ObjVisitor& visitor)
      : words_(stream, path, {.joins_lines = true, .kept_comment = kPolypaint}),
        path_(path),
        visitor_(visitor) {}

  ObjCounts read() {
    while (words_.to_row())
      read_statement(words_.take_word());
    for (const Kind* kind : {&positions_, &texcoords_, &normals_})
      check_highest(*kind);
    counts_.positions = positions_.count;
    counts_.texcoords = texcoords_.count;
    counts_.normals = normals_.count;
    return counts_;
  }

 private:
  void read_statement(std::string_view word) {
    if (word == "v")
      return read_position();
    if (word == "vt")
      return read_texcoord();
    if (word == "vn")
      return read_normal();
    if (word == "f" || word == "fo")
      return read_face();
    if (word == "usemtl")
      return read_material();
    if (word == "mtllib")
      return read_libraries();
    if (word.starts_with('#'))
      return word == kPolypaint ? read_polypaint() : words_.skip_line();
    count_statement(word);
    words_.skip_line();
  }

  /// What is no such number ends it: this is a comment after all.
  void read_polypaint() {
    constexpr std::size_t kDigits = 8;
    const std::string text = words_.take_rest();
    for (std::size_t at = 0; at + kDigits <= text.size(); at += kDigits) {
      std::uint32_t mrgb = 0;
      const char* const end = text.data() + at + kDigits;
      if (std::from_chars(text.data() + at, end, mrgb, 16).ptr != end)
        return;
      const auto part = [&](int shift) { return static_cast<float>(mrgb >> shift & 255) / 255; };
      ++counts_.painted;
      visitor_.add_polypaint({part(16), part(8), part(0)});
    }
  }

  void read_material() {
    ++counts_.materials;
    visitor_.use_material(words_.take_rest());
  }

  void read_libraries() {
    ++counts_.libraries;
    visitor_.use_libraries(words_.take_rest());
  }

  void count_statement(std::string_view word) {
    if (word == "g")
      ++counts_.groups;
    else if (word == "o")
      ++counts_.objects;
    else if (word == "p" || word == "l")
      ++counts_.points_and_lines;
    else if (is_one_of(word, kIgnored))
      ++counts_.others;
    else
      words_.fail("expected a statement of an OBJ file (v, vt, vn, f, ...), found " +
                  in_quotes(word));
  }

  void count_one(Kind& kind) {
    if (++kind.count >= kMostElements)
      words_.fail(fmt::format("found {} {}s, expected fewer", kind.count, kind.name));
  }

  void read_position() {
    const Vec3d position = words_.take_position(counts_.fits_float, &counts_.unplaced);
    std::array<float, 4> rest{};
    std::size_t more = 0;
    for (; words_.to_word() && more < rest.size(); ++more)
      rest[more] = words_.take_float(more == 0 ? "a weight or a colour" : "a colour");
    if (more == 2 || words_.to_word())
      words_.fail("expected 3, 4, 6 or 7 numbers behind 'v', found another number of them");
    count_one(positions_);
    std::optional<ObjColour> colour;
    if (more >= 3)
      colour = {rest[0], rest[1], rest[2]};
    counts_.coloured += colour ? 1 : 0;
    visitor_.add_position(position, colour);
  }

  void read_texcoord() {
    std::array<float, 3> texcoord{words_.take_any_float("a texture coordinate")};
    for (std::size_t i = 1; i < texcoord.size() && words_.to_word(); ++i)
      texcoord[i] = words_.take_any_float("a texture coordinate");
    words_.expect_line_end();
    counts_.zeroed += zero_what_is_not_finite({.texcoords = true}, std::span(texcoord).first<2>());
    count_one(texcoords_);
    visitor_.add_texcoord({texcoord[0], texcoord[1]});
  }

  void read_normal() {
    std::array<float, 3> normal{};
    for (float& part : normal)
      part = words_.take_any_float("a normal");
    words_.expect_line_end();
    counts_.zeroed += zero_what_is_not_finite({.normals = true}, normal);
    count_one(normals_);
    visitor_.add_normal({normal[0], normal[1], normal[2]});
  }

  /// Of a face with very many corners only the first and the last one are kept.
  void read_face() {
    corners_.clear();
    std::uint64_t count = 0;
    for (; words_.to_word(); ++count) {
      if (corners_.size() > PolygonCut::kMostCorners) {
        const ObjCorner corner = parse_corner(words_.take_word());
        add({corners_.front(), corners_.back(), corner});
        corners_.back() = corner;
      } else {
        corners_.push_back(parse_corner(words_.take_word()));
        if (corners_.size() > PolygonCut::kMostCorners)
          begin_large_face();
      }
    }
    ++counts_.faces;
    counts_.degenerate_triangles += count < 3 ? 1 : 0;
    if (count <= PolygonCut::kMostCorners)
      add_polygon();
  }

  void begin_large_face() {
    ++counts_.polygons.large;
    add_fan();
  }

  void add_fan() {
    for (std::size_t i = 1; i + 1 < corners_.size(); ++i)
      add({corners_[0], corners_[i], corners_[i + 1]});
  }

  void add_polygon() {
    const auto place_at = [&](std::size_t i) {
      const std::uint32_t position = corners_[i].position;
      return position < positions_.count ? std::optional(visitor_.position(position))
                                         : std::nullopt;
    };
    cut_.for_each_triangle(corners_.size(), place_at, counts_.polygons,
                           [&](std::size_t i, std::size_t j, std::size_t k) {
                             add({corners_[i], corners_[j], corners_[k]});
                           });
  }

  void add(const ObjTriangle& t) {
    if (t[0].position == t[1].position || t[1].position == t[2].position ||
        t[2].position == t[0].position) {
      ++counts_.degenerate_triangles;
      return;
    }
    for (const ObjCorner& corner : t) {
      ++counts_.corners;
      counts_.textured_corners += corner.texcoord != ObjCorner::kNone ? 1 : 0;
      counts_.normal_corners += corner.normal != ObjCorner::kNone ? 1 : 0;
    }
    ++counts_.triangles;
    visitor_.add_triangle(t);
  }

  ObjCorner parse_corner(std::string_view word) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const std::string_view rest = word.substr(std::min(slash + 1, word.size()));
    const std::size_t second = std::min(rest.find('/'), rest.size());
    const std::string_view texcoord = rest.substr(0, second);
    const std::string_view normal = rest.substr(std::min(second + 1, rest.size()));
    ObjCorner corner;
    corner.position = resolve(word.substr(0, slash), positions_, word);
    if (!texcoord.empty())
      corner.texcoord = resolve(texcoord, texcoords_, word);
    if (!normal.empty())
      corner.normal = resolve(normal, normals_, word);
    return corner;
  }

  std::uint32_t resolve(std::string_view text, Kind& kind, std::string_view corner) {
    const auto index = parse_integer(text);
    const auto count = static_cast<std::int64_t>(kind.count);
    constexpr auto kMost = static_cast<std::int64_t>(kMostElements);
    if (!index || *index == 0 || *index >= kMost || *index < -count) {
      words_.fail(
          fmt::format("expected the number of a {} from 1 on, or from -1 to -{}, found {} in {}",
                      kind.name, count, in_quotes(text), in_quotes(corner)));
    }
    const std::int64_t number = *index > 0 ? *index : count + *index + 1;
    if (static_cast<std::uint64_t>(number) > kind.highest) {
      kind.highest = static_cast<std::uint64_t>(number);
      kind.highest_line = words_.line();
    }
    return static_cast<std::uint32_t>(number - 1);
  }

  void check_highest(const Kind& kind) const {
    if (kind.highest <= kind.count)
      return;
    fail_at_line(path_, kind.highest_line,
                 fmt::format("expected the number of a {} up to {}, as many as the file has, found "
                             "{}",
                             kind.name, kind.count, kind.highest));
  }

  WordStream words_;
  const std::filesystem::path& path_;
  ObjVisitor& visitor_;
  Kind positions_{"vertex"}, texcoords_{"texture coordinate"}, normals_{"normal"};
  std::vector<ObjCorner> corners_;  ///< of a face
  PolygonCut cut_;
  ObjCounts counts_;
};

}  // namespace

bool is_obj_statement(std::string_view word) {
  return is_one_of(word, kRead) || is_one_of(word, kIgnored);
}

ObjCounts read_obj(InputStream& stream, const std::filesystem::path& path, ObjVisitor& visitor) {
  return ObjReader(stream, path, visitor).read();
}

}  // namespace meshhier::mesh_io
