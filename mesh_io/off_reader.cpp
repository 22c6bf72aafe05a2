#include "mesh_io/off_reader.h"

#include "mesh_io/input_error.h"
#include "mesh_io/mesh_blocks.h"
#include "mesh_io/number_text.h"
#include "mesh_io/word_stream.h"

#include <array>
#include <cmath>
#include <span>
#include <string>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// What the first word says of the vertices.
struct Keyword {
  bool is_off = false;
  bool texcoords = false;
  bool colours = false;
  bool normals = false;
  bool more_dimensions = false;  ///< 4 or n
  std::string_view glued;        ///< digits right behind it: the count of vertices, as in ModelNet
};

Keyword parse_keyword(std::string_view word) {
  Keyword keyword;
  const auto take = [&](std::string_view prefix) {
    const bool is_there = word.starts_with(prefix);
    word.remove_prefix(is_there ? prefix.size() : 0);
    return is_there;
  };
  keyword.texcoords = take("ST");
  keyword.colours = take("C");
  keyword.normals = take("N");
  keyword.more_dimensions = take("4");
  keyword.more_dimensions = take("n") || keyword.more_dimensions;
  keyword.is_off = take("OFF");
  if (!word.empty() && keyword.is_off) {
    keyword.glued = word;
    keyword.is_off = word.find_first_not_of("0123456789") == std::string_view::npos;
  }
  return keyword;
}

bool is_byte_integer(std::string_view word) {
  const auto value = parse_integer(word);
  return value && *value >= 0 && *value <= 255;
}

class OffReader {
 public:
  OffReader(InputStream& stream, const std::filesystem::path& path)
      : words_(stream, path, {.cuts_words = true}) {}

  OffCounts read(const OffVertexVisitor& visit_vertex, const TriangleVisitor& visit_triangles,
                 const OffFaceVisitor& visit_face, const PlaceOf& place_of) {
    read_header();
    for (std::uint64_t i = 0; i < counts_.vertices; ++i)
      read_vertex(i, visit_vertex);
    if (counts_.attributes.colour != ColourType::none)
      counts_.attributes.colour = byte_colours_ ? ColourType::u8 : ColourType::f32;
    TriangleBlocks blocks(visit_triangles, &place_of);
    for (std::uint64_t i = 0; i < face_count_; ++i)
      read_face(i, blocks, visit_face);
    // Where lines say nothing, a number too many may be one that was taken for another.
    if (is_wrapped_ && words_.to_row())
      words_.fail("expected the end of the file behind the faces, found " +
                  in_quotes(words_.take_word()));
    for (; words_.to_row(); ++counts_.lines_behind)
      words_.skip_line();
    counts_.faces = blocks.finish();
    return counts_;
  }

 private:
  void read_header() {
    const std::string word(words_.to_row() ? words_.take_word() : std::string_view());
    const Keyword keyword = parse_keyword(word);
    if (!keyword.is_off)
      words_.fail("expected 'OFF', perhaps with ST, C or N before it");
    if (keyword.more_dimensions)
      words_.fail("expected three coordinates a vertex (OFF), found a file of four or more");
    counts_.attributes.normals = keyword.normals;
    counts_.attributes.colour = keyword.colours ? ColourType::f32 : ColourType::none;
    counts_.attributes.texcoords = keyword.texcoords;
    is_plain_ = counts_.attributes == AttributeLayout();
    if (!keyword.glued.empty()) {
      counts_.vertices = checked_count(keyword.glued, "vertices", UINT32_MAX);
    } else {
      if (!words_.to_word() && !words_.to_row())
        fail_truncated("the counts of vertices and faces");
      counts_.vertices = take_count("vertices", UINT32_MAX);
    }
    face_count_ = take_count("faces", UINT64_MAX >> 2);
    if (words_.to_word())
      words_.take_word();  // edges, which nobody counts
    words_.expect_line_end();
  }

  [[noreturn]] void fail_truncated(const std::string& what) const {
    words_.fail(fmt::format("expected {}, found the end of the file (truncated)", what));
  }

  std::uint64_t take_count(const char* what, std::uint64_t most) {
    return checked_count(words_.to_word() ? words_.take_word() : std::string_view(), what, most);
  }

  std::uint64_t checked_count(std::string_view word, const char* what, std::uint64_t most) const {
    const auto count = parse_integer(word);
    if (!count || *count < 0 || static_cast<std::uint64_t>(*count) > most) {
      words_.fail(fmt::format("expected the count of {} ({}), found {}", what,
                              word == "BINARY" ? "binary OFF is not read" : "an integer",
                              in_quotes(word)));
    }
    return static_cast<std::uint64_t>(*count);
  }

  void read_vertex(std::uint64_t number, const OffVertexVisitor& visit) {
    if (!words_.to_row())
      fail_truncated(fmt::format("vertex {} of {}", number, counts_.vertices));
    if (number == 0 && is_plain_)
      look_at_first_row();
    const Vec3d position = words_.take_position(counts_.fits_float, &counts_.unplaced);
    take_attributes(number == 0);
    visit(position, std::span(channels_).first(channel_count_));
  }

  /// Numbers of a file may be in lines of any length: vertices of three numbers then.
  void look_at_first_row() {
    constexpr std::size_t kPosition = 3, kWithColour = 7;
    const std::size_t words = words_.words_ahead(kWithColour + 1);
    if (words < kPosition || words > kWithColour)
      join_lines();
  }

