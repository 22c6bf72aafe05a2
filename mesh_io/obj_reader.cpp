#include "mesh_io/obj_reader.h"

#include "mesh_io/input_error.h"
#include "mesh_io/line_blocks.h"
#include "mesh_io/number_text.h"
#include "mesh_io/object_choice.h"
#include "mesh_io/polygon_cut.h"
#include "mesh_io/text_chars.h"
#include "mesh_io/text_stream.h"
#include "mesh_io/word_stream.h"

#include <algorithm>
#include <charconv>
#include <cstring>
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

constexpr std::uint64_t kMostElements = UINT32_MAX;  // the last value means none

/// Returns the text from the line `lines` behind the one at its start; each ends with LF, CRLF or
/// CR.
std::string_view behind_lines(std::string_view text, std::uint64_t lines) {
  for (; lines > 0; --lines) {
    const std::size_t end = text.find_first_of("\r\n");
    if (end == std::string_view::npos)
      return text.substr(text.size());  // the file's last line has no end
    const bool is_two = text[end] == '\r' && end + 1 < text.size() && text[end + 1] == '\n';
    text.remove_prefix(end + (is_two ? 2 : 1));
  }
  return text;
}

}  // namespace

class ObjReader::Impl {
  /// One of the three kinds of things that corners refer to.
  struct Kind {
    const char* name;
    std::uint64_t count = 0;
    std::uint64_t highest = 0;       ///< number, from 1 on, that was referred to
    std::uint64_t highest_line = 0;  ///< the line that did
  };

 public:
  Impl(const std::filesystem::path& path, ObjVisitor& visitor)
      : none_({}),
        words_(none_, path, {.joins_lines = true, .kept_comment = kObjPolypaint}),
        path_(path),
        visitor_(visitor) {}

  void take(const ObjBlock& block) {
    at_ = {};
    counts_.fits_float = counts_.fits_float && block.fits_float;
    for (const ObjRun& run : block.runs) {
      take(block, run);
      line_ += run.lines;
    }
  }

  void take_rest(InputStream& rest) {
    words_.go_on(rest, line_);
    read_rows();
    line_ = words_.line();
  }

  ObjCounts finish() {
    for (const Kind* kind : {&positions_, &texcoords_, &normals_})
      check_highest(*kind);
    counts_.positions = positions_.count;
    counts_.texcoords = texcoords_.count;
    counts_.normals = normals_.count;
    return counts_;
  }

 private:
  /// The places where the next run's numbers begin.
  struct Cursor {
    std::size_t positions = 0, colours = 0, texcoords = 0, normals = 0, indices = 0;
  };

  void take(const ObjBlock& block, const ObjRun& run) {
    switch (run.kind) {
      case ObjRun::Kind::positions:
      case ObjRun::Kind::coloured:
        return take_positions(block, run);
      case ObjRun::Kind::texcoords:
        return take_texcoords(block, run);
      case ObjRun::Kind::normals:
        return take_normals(block, run);
      case ObjRun::Kind::faces:
        return take_faces(block, run);
      case ObjRun::Kind::others:
        return take_by_words(block, run, 0, run.lines);
      case ObjRun::Kind::nothing:
        return;
    }
  }

  /// Reads lines [first, first + count) of a run by words, as parse() has left them.
  void take_by_words(const ObjBlock& block, const ObjRun& run, std::uint32_t first,
                     std::uint32_t count) {
    const std::string_view text = behind_lines(
        std::string_view(block.text.data(), block.text.size()).substr(run.begin), first);
    const std::string_view behind = behind_lines(text, count);
    TextStream stream(text.substr(0, text.size() - behind.size()));
    words_.go_on(stream, line_ + first);
    read_rows();
  }

  void read_rows() {
    while (words_.to_row())
      read_statement(words_.take_word());
  }

  /// Returns whether there may be so many more. If not, which one is too many is found by words.
  static bool has_room(const Kind& kind, std::uint64_t more) {
    return kind.count + more < kMostElements;
  }

  void take_positions(const ObjBlock& block, const ObjRun& run) {
    if (!has_room(positions_, run.lines))
      return take_by_words(block, run, 0, run.lines);
    const bool is_coloured = run.kind == ObjRun::Kind::coloured;
    for (std::uint32_t i = 0; i < run.lines; ++i) {
      ++positions_.count;
      const Vec3d& position = block.positions[at_.positions++];
      is_coloured ? visitor_.add_position(position, block.colours[at_.colours++])
                  : visitor_.add_position(position, std::nullopt);
    }
    counts_.coloured += is_coloured ? run.lines : 0;
  }

  void take_texcoords(const ObjBlock& block, const ObjRun& run) {
    if (!has_room(texcoords_, run.lines))
      return take_by_words(block, run, 0, run.lines);
    texcoords_.count += run.lines;
    for (std::uint32_t i = 0; i < run.lines; ++i)
      visitor_.add_texcoord(block.texcoords[at_.texcoords++]);
  }

  void take_normals(const ObjBlock& block, const ObjRun& run) {
    if (!has_room(normals_, run.lines))
      return take_by_words(block, run, 0, run.lines);
    normals_.count += run.lines;
    for (std::uint32_t i = 0; i < run.lines; ++i) {
      const auto& [x, y, z] = block.normals[at_.normals++];
      visitor_.add_normal({x, y, z});
    }
  }

