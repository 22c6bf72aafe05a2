#include "mesh_io/ply_lines.h"

#include "mesh_io/line_parser.h"
#include "mesh_io/number_text.h"
#include "mesh_io/ply_words.h"
#include "mesh_io/text_cursor.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::mesh_io {
namespace {

/// Read at once: whole blocks of the checksum.
constexpr std::uint64_t kUnit = storage::FileChecksum::kBlockBytes;

struct Lines {
  std::vector<char> text;   ///< whole lines
  std::uint64_t first = 0;  ///< row
  std::size_t rows = 0;     ///< if each line is one
  PlyPosition position;
};

/// Cuts the rows of an element into blocks.
class LineReader {
 public:
  LineReader(const InputFile& input, PlyPosition start, std::uint64_t rows)
      : input_(input), at_(start), read_to_(start.offset / kUnit * kUnit), rows_(rows) {}

  /// Returns false if no row or no whole line is left.
  bool next(Lines& block) {
    if (row_ == rows_)
      return false;
    block.text.assign(left_.begin(), left_.end());
    const std::size_t known = block.text.size();
    while (known == block.text.size() || !has_line_end(block.text, known)) {
      if (block.text.size() > kUnit || !read_unit(block.text))
        return false;
    }
    const std::string_view text(block.text.data(), block.text.size());
    const std::size_t lines = count_lines(text.substr(known));
    block.first = row_;
    block.rows = std::min<std::uint64_t>(lines, rows_ - row_);
    block.position = at_;
    // Lines behind the element's last row belong to the next element.
    const std::size_t end =
        block.rows == lines ? text.find_last_of('\n') + 1 : end_of_line(text, block.rows);
    left_.assign(text.substr(end));
    block.text.resize(end);
    row_ += block.rows;
    at_.offset += end;
    at_.line += block.rows;
    return true;
  }

 private:
  static bool has_line_end(const std::vector<char>& text, std::size_t from) {
    return std::memchr(text.data() + from, '\n', text.size() - from) != nullptr;
  }
  static std::size_t count_lines(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count(text, '\n'));
  }
  static std::size_t end_of_line(std::string_view text, std::size_t lines) {
    std::size_t end = 0;
    for (; lines > 0; --lines)
      end = text.find('\n', end) + 1;
    return end;
  }

  /// Returns false at the end of the file.
  bool read_unit(std::vector<char>& text) {
    if (read_to_ >= input_.bytes)
      return false;
    const std::size_t before = text.size();
    text.resize(before + std::min(kUnit, input_.bytes - read_to_));
    input_.read(read_to_, std::as_writable_bytes(std::span(text).subspan(before)));
    const bool begins_block = before == 0 && read_to_ <= at_.offset;
    if (begins_block)
      skip_to_row(text, at_.offset - read_to_);
    read_to_ += kUnit;
    return true;
  }

  /// Skips the rest of the line before, and blank lines.
  void skip_to_row(std::vector<char>& text, std::size_t begin) {
    const std::size_t given = begin;
    for (; begin < text.size() && (is_blank(text[begin]) || is_line_end(text[begin])); ++begin) {
      const bool is_lone_return =
          text[begin] == '\r' && (begin + 1 == text.size() || text[begin + 1] != '\n');
      if (is_lone_return)
        break;
      at_.line += text[begin] == '\n' ? 1 : 0;
    }
    at_.offset += begin - given;
    text.erase(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin));
  }

  InputFile input_;
  PlyPosition at_;         ///< the start of the next block
  std::uint64_t read_to_;  ///< multiple of kUnit
  std::uint64_t rows_;
  std::uint64_t row_ = 0;
  std::string left_;  ///< bytes from at_ on that were read and not handed out
};

/// One row; false where it is not as expected.
class RowParser {
 public:
  explicit RowParser(const std::vector<char>& text)
      : line_(text.data(), text.data() + text.size()) {}

  bool has_more() const { return line_.has_more(); }

