#include "mesh_io/ply_source.h"

#include "mesh_io/ply_body.h"
#include "mesh_io/ply_header.h"
#include "mesh_io/ply_plan.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace meshhier::mesh_io {
namespace {

class PlySource final : public MeshSource {
 public:
  explicit PlySource(std::unique_ptr<storage::File> file)
      : file_(std::move(file)), file_bytes_(file_->size()) {
    const PlyHeader header = read_header();
    plan_ = make_ply_plan(header, file_bytes_, file_->path());
    starts_.resize(plan_.elements.size() + 1);
    starts_[0] = PlyPosition{header.data_offset, header.data_line};
    locate_fixed_elements();
    describe();
  }

  const MeshDescription& description() const override { return description_; }
  void read_vertices(const VertexVisitor& visit) override;
  FaceCounts read_triangles(const TriangleVisitor& visit) override;

 private:
  PlyHeader read_header() const;
  void locate_fixed_elements();
  void describe();
  std::unique_ptr<PlyBody> body_at(std::size_t element);
  std::size_t first_face_element() const;

  std::unique_ptr<storage::File> file_;
  std::uint64_t file_bytes_;
  PlyPlan plan_;
  /// Where each element starts, as far as known, and the end: what was scanned once is not again.
  std::vector<std::optional<PlyPosition>> starts_;
  MeshDescription description_;
};

PlyHeader PlySource::read_header() const {
  std::string start(std::min<std::uint64_t>(file_bytes_, kMaxHeaderBytes), '\0');
  start.resize(file_->read_at(0, std::as_writable_bytes(std::span(start))));
  return parse_ply_header(start, file_->path());
}

/// No overflow: make_ply_plan has checked that the rows fit the file.
void PlySource::locate_fixed_elements() {
  for (std::size_t i = 0; i < plan_.elements.size() && starts_[i]; ++i) {
    const PlyElementPlan& element = plan_.elements[i];
    if (!element.stride)
      break;
    starts_[i + 1] = PlyPosition{starts_[i]->offset + *element.stride * element.element.count, 0};
  }
}

void PlySource::describe() {
  const PlyElementPlan& vertices = plan_.elements[plan_.vertex_element];
  description_.format = "PLY " + std::string(name_of(plan_.encoding));
  description_.file_bytes = file_bytes_;
  description_.vertex_count = vertices.element.count;
  for (const PlyElementPlan& element : plan_.elements) {
    if (element.has_faces())
      description_.face_count += element.element.count;
  }
  description_.attributes = plan_.attributes;
  description_.wide_coordinates = plan_.wide_coordinates;
  description_.vertices_in_place =
      vertices.stride.has_value() && starts_[plan_.vertex_element].has_value();
}

/// A body at the start of an element, or at the end of the data: from the last known start before
/// it.
std::unique_ptr<PlyBody> PlySource::body_at(std::size_t element) {
  std::size_t known = element;
  while (!starts_[known])
    --known;
  auto body = plan_.encoding == PlyEncoding::ascii
                  ? make_text_body(*file_, file_bytes_, plan_, *starts_[known])
                  : make_binary_body(*file_, file_bytes_, plan_, *starts_[known]);
  for (; known < element; ++known) {
    body->skip(plan_.elements[known]);
    starts_[known + 1] = body->position();
  }
  return body;
}

std::size_t PlySource::first_face_element() const {
  const auto found = std::find_if(plan_.elements.begin(), plan_.elements.end(),
                                  [](const PlyElementPlan& plan) { return plan.has_faces(); });
  return static_cast<std::size_t>(found - plan_.elements.begin());
}

void PlySource::read_vertices(const VertexVisitor& visit) {
  const auto body = body_at(plan_.vertex_element);
  VertexBlocks blocks(description_, visit);
  body->read_vertices(plan_.elements[plan_.vertex_element], blocks);
  starts_[plan_.vertex_element + 1] = body->position();
  blocks.finish();
}

FaceCounts PlySource::read_triangles(const TriangleVisitor& visit) {
  const std::size_t first = first_face_element();
  const auto body = body_at(first);
  TriangleBlocks blocks(visit);
  for (std::size_t i = first; i < plan_.elements.size(); ++i) {
    if (plan_.elements[i].has_faces()) {
      body->read_faces(plan_.elements[i], blocks);
    } else {
      body->skip(plan_.elements[i]);
    }
    starts_[i + 1] = body->position();
  }
  body->expect_end();
  return blocks.finish();
}

}  // namespace

std::unique_ptr<MeshSource> make_ply_source(std::unique_ptr<storage::File> file) {
  return std::make_unique<PlySource>(std::move(file));
}

}  // namespace meshhier::mesh_io