  void join_lines() {
    is_wrapped_ = true;
    words_.join_all_lines();
  }

  void take_attributes(bool is_first) {
    AttributeLayout& layout = counts_.attributes;
    std::array<bool, kMaxChannels> are_bytes{};
    channel_count_ = 0;
    if (is_wrapped_)
      return;
    while (channel_count_ < channels_.size() && words_.to_word()) {
      const std::string_view word = words_.take_word();
      const auto value = parse_real<float>(word);
      if (!value)
        words_.fail("expected a number for an attribute, found " + in_quotes(word));
      are_bytes[channel_count_] = is_byte_integer(word);
      channels_[channel_count_++] = *value;
    }
    const auto expected = [&] { return static_cast<std::size_t>(layout.channels()); };
    // MeshLab and others write colours without saying so in the first line.
    if (is_first && is_plain_ && (channel_count_ == 3 || channel_count_ == 4))
      layout.colour = ColourType::f32;
    if (is_first && layout.colour != ColourType::none)
      layout.alpha = channel_count_ == expected() + 1;
    if (channel_count_ != expected() || words_.to_word()) {
      words_.fail(
          fmt::format("expected {} numbers behind the coordinates, as the first line and "
                      "the first vertex say, found {}",
                      expected(), channel_count_));
    }
    counts_.zeroed += zero_what_is_not_finite(layout, std::span(channels_).first(channel_count_));
    for (int i = 0; i < layout.colour_channels(); ++i) {
      const auto channel = static_cast<std::size_t>(layout.colour_offset() + i);
      if (!std::isfinite(channels_[channel]))
        words_.fail(
            fmt::format("expected a finite number for a colour, found {}", channels_[channel]));
      byte_colours_ = byte_colours_ && are_bytes[channel];
    }
  }

  void read_face(std::uint64_t number, TriangleBlocks& blocks, const OffFaceVisitor& visit) {
    if (!words_.to_row())
      fail_truncated(fmt::format("face {} of {}", number, face_count_));
    const std::string_view length = words_.take_word();
    const auto corners = parse_integer(length);
    if (!corners || *corners < 0)
      words_.fail("expected the number of a face's corners, found " + in_quotes(length));
    if (number == 0 && !is_wrapped_)
      look_at_first_face(static_cast<std::uint64_t>(*corners));
    blocks.begin_polygon();
    for (std::int64_t i = 0; i < *corners; ++i)
      blocks.add_polygon_corner(take_corner(number));
    blocks.end_polygon();
    visit(blocks.triangles(), is_wrapped_ ? std::nullopt : take_face_colour());
  }

  /// What is left of the line. One number is that of a colour in a table that nobody has.
  std::optional<OffColour> take_face_colour() {
    OffColour colour;
    colour.are_bytes = true;
    bool is_sound = true;
    std::size_t count = 0;
    for (; words_.to_word() && count < colour.numbers.size(); ++count) {
      const std::string_view word = words_.take_word();
      const auto value = parse_real<float>(word);
      is_sound = is_sound && value && std::isfinite(*value);
      colour.are_bytes = colour.are_bytes && is_byte_integer(word);
      colour.numbers[count] = value.value_or(0);
    }
    if (count == 0)
      return std::nullopt;
    is_sound = is_sound && count >= 3 && !words_.to_word();
    words_.skip_line();
    counts_.unknown_colours += is_sound ? 0 : 1;
    colour.has_alpha = count == colour.numbers.size();
    return is_sound ? std::optional(colour) : std::nullopt;
  }

  /// A colour has one number, three or four.
  void look_at_first_face(std::uint64_t corners) {
    constexpr std::uint64_t kMostCorners = 50;
    constexpr std::size_t kColour = 4;
    const std::size_t words = words_.words_ahead(64);
    if (corners <= kMostCorners && words > corners + kColour)
      join_lines();
  }

  std::uint32_t take_corner(std::uint64_t face) {
    if (!words_.to_word())
      words_.fail(fmt::format("expected a corner of face {}, found the end of the line", face));
    const std::string_view word = words_.take_word();
    const auto corner = parse_integer(word);
    if (!corner || *corner < 0 || static_cast<std::uint64_t>(*corner) >= counts_.vertices) {
      words_.fail(fmt::format("expected a vertex from 0 to {} in face {}, found {}",
                              static_cast<std::int64_t>(counts_.vertices) - 1, face,
                              in_quotes(word)));
    }
    return static_cast<std::uint32_t>(*corner);
  }

  WordStream words_;
  std::array<float, kMaxChannels> channels_{};
  std::size_t channel_count_ = 0;
  std::uint64_t face_count_ = 0;
  bool is_plain_ = false;    ///< the first line says nothing of attributes
  bool is_wrapped_ = false;  ///< lines end anywhere
  bool byte_colours_ = true;
  OffCounts counts_;
};

}  // namespace

bool is_off_keyword(std::string_view word) {
  return parse_keyword(word).is_off;
}

OffCounts read_off(InputStream& stream, const std::filesystem::path& path,
                   const OffVertexVisitor& visit_vertex, const TriangleVisitor& visit_triangles,
                   const OffFaceVisitor& visit_face, const PlaceOf& place_of) {
  return OffReader(stream, path).read(visit_vertex, visit_triangles, visit_face, place_of);
}

}  // namespace meshhier::mesh_io
