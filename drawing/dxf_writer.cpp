// DXF of AutoCAD 2000 (AC1015): pairs of lines, a group's code and its value.
//
//     HEADER     unit, extent
//     TABLES     layers, and what every file has to have
//     BLOCKS     two empty ones, which stand for the model and the paper
//     ENTITIES   the lines: LWPOLYLINE at a height, POLYLINE in space; TEXT for labels
//     OBJECTS    an empty dictionary
//
// Lines of a plan lie at their heights, in east and north; those of other views in space, where
// they are on the model, or flat on the sheet.
#include "base/angle.h"
#include "base/bounds.h"
#include "drawing/line_formats.h"
#include "drawing/line_label.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace meshhier::drawing {
namespace {

/// $INSUNITS by the names of units.
constexpr std::array kDxfUnits{std::pair{Unit::mm, 4},    std::pair{Unit::cm, 5},
                               std::pair{Unit::m, 6},     std::pair{Unit::km, 7},
                               std::pair{Unit::in, 1},    std::pair{Unit::ft, 2},
                               std::pair{Unit::us_ft, 21}};

struct Layer {
  const char* name;
  int colour;  ///< AutoCAD's number
  int weight;  ///< hundredths of a millimetre
};
constexpr Layer kSectionLayer{"SECTION", 7, 35};
constexpr Layer kContourLayer{"CONTOUR", 33, 13};
constexpr Layer kIndexLayer{"CONTOUR_INDEX", 34, 35};
constexpr Layer kLabelLayer{"CONTOUR_LABEL", 34, 13};
constexpr std::array kLayers{Layer{"0", 7, -3}, kSectionLayer, kContourLayer, kIndexLayer,
                             kLabelLayer};

// Handles of what others refer to.
constexpr const char* kRootDictionary = "C";
constexpr const char* kModelSpace = "1F";
constexpr const char* kPaperSpace = "1B";

/// Takes groups. What has a handle of its own gets the next one.
class DxfGroups {
 public:
  explicit DxfGroups(exporting::ByteStream& out) : out_(out) {}

  template <class Value>
  DxfGroups& put(int code, const Value& value) {
    out_.put(fmt::format("{:3}\n{}\n", code, value));
    return *this;
  }
  DxfGroups& put(int code, bool value) { return put(code, value ? 1 : 0); }
  /// `code`: of x; y and z have those that follow by ten.
  DxfGroups& place(int code, Vec3d p) {
    return put(code, p.x).put(code + 10, p.y).put(code + 20, p.z);
  }
  DxfGroups& handle() { return put(5, fmt::format("{:X}", next_++)); }