  void take_faces(const ObjBlock& block, const ObjRun& run) {
    for (std::uint32_t i = 0; i < run.lines; ++i) {
      const std::int32_t* index = block.indices.data() + at_.indices;
      at_.indices += run.indices();
      if (!take_corners(run, index, line_ + i)) {
        take_by_words(block, run, i, 1);  // which says what is wrong
        continue;
      }
      ++counts_.faces;
      add_polygon();
    }
  }

  /// Returns false if one of them refers to nothing.
  bool take_corners(const ObjRun& run, const std::int32_t* index, std::uint64_t line) {
    corners_.clear();
    for (std::uint8_t i = 0; i < run.corners; ++i) {
      ObjCorner corner;
      if (!resolve(*index++, positions_, line, corner.position) ||
          (run.has_texcoord && !resolve(*index++, texcoords_, line, corner.texcoord)) ||
          (run.has_normal && !resolve(*index++, normals_, line, corner.normal)))
        return false;
      corners_.push_back(corner);
    }
    return true;
  }

  static bool resolve(std::int64_t index, Kind& kind, std::uint64_t line, std::uint32_t& number) {
    const std::int64_t found =
        index > 0 ? index : static_cast<std::int64_t>(kind.count) + index + 1;
    if (found < 1)
      return false;
    note(kind, static_cast<std::uint64_t>(found), line);
    number = static_cast<std::uint32_t>(found - 1);
    return true;
  }

  static void note(Kind& kind, std::uint64_t number, std::uint64_t line) {
    if (number <= kind.highest)
      return;
    kind.highest = number;
    kind.highest_line = line;
  }

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
    if (word == "g")
      return read_group();
    if (word == "o")
      return read_object();
    if (word.starts_with('#'))
      return word == kObjPolypaint ? read_polypaint() : words_.skip_line();
    count_statement(word);
    words_.skip_line();
  }

  /// Reads colours up to the first text that is no such number: then this is a comment after all.
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

  void read_group() {
    ++counts_.groups;
    visitor_.takes_groups() ? visitor_.use_group(words_.take_rest(kMostObjectNameBytes))
                            : words_.skip_line();
  }

  void read_object() {
    ++counts_.objects;
    visitor_.takes_groups() ? visitor_.use_object(words_.take_rest(kMostObjectNameBytes))
                            : words_.skip_line();
  }

  void read_libraries() {
    ++counts_.libraries;
    visitor_.use_libraries(words_.take_rest());
  }

  void count_statement(std::string_view word) {
    if (word == "p" || word == "l")
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
    counts_.zeroed.texcoords += zero_if_not_finite(std::span(texcoord).first<2>());
    count_one(texcoords_);
    visitor_.add_texcoord({texcoord[0], texcoord[1]});
  }

  void read_normal() {
    std::array<float, 3> normal{};
    for (float& part : normal)
      part = words_.take_any_float("a normal");
    words_.expect_line_end();
    counts_.zeroed.normals += zero_if_not_finite(normal);
    count_one(normals_);
    visitor_.add_normal({normal[0], normal[1], normal[2]});
  }

  void read_face() {
    corners_.clear();
    while (words_.to_word()) {
      corners_.push_back(parse_corner(words_.take_word()));
      if (corners_.size() > PolygonCut::kMostCorners)
        words_.fail(PolygonCut::limit_text());
    }
    ++counts_.faces;
    counts_.degenerate_triangles += corners_.size() < 3 ? 1 : 0;
    add_polygon();
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
    auto index = parse_integer(text);
    if (!index) {
      index = parse_whole(text);
      counts_.odd.integers += index ? 1 : 0;
    }
    const auto count = static_cast<std::int64_t>(kind.count);
    constexpr auto kMost = static_cast<std::int64_t>(kMostElements);
    if (!index || *index == 0 || *index >= kMost || *index < -count) {
      words_.fail(
          fmt::format("expected the number of a {} from 1 on, or from -1 to -{}, found {} in {}",
                      kind.name, count, in_quotes(text), in_quotes(corner)));
    }
    const std::int64_t number = *index > 0 ? *index : count + *index + 1;
    note(kind, static_cast<std::uint64_t>(number), words_.line());
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

  TextStream none_;
  WordStream words_;
  std::uint64_t line_ = 1;  ///< number of the line that is taken
  Cursor at_;
  const std::filesystem::path& path_;
  ObjVisitor& visitor_;
  Kind positions_{"vertex"}, texcoords_{"texture coordinate"}, normals_{"normal"};
  std::vector<ObjCorner> corners_;  ///< corners of a face
  PolygonCut cut_;
  ObjCounts counts_;
};

ObjReader::ObjReader(const std::filesystem::path& path, ObjVisitor& visitor)
    : impl_(std::make_unique<Impl>(path, visitor)) {}
ObjReader::~ObjReader() = default;

void ObjReader::take(const ObjBlock& block) {
  impl_->take(block);
}
void ObjReader::take_rest(InputStream& rest) {
  impl_->take_rest(rest);
}
ObjCounts ObjReader::finish() {
  return impl_->finish();
}

bool is_obj_statement(std::string_view word) {
  return is_one_of(word, kRead) || is_one_of(word, kIgnored);
}

ObjCounts read_obj(InputStream& stream, const std::filesystem::path& path, ObjVisitor& visitor) {
  LineBlocks lines(stream);
  ObjReader reader(path, visitor);
  for (ObjBlock block; lines.next(block.text);) {
    parse(block);
    reader.take(block);
  }
  reader.take_rest(lines.rest());
  return reader.finish();
}

}  // namespace meshhier::mesh_io
