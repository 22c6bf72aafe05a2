#include "drawing/line_formats.h"
#include "drawing/line_label.h"
#include "drawing/line_widths.h"

#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace meshhier::drawing {
namespace {

constexpr double kLabelHeight = 2;  // millimetres
/// A label takes less than this of its line.
constexpr double kLeastLabelled = 20;

std::string escaped(std::string_view text) {
  std::string made;
  for (const char c : text) {
    made += c == '&'   ? std::string("&amp;")
            : c == '<' ? std::string("&lt;")
            : c == '>' ? std::string("&gt;")
                       : std::string(1, c);
  }
  return made;
}

/// Millimetres to a tenth of a micrometre.
std::string mm(double value) {
  std::string text = fmt::format("{:.4f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.'))
    text.pop_back();
  return text == "-0" ? "0" : text;
}

class SvgWriter final : public LineWriter {
 public:
  SvgWriter(const LineDrawing& drawing, exporting::ByteStream& out)
      : drawing_(drawing), paper_(*drawing.paper), out_(out) {
    write_head();
    write_grid();
  }

  void begin(const JoinedLine& line) override {
    if (line.level != level_)
      begin_level(line.level);
    is_closed_ = line.is_closed;
    const double length = line.length * drawing_.sheet.map.scale() * paper_.mm_per_unit;
    if (drawing_.levels[line.level].is_index && length >= kLeastLabelled)
      label_.emplace(length / 2);
    out_.put("<path d=\"");
    command_ = 'M';
  }

  void point(Vec3d place) override {
    const Vec3d on_sheet = drawing_.sheet.view.of_input(place);
    const PlanPoint at = paper_.on_paper(on_sheet.x, on_sheet.y);
    if (label_)
      label_->pass(at);
    out_.put(fmt::format("{}{} {}", command_, mm(at.x), mm(at.y)));
    command_ = command_ == 'M' ? 'L' : ' ';
  }

  void end() override {
    out_.put(is_closed_ ? "Z\"/>\n" : "\"/>\n");
    if (label_ && label_->label())
      labels_.push_back({*label_->label(), level_text(drawing_.levels[*level_].height)});
    label_.reset();
  }

  void finish() override {
    end_level();
    write_labels();
    write_marks();
    out_.put("</svg>\n");
  }

 private:
  struct Label {
    LineLabel place;
    std::string text;
  };

  void write_head() {
    out_.put(fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}mm\" height=\"{1}mm\" "
        "viewBox=\"0 0 {0} {1}\">\n<title>{2}</title>\n<desc>{3}; a millimetre is {4:.10g} "
        "{5}; the place {6} {6} of the paper is {7:.17g}, {8:.17g}{9}</desc>\n",
        mm(paper_.width), mm(paper_.height), escaped(drawing_.title), scale_text(paper_.scale),
        1 / paper_.mm_per_unit, drawing_.unit.name, mm(paper_.margin), paper_.left, paper_.top,
        escaped(drawing_.sheet.map.name.empty() ? "" : "; " + drawing_.sheet.map.name)));
    out_.put("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
  }

  void write_lines(const char* id, const char* colour, const std::vector<PaperLine>& lines) {
    if (lines.empty())
      return;
    out_.put(fmt::format("<g id=\"{}\" stroke=\"{}\">\n", id, colour));
    for (const PaperLine& line : lines) {
      out_.put(fmt::format("<path d=\"M{} {}L{} {}\" stroke-width=\"{}\"/>\n", mm(line.from.x),
                           mm(line.from.y), mm(line.to.x), mm(line.to.y), mm(line.width)));
    }
    out_.put("</g>\n");
  }

  void write_grid() { write_lines("grid", "#999", paper_.marks.grid); }

  void write_marks() {
    write_lines("scale-bar", "#000", paper_.marks.bar);
    out_.put(fmt::format("<g id=\"texts\" font-family=\"sans-serif\" font-size=\"{}\">\n",
                         mm(kTextHeight)));
    for (const PaperText& text : paper_.marks.texts) {
      constexpr std::array<const char*, 3> kAnchors{"start", "middle", "end"};
      out_.put(fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n", mm(text.at.x),
                           mm(text.at.y), kAnchors[static_cast<std::size_t>(text.anchor)],
                           escaped(text.text)));
    }
    out_.put("</g>\n");
  }

  void begin_level(std::uint32_t level) {
    end_level();
    level_ = level;
    const CutLevel& at = drawing_.levels[level];
    const char* kind = !drawing_.are_contours ? "section" : at.is_index ? "index" : "contour";
    const double width = !drawing_.are_contours ? kSectionWidth
                         : at.is_index          ? kIndexWidth
                                                : kContourWidth;
    out_.put(fmt::format(
        "<g class=\"{}\" data-level=\"{}\" fill=\"none\" stroke=\"{}\" "
        "stroke-width=\"{}\" stroke-linejoin=\"round\">\n",
        kind, level_text(at.height), drawing_.are_contours ? "#84532b" : "#000", width));
  }
  void end_level() {
    if (level_)
      out_.put("</g>\n");
    level_.reset();
  }

  /// Each is turned by a matrix: an angle would take a sine.
  void write_labels() {
    if (labels_.empty())
      return;
    out_.put(fmt::format(
        "<g id=\"labels\" font-family=\"sans-serif\" font-size=\"{}\" text-anchor=\"middle\" "
        "fill=\"#84532b\" stroke=\"#fff\" stroke-width=\"0.6\" paint-order=\"stroke\">\n",
        mm(kLabelHeight)));
    for (const Label& label : labels_) {
      const auto& [at, along] = label.place;
      out_.put(fmt::format(
          "<text transform=\"matrix({:.5f} {:.5f} {:.5f} {:.5f} {} {})\" dy=\"{}\">{}</text>\n",
          along.x, along.y, -along.y, along.x, mm(at.x), mm(at.y), mm(0.35 * kLabelHeight),
          label.text));
    }
    out_.put("</g>\n");
  }

  const LineDrawing& drawing_;
  const Paper& paper_;
  exporting::ByteStream& out_;
  std::optional<std::uint32_t> level_{};
  std::optional<LabelFinder> label_{};
  std::vector<Label> labels_{};
  bool is_closed_ = false;
  char command_ = 'M';
};

}  // namespace

std::unique_ptr<LineWriter> svg_writer(const LineDrawing& drawing, exporting::ByteStream& out) {
  return std::make_unique<SvgWriter>(drawing, out);
}

}  // namespace meshhier::drawing
