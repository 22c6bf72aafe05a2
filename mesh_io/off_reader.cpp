#include "mesh_io/off_reader.h"

#include "mesh_io/coordinate_range.h"
#include "mesh_io/input_error.h"
#include "mesh_io/line_blocks.h"
#include "mesh_io/mesh_blocks.h"
#include "mesh_io/number_text.h"
#include "mesh_io/word_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

/// The first word, which says what vertices have.
struct Keyword {
  bool is_off = false;
  bool texcoords = false;
  bool colours = false;
  bool normals = false;
  bool more_dimensions = false;  ///< 4 or n
  bool is_odd = false;           ///< written in small letters
  std::string_view glued;        ///< digits right behind it: the count of vertices, as in ModelNet
};

Keyword parse_capitals(std::string_view word) {
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

/// Reads a keyword, also in other letters, but for "noff", which may be NOFF or nOFF.
Keyword parse_keyword(std::string_view word) {
  const Keyword given = parse_capitals(word);
  std::string capitals(word);
  for (char& c : capitals)
    c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  if (given.is_off || capitals.find('N') != std::string::npos)
    return given;
  Keyword odd = parse_capitals(capitals);
  odd.glued = word.substr(word.size() - odd.glued.size());
  odd.is_odd = true;
  return odd;
}

bool is_byte_integer(std::string_view word) {
  const auto value = parse_integer(word);
  return value && *value >= 0 && *value <= 255;
}

/// Some texts, then the rest of the lines.
class TextsThenRest final : public InputStream {
 public:
  explicit TextsThenRest(LineBlocks& lines) : lines_(lines) {}

  void add(std::span<const char> text) { text_.insert(text_.end(), text.begin(), text.end()); }
  /// Returns the texts that are left, and the last bytes of those that were read.
  std::vector<char> text_behind(std::size_t last) const {
    return {text_.begin() + static_cast<std::ptrdiff_t>(read_ - last), text_.end()};
  }
  bool has_read_beyond() const { return has_read_beyond_; }

  std::size_t read(std::span<std::byte> to) override {
    const std::size_t count = std::min(to.size(), text_.size() - read_);
    if (count > 0)
      std::memcpy(to.data(), text_.data() + read_, count);
    read_ += count;
    if (count == to.size())
      return count;
    const std::size_t more = lines_.rest().read(to.subspan(count));
    has_read_beyond_ = has_read_beyond_ || more > 0;
    return count + more;
  }

 private:
  LineBlocks& lines_;
  std::vector<char> text_;
  std::size_t read_ = 0;
  bool has_read_beyond_ = false;
};

/// The header and the first vertex are read by words: they say what is in the lines that follow.
/// These are parsed in blocks, up to one that is not as programs write them; from there on all is
/// read by words.
class OffReader {
 public:
  OffReader(InputStream& stream, const std::filesystem::path& path)
      : lines_(stream),
        start_(lines_),
        behind_(lines_),
        words_(begin(), path, {.cuts_words = true}) {}

  OffCounts read(const OffVertexVisitor& visit_vertex, const TriangleVisitor& visit_triangles,
                 const OffFaceVisitor& visit_face, const PlaceOf& place_of,
                 const BlockRunner& runner) {
    read_header();
    TriangleBlocks blocks(visit_triangles, &place_of);
    if (counts_.vertices > 0)
      read_vertex(vertex_++, visit_vertex);
    if (!is_wrapped_ && !start_.has_read_beyond())
      read_blocks(visit_vertex, blocks, visit_face, runner);
    while (vertex_ < counts_.vertices)
      read_vertex(vertex_++, visit_vertex);
    if (counts_.attributes.has_colours())
      counts_.attributes.colour = byte_colours_ ? ColourType::u8 : ColourType::f32;
    while (face_ < face_count_)
      read_face(face_++, blocks, visit_face);
    // In a file whose lines end anywhere, a number too many may mean that another was taken for it.
    if (is_wrapped_ && words_.to_row())
      words_.fail("expected the end of the file behind the faces, found " +
                  in_quotes(words_.take_word()));
    for (; words_.to_row(); ++counts_.odd.lines_behind)
      words_.skip_line();
    counts_.faces = blocks.finish();
    return counts_;
  }

 private:
  /// Begins with two blocks: words look ahead.
  InputStream& begin() {
    std::vector<char> block;
    for (int i = 0; i < 2 && lines_.next(block); ++i)
      start_.add(block);
    return start_;
  }

  void read_blocks(const OffVertexVisitor& visit_vertex, TriangleBlocks& blocks,
                   const OffFaceVisitor& visit_face, const BlockRunner& runner) {
    std::vector<OffLines> slots(runner.in_flight);
    const auto slot = [&](std::size_t i) -> OffLines& { return slots[i % slots.size()]; };
    std::size_t read = 0, taken = 0;
    std::size_t taken_bytes = 0;  // bytes taken of the first block that was not taken as a whole
    std::uint64_t line = words_.line();
    const auto read_block = [&](std::size_t i) {
      std::vector<char>& text = slot(i).text;
      if (i > 0 && !lines_.next(text))
        return false;
      if (i == 0)
        text = start_.text_behind(words_.bytes_ahead());
      read = i + 1;
      return true;
    };
    const auto take_block = [&](std::size_t i) {
      const OffLines& block = slot(i);
      taken_bytes = take_lines(block, visit_vertex, blocks, visit_face);
      const bool is_whole = taken_bytes == block.text.size();
      line += is_whole ? block.lines : count_lines(std::span(block.text).first(taken_bytes));
      taken += is_whole ? 1 : 0;
      return is_whole;
    };
    runner.run({read_block, [&](std::size_t i) { parse_off_lines(slot(i)); }, take_block});
    for (std::size_t i = taken; i < read; ++i)
      behind_.add(std::span(slot(i).text).subspan(i == taken ? taken_bytes : 0));
    words_.go_on(behind_, line);
  }

  /// Returns of how many bytes all was taken.
  std::size_t take_lines(const OffLines& block, const OffVertexVisitor& visit_vertex,
                         TriangleBlocks& blocks, const OffFaceVisitor& visit_face) {
    std::size_t first = 0;
    for (const OffLines::Row& row : block.rows) {
      const auto numbers = std::span(block.numbers).subspan(first, row.count);
      first += row.count;
      const bool is_taken = vertex_ < counts_.vertices ? take_vertex(numbers, visit_vertex)
                                                       : take_face(numbers, blocks, visit_face);
      if (!is_taken)
        return row.offset;
    }
    return block.plain_bytes;
  }

  /// A line as it should be, else false.
  bool take_vertex(std::span<const OffNumber> numbers, const OffVertexVisitor& visit) {
    const AttributeLayout& layout = counts_.attributes;
    const auto attributes = static_cast<std::size_t>(layout.channels());
    if (numbers.size() != 3 + attributes)
      return false;
    for (std::size_t i = 0; i < attributes; ++i) {
      channels_[i] = static_cast<float>(numbers[3 + i].value);
      if (!std::isfinite(channels_[i]))
        return false;
    }
    const auto position = numbers.first(3);
    if (!std::ranges::all_of(position, [](const OffNumber& n) { return is_coordinate(n.value); }))
      return false;
    for (const OffNumber& number : position)
      counts_.fits_float = counts_.fits_float && number.fits_float;
    const auto colour = layout.part(AttributeKind::colours).of(numbers.subspan(3));
    byte_colours_ = byte_colours_ && std::ranges::all_of(colour, is_byte);
    visit({position[0].value, position[1].value, position[2].value},
          std::span(channels_).first(attributes));
    ++vertex_;
    return true;
  }
  static bool is_byte(const OffNumber& number) {
    return number.is_integer && number.value >= 0 && number.value <= 255;
  }

  /// Takes a face, likewise.
  bool take_face(std::span<const OffNumber> numbers, TriangleBlocks& blocks,
                 const OffFaceVisitor& visit) {
    const OffNumber& length = numbers[0];
    const bool is_face = face_ < face_count_ && length.is_integer && length.value >= 3 &&
                         length.value < static_cast<double>(numbers.size());
    if (!is_face)
      return false;
    const auto corners = numbers.subspan(1, static_cast<std::size_t>(length.value));
    const auto rest = numbers.subspan(1 + corners.size());
    const auto is_corner = [&](const OffNumber& n) {
      return n.is_integer && n.value >= 0 && n.value < static_cast<double>(counts_.vertices);
    };
    if (rest.size() > kColourNumbers || !std::ranges::all_of(corners, is_corner))
      return false;
    blocks.begin_polygon();
    for (const OffNumber& corner : corners)
      blocks.add_polygon_corner(static_cast<std::uint32_t>(corner.value));
    blocks.end_polygon();
    visit(blocks.triangles(), colour_of(rest));
    ++face_;
    return true;
  }

  std::optional<OffColour> colour_of(std::span<const OffNumber> numbers) {
    if (numbers.empty())
      return std::nullopt;
    OffColour colour;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      colour.numbers[i] = static_cast<float>(numbers[i].value);
    colour.are_bytes = std::ranges::all_of(numbers, is_byte);
    colour.has_alpha = numbers.size() == kColourNumbers;
    const bool is_sound = numbers.size() >= 3 && std::ranges::all_of(colour.numbers, [](float n) {
                            return std::isfinite(n);
                          });
    counts_.unknown_colours += is_sound ? 0 : 1;
    return is_sound ? std::optional(colour) : std::nullopt;
  }

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
    const bool is_split = !words_.to_word() && words_.to_row();
    face_count_ = take_count("faces", UINT64_MAX >> 2);
    const bool has_line_of_edges = !words_.to_word() && are_edges_next(is_split);
    if (has_line_of_edges)
      words_.to_row();
    if (words_.to_word())
      words_.take_word();  // edges, which nobody counts
    words_.expect_line_end();
    counts_.odd.header_lines += (keyword.is_odd ? 1 : 0) + (is_split || has_line_of_edges ? 1 : 0);
  }

  /// Returns whether the next line is the count of edges: a number alone, in front of a vertex or
  /// behind other counts alone.
  bool are_edges_next(bool is_split) {
    constexpr std::size_t kPosition = 3;
    return words_.words_ahead(2, 1) == 1 &&
           (is_split || words_.words_ahead(kPosition, 2) == kPosition);
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
        words_.fail("expected a number for an attribute, found " + number_in_quotes(word));
      are_bytes[channel_count_] = is_byte_integer(word);
      channels_[channel_count_++] = *value;
    }
    const auto expected = [&] { return static_cast<std::size_t>(layout.channels()); };
    // MeshLab and others write colours without saying so in the first line.
    if (is_first && is_plain_ && (channel_count_ == 3 || channel_count_ == 4))
      layout.colour = ColourType::f32;
    if (is_first && layout.has_colours())
      layout.alpha = channel_count_ == expected() + 1;
    if (channel_count_ != expected() || words_.to_word()) {
      words_.fail(
          fmt::format("expected {} numbers behind the coordinates, as the first line and "
                      "the first vertex say, found {}",
                      expected(), channel_count_));
    }
    const AttributeParts parts = layout.parts();
    counts_.zeroed += zero_what_is_not_finite(parts, std::span(channels_).first(channel_count_));
    const AttributePart& colours = part_of(parts, AttributeKind::colours);
    for (std::size_t channel = colours.first; channel < colours.end(); ++channel) {
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
    const auto corners = take_integer(length);
    if (!corners || *corners < 0)
      words_.fail("expected the number of a face's corners, found " + in_quotes(length));
    if (static_cast<std::uint64_t>(*corners) > PolygonCut::kMostCorners)
      words_.fail(PolygonCut::limit_text());
    if (number == 0 && !is_wrapped_)
      look_at_first_face(static_cast<std::uint64_t>(*corners));
    blocks.begin_polygon();
    for (std::int64_t i = 0; i < *corners; ++i)
      blocks.add_polygon_corner(take_corner(number));
    blocks.end_polygon();
    visit(blocks.triangles(), is_wrapped_ ? std::nullopt : take_face_colour());
  }

  /// Takes the rest of the line. A single number is that of a colour in a table that nobody has.
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
    const std::size_t words = words_.words_ahead(64);
    if (corners <= kMostCorners && words > corners + kColourNumbers)
      join_lines();
  }

  std::optional<std::int64_t> take_integer(std::string_view word) {
    if (const auto integer = parse_integer(word))
      return integer;
    const auto odd = parse_whole(word);
    counts_.odd.integers += odd ? 1 : 0;
    return odd;
  }

  std::uint32_t take_corner(std::uint64_t face) {
    if (!words_.to_word())
      words_.fail(fmt::format("expected a corner of face {}, found the end of the line", face));
    const std::string_view word = words_.take_word();
    const auto corner = take_integer(word);
    if (!corner || *corner < 0 || static_cast<std::uint64_t>(*corner) >= counts_.vertices) {
      words_.fail(fmt::format("expected a vertex from 0 to {} in face {}, found {}",
                              static_cast<std::int64_t>(counts_.vertices) - 1, face,
                              in_quotes(word)));
    }
    return static_cast<std::uint32_t>(*corner);
  }

  static constexpr std::size_t kColourNumbers = 4;

  LineBlocks lines_;
  TextsThenRest start_;   ///< the first blocks
  TextsThenRest behind_;  ///< the blocks that were not taken
  WordStream words_;
  std::uint64_t vertex_ = 0, face_ = 0;  ///< the next ones
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
                   const OffFaceVisitor& visit_face, const PlaceOf& place_of,
                   const BlockRunner& runner) {
  return OffReader(stream, path).read(visit_vertex, visit_triangles, visit_face, place_of, runner);
}

}  // namespace meshhier::mesh_io