 private:
  exporting::ByteStream& out_;
  std::uint64_t next_ = 0x100;
};

void put_header(DxfGroups& dxf, const LineDrawing& drawing, const BoundsD& extent) {
  const auto* unit = std::ranges::find(kDxfUnits, drawing.named_unit,
                                       [](const auto& row) { return std::optional(row.first); });
  dxf.put(0, "SECTION").put(2, "HEADER").put(9, "$ACADVER").put(1, "AC1015");
  dxf.put(9, "$DWGCODEPAGE").put(3, "ANSI_1252");
  dxf.put(9, "$INSUNITS").put(70, unit == kDxfUnits.end() ? 0 : unit->second);
  dxf.put(9, "$MEASUREMENT").put(70, 1);
  dxf.put(9, "$EXTMIN").place(10, extent.min).put(9, "$EXTMAX").place(10, extent.max);
  dxf.put(9, "$HANDSEED").put(5, "FFFFFFFFFFFF").put(0, "ENDSEC");
}

/// Begins a table of so many rows.
void put_table(DxfGroups& dxf, const char* name, const char* handle, std::size_t rows) {
  dxf.put(0, "TABLE").put(2, name).put(5, handle).put(330, 0);
  dxf.put(100, "AcDbSymbolTable").put(70, rows);
}

/// Begins a row of a table.
DxfGroups& put_row(DxfGroups& dxf, const char* kind, const char* table, const char* subclass,
                   const char* name) {
  dxf.put(0, kind).handle().put(330, table).put(100, "AcDbSymbolTableRecord");
  return dxf.put(100, subclass).put(2, name).put(70, 0);
}

void put_view_port(DxfGroups& dxf, const BoundsD& extent) {
  const Vec3d middle = (extent.min + extent.max) * 0.5;
  const double height = std::max({extent.max.y - extent.min.y, extent.max.x - extent.min.x, 1e-9});
  put_table(dxf, "VPORT", "8", 1);
  put_row(dxf, "VPORT", "8", "AcDbViewportTableRecord", "*Active");
  dxf.put(10, 0).put(20, 0).put(11, 1).put(21, 1).put(12, middle.x).put(22, middle.y);
  dxf.put(40, 1.1 * height).put(41, 1.5).put(0, "ENDTAB");
}

void put_tables(DxfGroups& dxf, const BoundsD& extent) {
  dxf.put(0, "SECTION").put(2, "TABLES");
  put_view_port(dxf, extent);
  put_table(dxf, "LTYPE", "5", 3);
  for (const char* name : {"ByBlock", "ByLayer", "Continuous"}) {
    put_row(dxf, "LTYPE", "5", "AcDbLinetypeTableRecord", name);
    dxf.put(3, "").put(72, 65).put(73, 0).put(40, 0);
  }
  dxf.put(0, "ENDTAB");
  put_table(dxf, "LAYER", "2", kLayers.size());
  for (const Layer& layer : kLayers) {
    put_row(dxf, "LAYER", "2", "AcDbLayerTableRecord", layer.name);
    dxf.put(62, layer.colour).put(6, "Continuous").put(370, layer.weight).put(390, "F");
  }
  dxf.put(0, "ENDTAB");
  put_table(dxf, "STYLE", "3", 1);
  put_row(dxf, "STYLE", "3", "AcDbTextStyleTableRecord", "Standard");
  dxf.put(40, 0).put(41, 1).put(50, 0).put(71, 0).put(42, 1).put(3, "txt").put(4, "");
  dxf.put(0, "ENDTAB");
  for (const auto& [name, handle] : {std::pair{"VIEW", "6"}, std::pair{"UCS", "7"}}) {
    put_table(dxf, name, handle, 0);
    dxf.put(0, "ENDTAB");
  }
  put_table(dxf, "APPID", "9", 1);
  put_row(dxf, "APPID", "9", "AcDbRegAppTableRecord", "ACAD").put(0, "ENDTAB");
  put_table(dxf, "DIMSTYLE", "A", 1);
  dxf.put(100, "AcDbDimStyleTable").put(71, 0).put(0, "DIMSTYLE").put(105, "27").put(330, "A");
  dxf.put(100, "AcDbSymbolTableRecord").put(100, "AcDbDimStyleTableRecord");
  dxf.put(2, "Standard").put(70, 0).put(0, "ENDTAB");
  put_table(dxf, "BLOCK_RECORD", "1", 2);
  for (const auto& [handle, name] :
       {std::pair{kModelSpace, "*Model_Space"}, std::pair{kPaperSpace, "*Paper_Space"}}) {
    dxf.put(0, "BLOCK_RECORD").put(5, handle).put(330, "1").put(100, "AcDbSymbolTableRecord");
    dxf.put(100, "AcDbBlockTableRecord").put(2, name).put(340, 0);
  }
  dxf.put(0, "ENDTAB").put(0, "ENDSEC");
}

void put_blocks(DxfGroups& dxf) {
  dxf.put(0, "SECTION").put(2, "BLOCKS");
  for (const auto& [record, name] :
       {std::pair{kModelSpace, "*Model_Space"}, std::pair{kPaperSpace, "*Paper_Space"}}) {
    dxf.put(0, "BLOCK").handle().put(330, record).put(100, "AcDbEntity").put(8, "0");
    dxf.put(100, "AcDbBlockBegin").put(2, name).put(70, 0).place(10, {}).put(3, name).put(1, "");
    dxf.put(0, "ENDBLK").handle().put(330, record).put(100, "AcDbEntity").put(8, "0");
    dxf.put(100, "AcDbBlockEnd");
  }
  dxf.put(0, "ENDSEC");
}

void put_objects(DxfGroups& dxf) {
  constexpr const char* kGroups = "D";
  dxf.put(0, "SECTION").put(2, "OBJECTS");
  dxf.put(0, "DICTIONARY").put(5, kRootDictionary).put(330, 0).put(100, "AcDbDictionary");
  dxf.put(281, 1).put(3, "ACAD_GROUP").put(350, kGroups);
  dxf.put(3, "ACAD_PLOTSTYLENAME").put(350, "E");
  dxf.put(0, "DICTIONARY").put(5, kGroups).put(330, kRootDictionary);
  dxf.put(100, "AcDbDictionary").put(281, 1);
  dxf.put(0, "ACDBDICTIONARYWDFLT").put(5, "E").put(330, kRootDictionary);
  dxf.put(100, "AcDbDictionary").put(281, 1).put(3, "Normal").put(350, "F");
  dxf.put(100, "AcDbDictionaryWithDefault").put(340, "F");
  dxf.put(0, "ACDBPLACEHOLDER").put(5, "F").put(330, "E");
  dxf.put(0, "ENDSEC").put(0, "EOF");
}

class DxfWriter final : public LineWriter {
 public:
  DxfWriter(const LineDrawing& drawing, exporting::ByteStream& out)
      : drawing_(drawing), dxf_(out), is_in_space_(!drawing.sheet.is_plan && !drawing.is_flat) {
    const BoundsD extent = extent_of();
    const double across = std::max(extent.max.x - extent.min.x, extent.max.y - extent.min.y);
    text_height_ = drawing.paper ? 2 / drawing.paper->mm_per_unit : across / 200;
    put_header(dxf_, drawing, extent);
    put_tables(dxf_, extent);
    put_blocks(dxf_);
    dxf_.put(0, "SECTION").put(2, "ENTITIES");
  }