  bool take_end() {
    line_.skip_blanks();
    if (!line_.is_at_end())
      return false;
    line_.take_line_end();
    return true;
  }
  /// Takes the next word, which is not empty.
  std::optional<std::string_view> take_word() {
    line_.skip_blanks();
    const std::string_view word = line_.take_word();
    return word.empty() || word.size() > TextCursor::kMaxWordBytes ? std::nullopt
                                                                   : std::optional(word);
  }
  std::optional<std::int64_t> take_index() {
    const auto word = take_word();
    return word ? parse_integer(*word) : std::nullopt;
  }
  std::optional<double> take_number(PlyType type) {
    const auto word = take_word();
    return word ? number_of(type, *word) : std::nullopt;
  }
  /// Takes the length of a list, at most as many as a line of sense has.
  std::optional<std::size_t> take_count(const PlyProperty& list) {
    constexpr std::int64_t kMost = 1 << 16;
    if (!list.count_type)
      return list.fixed_count;
    const auto word = take_word();
    const auto count = word ? integer_of(*list.count_type, *word) : std::nullopt;
    return count && *count >= 0 && *count <= kMost ? std::optional(static_cast<std::size_t>(*count))
                                                   : std::nullopt;
  }
  bool skip(const PlyProperty& property) {
    std::size_t words = 1;
    if (property.is_list()) {
      const auto count = take_count(property);
      if (!count)
        return false;
      words = *count;
    }
    for (; words > 0; --words) {
      if (!take_word())
        return false;
    }
    return true;
  }

 private:
  LineParser line_;
};

class VertexLines {
 public:
  VertexLines(const PlyPlan& plan, const MeshDescription& mesh)
      : vertices_(plan.elements[plan.vertex_element]), mesh_(mesh), checks_(plan.checks) {}

  struct Block {
    Lines lines;
    BlockMemory memory;
    std::optional<VertexBlock> vertices;  ///< if all lines are plain
  };

  bool can_read() const {
    return std::ranges::none_of(vertices_.element.properties, &PlyProperty::is_list);
  }

  void parse(Block& block) const {
    block.vertices.reset();
    const std::size_t count = block.lines.rows;
    if (count > MeshSource::kBlockSize)
      return;
    VertexRows rows(mesh_, count, block.memory);
    std::vector<VertexRows::Column> columns;
    for (const int slot : vertices_.slots)
      columns.push_back(slot == kSkipped ? VertexRows::Column{} : rows.column(0, slot));
    RowParser parser(block.lines.text);
    for (std::size_t row = 0; row < count; ++row) {
      if (!take_row(parser, columns))
        return;
    }
    if (parser.has_more())
      return;
    const ZeroedCounts zeroed = rows.zero_what_is_not_finite(0, count);
    if (!rows.find_defect(0, count, checks_))
      block.vertices = rows.block(block.lines.first, count, zeroed);
  }

 private:
  /// Goes on to the next row of the columns.
  bool take_row(RowParser& parser, std::vector<VertexRows::Column>& columns) const {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const PlyProperty& property = vertices_.element.properties[i];
      VertexRows::Column& column = columns[i];
      if (column.data == nullptr) {
        if (!parser.skip(property))
          return false;
        continue;
      }
      const auto value = parser.take_number(property.type);
      if (!value)
        return false;
      VertexRows::put(column, *value);
      column.data += column.stride;
    }
    return parser.take_end();
  }

  const PlyElementPlan& vertices_;
  const MeshDescription& mesh_;
  RowChecks checks_;
};

class PolygonLines {
 public:
  PolygonLines(const PlyElementPlan& faces, std::uint64_t vertex_count)
      : faces_(faces), vertex_count_(vertex_count) {}

  struct Block {
    Lines lines;
    bool is_plain = false;
    std::vector<std::uint32_t> corners;
    std::vector<std::uint32_t> lengths;  ///< lengths of the polygons, unless all have three corners
  };

  bool can_read() const { return faces_.role == PlyElementPlan::Role::polygons; }

  void parse(Block& block) const {
    block.corners.clear();
    block.lengths.clear();
    RowParser parser(block.lines.text);
    block.is_plain = false;
    for (std::size_t row = 0; row < block.lines.rows; ++row) {
      if (!take_row(parser, block, row))
        return;
    }
    block.is_plain = !parser.has_more();
  }

