#include "mesh_io/obj_block.h"

#include "mesh_io/coordinate_range.h"
#include "mesh_io/line_parser.h"
#include "mesh_io/number_text.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace meshhier::mesh_io {
namespace {

class BlockParser {
 public:
  explicit BlockParser(ObjBlock& block)
      : block_(block), begin_(block.text.data()), end_(begin_ + block.text.size()) {}

  void run() {
    const char* at = begin_;
    while (at != end_ && block_.runs.size() < kMostRuns)
      at = parse_line(at);
    if (at == end_)
      return;
    ObjRun rest{.kind = ObjRun::Kind::others, .begin = static_cast<std::uint32_t>(at - begin_)};
    for (LineParser lines(at, end_); lines.has_more(); ++rest.lines) {
      lines.skip_line();
      lines.take_line_end();
    }
    block_.runs.push_back(rest);
  }

 private:
  /// Lines of many kinds one after the other are not worth more memory.
  static constexpr std::size_t kMostRuns = 16384;

  /// Returns where the next one begins.
  const char* parse_line(const char* at) {
    LineParser line(at, end_);
    ObjRun run{.lines = 1, .begin = static_cast<std::uint32_t>(at - begin_)};
    if (!parse_statement(line, run)) {
      line = LineParser(at, end_);
      run = {.kind = ObjRun::Kind::others, .lines = 0, .begin = run.begin};
      skip_joined_lines(line, run);
    } else {
      line.take_line_end();
    }
    if (!block_.runs.empty() && block_.runs.back().is_like(run))
      block_.runs.back().lines += run.lines;
    else
      block_.runs.push_back(run);
    return line.at();
  }

  /// Skips a line, with those that a backslash before a line's end may join.
  static void skip_joined_lines(LineParser& line, ObjRun& run) {
    bool is_joined = true;
    for (; is_joined && line.has_more(); ++run.lines) {
      const char* const first = line.at();
      line.skip_line();
      is_joined = line.at() != first && line.at()[-1] == '\\';
      line.take_line_end();
    }
  }

  bool parse_statement(LineParser& line, ObjRun& run) {
    line.skip_blanks();
    switch (line.next()) {
      case '\n':
      case '\r':
        return true;
      case '#':
        return parse_comment(line);
      case 'v':
        line.take('v');
        if (is_blank(line.next()))
          return parse_position(line, run);
        return line.take('t') ? parse_texcoord(line, run)
                              : line.take('n') && parse_normal(line, run);
      case 'f':
        line.take('f');
        return is_blank(line.next()) && parse_face(line, run);
      default:
        return false;
    }
  }

  bool parse_comment(LineParser& line) {
    if (std::string_view(line.at(), end_).starts_with(kObjPolypaint))
      return false;
    line.skip_line();
    return true;
  }

  bool parse_position(LineParser& line, ObjRun& run) {
    std::array<double, 6> numbers{};
    std::size_t count = 0;
    bool fits_float = true;
    for (line.skip_blanks(); !line.is_at_end(); line.skip_blanks()) {
      if (count == numbers.size())
        return false;
      const auto number = parse_decimal(line.take_number());
      if (!number || !std::isfinite(number->value))
        return false;
      fits_float = fits_float && (count >= 3 || number->fits_float);
      numbers[count++] = number->value;
    }
    const Vec3d position{numbers[0], numbers[1], numbers[2]};
    const bool is_in_range =
        is_coordinate(position.x) && is_coordinate(position.y) && is_coordinate(position.z);
    if ((count != 3 && count != 6) || !is_in_range)
      return false;
    run.kind = ObjRun::Kind::positions;
    if (count == 6) {
      const std::array colour{static_cast<float>(numbers[3]), static_cast<float>(numbers[4]),
                              static_cast<float>(numbers[5])};
      if (!std::isfinite(colour[0]) || !std::isfinite(colour[1]) || !std::isfinite(colour[2]))
        return false;
      run.kind = ObjRun::Kind::coloured;
      block_.colours.push_back(colour);
    }
    block_.positions.push_back(position);
    block_.fits_float = block_.fits_float && fits_float;
    return true;
  }

  /// Takes up to three numbers, all finite; returns how many, 4 if there is something else.
  static std::size_t take_floats(LineParser& line, std::array<float, 3>& numbers) {
    constexpr std::size_t kOther = 4;
    if (!is_blank(line.next()))
      return kOther;
    std::size_t count = 0;
    for (line.skip_blanks(); !line.is_at_end(); line.skip_blanks()) {
      if (count == numbers.size())
        return kOther;
      const auto number = parse_real<float>(line.take_number());
      if (!number || !std::isfinite(*number))
        return kOther;
      numbers[count++] = *number;
    }
    return count;
  }

  bool parse_texcoord(LineParser& line, ObjRun& run) {
    std::array<float, 3> numbers{};
    const std::size_t count = take_floats(line, numbers);
    if (count != 2 && count != 3)
      return false;
    run.kind = ObjRun::Kind::texcoords;
    block_.texcoords.push_back({numbers[0], numbers[1]});
    return true;
  }

  bool parse_normal(LineParser& line, ObjRun& run) {
    std::array<float, 3> numbers{};
    if (take_floats(line, numbers) != 3)
      return false;
    run.kind = ObjRun::Kind::normals;
    block_.normals.push_back(numbers);
    return true;
  }

  bool parse_face(LineParser& line, ObjRun& run) {
    const std::size_t before = block_.indices.size();
    run.kind = ObjRun::Kind::faces;
    if (take_corners(line, run))
      return true;
    block_.indices.resize(before);
    return false;
  }

  bool take_corners(LineParser& line, ObjRun& run) {
    constexpr std::uint8_t kMostCorners = std::numeric_limits<std::uint8_t>::max();
    for (line.skip_blanks(); !line.is_at_end(); line.skip_blanks()) {
      ObjRun corner;
      if (run.corners == kMostCorners || !take_corner(line, corner))
        return false;
      if (run.corners == 0) {
        run.has_texcoord = corner.has_texcoord;
        run.has_normal = corner.has_normal;
      }
      if (run.has_texcoord != corner.has_texcoord || run.has_normal != corner.has_normal)
        return false;
      ++run.corners;
    }
    return run.corners >= 3;
  }

  bool take_corner(LineParser& line, ObjRun& corner) {
    const auto take_index = [&] {
      const auto index = line.take_index();
      if (index)
        block_.indices.push_back(*index);
      return index.has_value();
    };
    if (!take_index())
      return false;
    if (line.take('/')) {
      corner.has_texcoord = line.next() != '/';
      if (corner.has_texcoord && !take_index())
        return false;
      corner.has_normal = line.take('/');
      if (corner.has_normal && !take_index())
        return false;
    }
    return line.is_at_end() || is_blank(line.next());
  }

  ObjBlock& block_;
  const char* begin_;
  const char* end_;
};

}  // namespace

void parse(ObjBlock& block) {
  block.runs.clear();
  block.positions.clear();
  block.colours.clear();
  block.texcoords.clear();
  block.normals.clear();
  block.indices.clear();
  block.fits_float = true;
  BlockParser(block).run();
}

}  // namespace meshhier::mesh_io