  void begin(const JoinedLine& line) override {
    level_ = &drawing_.levels[line.level];
    is_closed_ = line.is_closed;
    const double length = line.length * drawing_.sheet.map.scale();
    if (level_->is_index && length >= kLeastLabelled * text_height_)
      label_.emplace(length / 2);
    if (is_in_space_)
      begin_in_space();
    else
      begin_at_height(line.points);
  }

  void point(Vec3d place) override {
    if (is_in_space_) {
      begin_entity("VERTEX");
      dxf_.put(100, "AcDbVertex").put(100, "AcDb3dPolylineVertex");
      dxf_.place(10, drawing_.sheet.map.of_input(place)).put(70, 32);
      return;
    }
    const Vec3d on_sheet = drawing_.sheet.view.of_input(place);
    dxf_.put(10, on_sheet.x).put(20, on_sheet.y);
    if (label_)
      label_->pass({on_sheet.x, on_sheet.y});
  }

  void end() override {
    if (is_in_space_)
      begin_entity("SEQEND");
    if (label_ && label_->label())
      put_label(*label_->label());
    label_.reset();
  }

  void finish() override {
    dxf_.put(0, "ENDSEC");
    put_objects(dxf_);
  }

 private:
  /// Lengths of a label's height.
  static constexpr double kLeastLabelled = 10;

  /// Of lines in space a box around them; else what the sheet has, at its heights.
  BoundsD extent_of() const {
    if (is_in_space_)
      return drawing_.sheet.map.around(
          {drawing_.manifest.source.bounds.min - drawing_.manifest.origin,
           drawing_.manifest.source.bounds.max - drawing_.manifest.origin});
    BoundsD extent = drawing_.box;
    extent.min.z = height_of(drawing_.levels[0]);
    extent.max.z = height_of(drawing_.levels[drawing_.levels.size() - 1]);
    return extent;
  }

  double height_of(const CutLevel& level) const {
    return drawing_.sheet.is_plan ? level.height : 0;
  }

  const char* layer() const {
    return (!drawing_.are_contours ? kSectionLayer
            : level_->is_index     ? kIndexLayer
                                   : kContourLayer)
        .name;
  }

  void begin_entity(const char* kind) {
    dxf_.put(0, kind).handle().put(330, kModelSpace).put(100, "AcDbEntity").put(8, layer());
  }
  void begin_at_height(std::uint64_t points) {
    begin_entity("LWPOLYLINE");
    dxf_.put(100, "AcDbPolyline").put(90, points).put(70, is_closed_);
    dxf_.put(38, height_of(*level_));
  }
  void begin_in_space() {
    constexpr int kInSpace = 8;
    begin_entity("POLYLINE");
    dxf_.put(100, "AcDb3dPolyline").put(66, 1).place(10, {});
    dxf_.put(70, kInSpace + (is_closed_ ? 1 : 0));
  }

  void put_label(const LineLabel& label) {
    const double angle = label.along.y < 0 ? -angle_of(label.along.x, -label.along.y)
                                           : angle_of(label.along.x, label.along.y);
    const Vec3d at{label.at.x, label.at.y, height_of(*level_)};
    dxf_.put(0, "TEXT").handle().put(330, kModelSpace).put(100, "AcDbEntity");
    dxf_.put(8, kLabelLayer.name).put(100, "AcDbText").place(10, at).put(40, text_height_);
    dxf_.put(1, level_text(level_->height))
        .put(50, fmt::format("{:.6f}", angle * 180 / std::numbers::pi));
    dxf_.put(72, 1).place(11, at).put(100, "AcDbText").put(73, 2);
  }

  const LineDrawing& drawing_;
  DxfGroups dxf_;
  bool is_in_space_;
  double text_height_ = 1;
  const CutLevel* level_ = nullptr;
  std::optional<LabelFinder> label_{};
  bool is_closed_ = false;
};

}  // namespace

std::unique_ptr<LineWriter> dxf_writer(const LineDrawing& drawing, exporting::ByteStream& out) {
  return std::make_unique<DxfWriter>(drawing, out);
}

}  // namespace meshhier::drawing
