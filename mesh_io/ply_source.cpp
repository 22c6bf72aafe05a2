#include "mesh_io/ply_source.h"

#include "mesh_io/ply_body.h"
#include "mesh_io/ply_fixed_rows.h"
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
      : file_(std::move(file)), file_bytes_(file_->size()), checksum_(file_bytes_) {
    const PlyHeader header = read_header();
    plan_ = make_ply_plan(header, file_bytes_, file_->path());
    starts_.resize(plan_.elements.size() + 1);
    starts_[0] = PlyPosition{header.data_offset, header.data_line};
    locate_fixed_elements();
    describe();
    plan_blocks();
  }

  const MeshDescription& description() const override { return description_; }
  void read_vertices(const VertexVisitor& visit) override;
  FaceCounts read_triangles(const TriangleVisitor& visit) override {
    return read_triangles_from(0, visit);
  }

  std::uint64_t vertex_blocks() const override {
    return vertex_blocks_ ? vertex_blocks_->count() : 0;
  }
  VertexBlock read_vertex_block(std::uint64_t index, BlockMemory& memory) const override {
    return vertex_blocks_->read(input(), index, memory);
  }
  std::uint64_t triangle_blocks() const override {
    return triangle_blocks_ ? triangle_blocks_->count() : 0;
  }
  TriangleBlock read_triangle_block(std::uint64_t index, BlockMemory& memory) const override {
    return triangle_blocks_->read(input(), index, memory);
  }
  FaceCounts read_triangles_from(std::uint64_t face, const TriangleVisitor& visit) override;
  std::uint64_t checksum(const std::function<void()>& check) override {
    return checksum_.complete(*file_, check);
  }

 private:
  InputFile input() const { return {*file_, file_bytes_, &checksum_}; }
  PlyHeader read_header() const;
  void locate_fixed_elements();
  void describe();
  void plan_blocks();
  std::unique_ptr<PlyBody> body_at(std::size_t element);
  std::size_t first_face_element() const;

  std::unique_ptr<storage::File> file_;
  std::uint64_t file_bytes_;
  mutable storage::FileChecksum checksum_;  ///< thread-safe
  PlyPlan plan_;
  /// Where each element starts, as far as known, and the end: what was scanned once is not again.
  std::vector<std::optional<PlyPosition>> starts_;
  MeshDescription description_;
  std::optional<PlyVertexBlocks> vertex_blocks_;
  std::optional<PlyTriangleBlocks> triangle_blocks_;  ///< of the first element with faces
};

PlyHeader PlySource::read_header() const {
  std::string start(std::min<std::uint64_t>(file_bytes_, kMaxHeaderBytes), '\0');
  start.resize(file_->read_at(0, std::as_writable_bytes(std::span(start))));
  checksum_.add(0, std::as_bytes(std::span(start)));
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

void PlySource::plan_blocks() {
  if (description_.vertices_in_place)
    vertex_blocks_.emplace(plan_, description_, starts_[plan_.vertex_element]->offset);
  const std::size_t first = first_face_element();
  if (plan_.encoding == PlyEncoding::ascii || first == plan_.elements.size() || !starts_[first])
    return;
  if (const auto rows = triangle_rows(plan_.elements[first], description_.vertex_count))
    triangle_blocks_.emplace(plan_, plan_.elements[first], *rows, starts_[first]->offset);
}

/// A body at the start of an element, or at the end of the data: from the last known start before
/// it.
std::unique_ptr<PlyBody> PlySource::body_at(std::size_t element) {
  std::size_t known = element;
  while (!starts_[known])
    --known;
  auto body = plan_.encoding == PlyEncoding::ascii
                  ? make_text_body(input(), plan_, *starts_[known])
                  : make_binary_body(input(), plan_, *starts_[known]);
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
  const std::size_t element = plan_.vertex_element;
  const auto body = body_at(element);
  if (const auto stride = plan_.elements[element].stride) {
    const std::uint64_t offset = body->position().offset;
    const PlyVertexBlocks blocks(plan_, description_, offset);
    BlockMemory memory;
    for (std::uint64_t i = 0; i < blocks.count(); ++i)
      visit(blocks.read(input(), i, memory));
    // Only now: behind lists that are too long the rows may end beyond the file.
    starts_[element + 1] = PlyPosition{offset + *stride * description_.vertex_count, 0};
    return;
  }
  VertexBlocks blocks(description_, visit);
  body->read_vertices(plan_.elements[element], blocks);
  starts_[element + 1] = body->position();
  blocks.finish();
}

FaceCounts PlySource::read_triangles_from(std::uint64_t face, const TriangleVisitor& visit) {
  const std::size_t first = first_face_element();
  auto body = body_at(first);
  if (face > 0)
    body = make_binary_body(input(), plan_, PlyPosition{triangle_blocks_->offset_of(face), 0});
  TriangleBlocks blocks(visit);
  for (std::size_t i = first; i < plan_.elements.size(); ++i) {
    if (plan_.elements[i].has_faces()) {
      body->read_faces(plan_.elements[i], i == first ? face : 0, blocks);
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
