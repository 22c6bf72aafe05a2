#include "mesh_io/stl_block.h"

#include "mesh_io/coordinate_range.h"
#include "mesh_io/line_parser.h"
#include "mesh_io/number_text.h"
#include "mesh_io/word_stream.h"

#include <cmath>

namespace meshhier::mesh_io {
namespace {

std::string_view trimmed_name(std::string_view text) {
  while (!text.empty() && is_blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back()))
    text.remove_suffix(1);
  return text;
}

class StlBlockParser {
 public:
  explicit StlBlockParser(StlBlock& block)
      : block_(block), line_(block.text.data(), block.text.data() + block.text.size()) {}

  bool run() {
    bool is_first = true;
    while (line_.has_more()) {
      line_.skip_blanks();
      if (line_.is_at_end()) {
        end_line();
        continue;
      }
      const std::string_view word = line_.take_word();
      const bool begins_solid = is_stl_keyword(word, "solid");
      if (is_first)
        block_.begins_in_solid = block_.ends_in_solid = !begins_solid;
      is_first = false;
      if (block_.ends_in_solid == begins_solid)
        return false;
      if (begins_solid || is_stl_keyword(word, "endsolid")) {
        block_.ends_in_solid = begins_solid;
        const char* const name = line_.at();
        line_.skip_line();
        if (begins_solid)
          block_.solids.push_back({block_.facets.size(), trimmed_name({name, line_.at()})});
        end_line();
      } else if (!is_stl_keyword(word, "facet") || !take_facet()) {
        return false;
      }
    }
    return !is_first;
  }

 private:
  /// Takes a facet behind its first word.
  bool take_facet() {
    skip_line();  // the normal
    if (!takes("outer"))
      return false;
    skip_line();
    SoupTriangle facet;
    for (Vec3d& corner : facet) {
      if (!takes("vertex") || !take_corner(corner))
        return false;
    }
    block_.facets.push_back(facet);
    return takes("endloop") && takes_line_end() && takes("endfacet") && takes_line_end();
  }

  bool take_corner(Vec3d& corner) {
    for (double* coordinate : {&corner.x, &corner.y, &corner.z}) {
      line_.skip_blanks();
      const std::string_view word = line_.take_number();
      const auto number = parse_decimal(word);
      if (!number || word.size() > WordStream::kMaxWordBytes || !is_coordinate(number->value))
        return false;
      *coordinate = number->value;
      block_.fits_float = block_.fits_float && number->fits_float;
    }
    return takes_line_end();
  }

  bool takes(std::string_view keyword) {
    line_.skip_blanks();
    return is_stl_keyword(line_.take_word(), keyword);
  }
  bool takes_line_end() {
    line_.skip_blanks();
    if (!line_.is_at_end())
      return false;
    end_line();
    return true;
  }
  void skip_line() {
    line_.skip_line();
    end_line();
  }
  void end_line() {
    block_.lines += line_.has_more() ? 1 : 0;
    line_.take_line_end();
  }

  StlBlock& block_;
  LineParser line_;
};

/// Returns whether a line is the end of a facet and nothing else.
bool ends_facet(std::string_view line) {
  LineParser words(line.data(), line.data() + line.size());
  words.skip_blanks();
  if (!is_stl_keyword(words.take_word(), "endfacet"))
    return false;
  words.skip_blanks();
  return words.is_at_end();
}

}  // namespace

void parse_facets(StlBlock& block) {
  block.lines = 0;
  block.solids.clear();
  block.facets.clear();
  block.fits_float = true;
  block.is_plain = StlBlockParser(block).run();
}

std::size_t whole_facets(std::string_view text) {
  std::size_t end = text.size();
  while (end > 0) {
    // A CR at the very end may be half of a line's end.
    const std::size_t line_end = text.find_last_of("\r\n", end - 1);
    if (line_end == std::string_view::npos)
      return 0;
    const std::size_t before =
        line_end == 0 ? std::string_view::npos : text.find_last_of("\r\n", line_end - 1);
    const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
    const bool is_half = text[line_end] == '\r' && line_end + 1 == text.size();
    if (!is_half && before != std::string_view::npos &&
        ends_facet(text.substr(begin, line_end - begin))) {
      const bool is_two = text[line_end] == '\r' && text[line_end + 1] == '\n';
      return line_end + (is_two ? 2 : 1);
    }
    end = line_end;
  }
  return 0;
}

}  // namespace meshhier::mesh_io