 private:
  bool take_row(RowParser& parser, Block& block, std::size_t row) const {
    for (std::size_t i = 0; i < faces_.element.properties.size(); ++i) {
      const PlyProperty& property = faces_.element.properties[i];
      if (i != faces_.corners ? !parser.skip(property)
                              : !take_corners(parser, property, block, row))
        return false;
    }
    return parser.take_end();
  }

  bool take_corners(RowParser& parser, const PlyProperty& property, Block& block,
                    std::size_t row) const {
    const auto count = parser.take_count(property);
    if (!count)
      return false;
    // Lengths are written from the first other polygon on: most files have triangles alone.
    if (*count != 3 && block.lengths.empty())
      block.lengths.assign(row, 3);
    if (*count != 3 || !block.lengths.empty())
      block.lengths.push_back(static_cast<std::uint32_t>(*count));
    for (std::size_t i = 0; i < *count; ++i) {
      const auto corner = parser.take_index();
      if (!corner || *corner < 0 || static_cast<std::uint64_t>(*corner) >= vertex_count_)
        return false;
      block.corners.push_back(static_cast<std::uint32_t>(*corner));
    }
    return true;
  }

  const PlyElementPlan& faces_;
  std::uint64_t vertex_count_;
};

/// Adds what a block holds.
void add(const PolygonLines::Block& block, TriangleBlocks& blocks) {
  const std::vector<std::uint32_t>& corners = block.corners;
  if (block.lengths.empty()) {
    for (std::size_t i = 0; i < corners.size(); i += 3)
      blocks.add_triangle_face(corners[i], corners[i + 1], corners[i + 2]);
    return;
  }
  std::size_t next = 0;
  for (const std::uint32_t length : block.lengths) {
    blocks.begin_polygon();
    for (std::uint32_t i = 0; i < length; ++i)
      blocks.add_polygon_corner(corners[next++]);
    blocks.end_polygon();
  }
}

/// Reads up to the first block that take() does not take.
template <class Block, class Parse, class Take>
PlyLinesRead read_blocks(LineReader reader, PlyPosition start, const BlockRunner& runner,
                         const Parse& parse, const Take& take) {
  std::vector<Block> blocks(runner.in_flight);
  const auto block_of = [&](std::size_t i) -> Block& { return blocks[i % blocks.size()]; };
  PlyLinesRead done{0, start};
  runner.run({[&](std::size_t i) { return reader.next(block_of(i).lines); },
              [&](std::size_t i) { parse(block_of(i)); },
              [&](std::size_t i) {
                const Block& block = block_of(i);
                if (!take(block))
                  return false;
                const Lines& lines = block.lines;
                done = {
                    lines.first + lines.rows,
                    {lines.position.offset + lines.text.size(), lines.position.line + lines.rows}};
                return true;
              }});
  return done;
}

}  // namespace

PlyLinesRead read_vertex_lines(const InputFile& input, const PlyPlan& plan,
                               const MeshDescription& mesh, PlyPosition start,
                               const VertexVisitor& visit, const BlockRunner& runner) {
  const VertexLines lines(plan, mesh);
  if (!lines.can_read())
    return {0, start};
  return read_blocks<VertexLines::Block>(
      {input, start, mesh.vertex_count}, start, runner,
      [&](VertexLines::Block& block) { lines.parse(block); },
      [&](const VertexLines::Block& block) {
        if (block.vertices)
          visit(*block.vertices);
        return block.vertices.has_value();
      });
}

PlyLinesRead read_polygon_lines(const InputFile& input, const PlyElementPlan& faces,
                                std::uint64_t vertex_count, PlyPosition start,
                                TriangleBlocks& blocks, const BlockRunner& runner) {
  const PolygonLines lines(faces, vertex_count);
  if (!lines.can_read())
    return {0, start};
  return read_blocks<PolygonLines::Block>(
      {input, start, faces.element.count}, start, runner,
      [&](PolygonLines::Block& block) { lines.parse(block); },
      [&](const PolygonLines::Block& block) {
        if (block.is_plain)
          add(block, blocks);
        return block.is_plain;
      });
}

}  // namespace meshhier::mesh_io
