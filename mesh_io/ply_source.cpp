#include "mesh_io/ply_source.h"

#include "base/error.h"
#include "mesh_io/ply_body.h"
#include "mesh_io/ply_fixed_rows.h"
#include "mesh_io/ply_header.h"
#include "mesh_io/ply_lines.h"
#include "mesh_io/ply_places.h"
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

class PlyFileSource final : public PlySource {
 public:
  PlyFileSource(std::unique_ptr<storage::File> file, const PlyReading& reading)
      : file_(std::move(file)),
        file_bytes_(file_->size()),
        content_bytes_(file_bytes_),
        checksum_(file_bytes_) {
    const PlyHeader header = read_header();
    if (header.encoding == PlyEncoding::ascii)
      content_bytes_ = text_end(header.data_offset);
    plan_ =
        make_ply_plan(header, content_bytes_, file_->path(), reading.writer, reading.attributes);
    odd_.resize(plan_.elements.size() + 1);
    plan_.checks.places = reading.unplaced == Unplaced::refused;
    starts_.resize(plan_.elements.size() + 1);
    starts_[0] = PlyPosition{header.data_offset, header.data_line};
    locate_fixed_elements();
    describe();
    plan_blocks();
  }

  const MeshDescription& description() const override { return description_; }
  void read_vertices(const VertexVisitor& visit, const BlockRunner& runner) override;

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
  FaceCounts read_triangles_from(std::uint64_t face, const TriangleVisitor& visit,
                                 const BlockRunner& runner) override;
  const PlyPlan& plan() const override { return plan_; }
  FaceCounts read_faces(const PlyFaceVisitor& visit) override;
  void read_texture_vertices(const std::function<void(std::array<float, 2>)>& visit) override;
  void read_texture_faces(const PlyTextureFaceVisitor& visit) override;
  Vec3d place_of(std::uint32_t vertex) override { return places().at(vertex); }
  OddSyntax odd_syntax() const override;
  std::uint64_t checksum(const std::function<void()>& check) override {
    return checksum_.complete(*file_, check);
  }
  std::vector<storage::BlockSums> known_sums() const override { return checksum_.known(); }
  bool add_sums(const storage::BlockSums& sums) override { return checksum_.add(sums); }

 private:
  InputFile input() const { return {*file_, content_bytes_, &checksum_}; }
  PlyHeader read_header() const;
  std::uint64_t text_end(std::uint64_t begin) const;
  void expect_end(PlyBody& body);
  void note_odd(std::size_t element, PlyBody& body);
  void locate_fixed_elements();
  void describe();
  void plan_blocks();
  std::unique_ptr<PlyBody> body_at(std::size_t element);
  std::size_t first_face_element() const;
  std::size_t element_of(PlyElementPlan::Role role) const;
  std::size_t texture_count() const;
  PlyPlaces& places();

  std::unique_ptr<storage::File> file_;
  std::uint64_t file_bytes_;
  std::uint64_t content_bytes_;             ///< without the zeros behind a text
  mutable storage::FileChecksum checksum_;  ///< thread-safe
  PlyPlan plan_;
  /// The place where each element starts, as far as known, and the end: nothing is scanned twice.
  std::vector<std::optional<PlyPosition>> starts_;
  std::vector<OddSyntax> odd_;  ///< per element, and for the lines behind them
  MeshDescription description_;
  std::optional<PlyVertexBlocks> vertex_blocks_;
  std::optional<PlyPlaces> places_;
  std::optional<PlyTriangleBlocks> triangle_blocks_;  ///< blocks of the first element with faces
};

PlyHeader PlyFileSource::read_header() const {
  std::string start(std::min<std::uint64_t>(file_bytes_, kMaxHeaderBytes), '\0');
  start.resize(file_->read_at(0, std::as_writable_bytes(std::span(start))));
  checksum_.add(0, std::as_bytes(std::span(start)));
  return parse_ply_header(start, file_->path());
}

/// Returns where a text ends: some programs fill files up with zeros.
std::uint64_t PlyFileSource::text_end(std::uint64_t begin) const {
  std::string part;
  std::uint64_t end = file_bytes_;
  while (end > begin) {
    part.resize(std::min<std::uint64_t>(end - begin, 4096));
    file_->read_exact(end - part.size(), std::as_writable_bytes(std::span(part)));
    const std::size_t last = part.find_last_not_of('\0');
    if (last != std::string::npos)
      return end - part.size() + last + 1;
    end -= part.size();
  }
  return end;
}

OddSyntax PlyFileSource::odd_syntax() const {
  OddSyntax all{.header_lines = plan_.odd_header_lines,
                .bytes_behind = file_bytes_ - content_bytes_};
  for (const OddSyntax& one : odd_)
    all += one;
  return all;
}

/// Notes the oddities of an element of faces, or of one behind them that is skipped.
void PlyFileSource::note_odd(std::size_t element, PlyBody& body) {
  const OddSyntax odd = body.take_odd();
  if (element != plan_.vertex_element)
    odd_[element] = odd;
}

void PlyFileSource::expect_end(PlyBody& body) {
  body.expect_end();
  odd_.back() = body.take_odd();
}

/// Locates elements as far as rows have fixed sizes. Nothing overflows: make_ply_plan has checked
/// that the rows fit the file.
void PlyFileSource::locate_fixed_elements() {
  for (std::size_t i = 0; i < plan_.elements.size() && starts_[i]; ++i) {
    const PlyElementPlan& element = plan_.elements[i];
    if (!element.stride)
      break;
    starts_[i + 1] = PlyPosition{starts_[i]->offset + *element.stride * element.element.count, 0};
  }
}

void PlyFileSource::describe() {
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

void PlyFileSource::plan_blocks() {
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
std::unique_ptr<PlyBody> PlyFileSource::body_at(std::size_t element) {
  std::size_t known = element;
  while (!starts_[known])
    --known;
  auto body = make_body(input(), plan_, *starts_[known]);
  for (; known < element; ++known) {
    body->skip(plan_.elements[known]);
    starts_[known + 1] = body->position();
  }
  body->take_odd();  // skipped elements are read later, or not at all
  return body;
}

std::size_t PlyFileSource::first_face_element() const {
  const auto found = std::find_if(plan_.elements.begin(), plan_.elements.end(),
                                  [](const PlyElementPlan& plan) { return plan.has_faces(); });
  return static_cast<std::size_t>(found - plan_.elements.begin());
}

std::size_t PlyFileSource::element_of(PlyElementPlan::Role role) const {
  const auto found = std::ranges::find(plan_.elements, role, &PlyElementPlan::role);
  return static_cast<std::size_t>(found - plan_.elements.begin());
}

std::size_t PlyFileSource::texture_count() const {
  const bool is_unnamed =
      plan_.texcoords == PlyTexcoords::of_texture_faces && plan_.texture_files.empty();
  return is_unnamed ? kMostUnnamedTextures : plan_.texture_files.size();
}

PlyPlaces& PlyFileSource::places() {
  if (!places_) {
    const PlyPosition start = body_at(plan_.vertex_element)->position();
    places_.emplace(input(), plan_, description_, start);
  }
  return *places_;
}

void PlyFileSource::read_vertices(const VertexVisitor& visit, const BlockRunner& runner) {
  const std::size_t element = plan_.vertex_element;
  auto body = body_at(element);
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
  std::uint64_t first = 0;
  if (plan_.encoding == PlyEncoding::ascii) {
    const PlyLinesRead lines =
        read_vertex_lines(input(), plan_, description_, body->position(), visit, runner);
    first = lines.row;
    body = make_body(input(), plan_, lines.position);
  }
  VertexBlocks blocks(description_, visit, first);
  body->read_vertices(plan_.elements[element], first, blocks);
  odd_[element] = body->take_odd();
  starts_[element + 1] = body->position();
  blocks.finish();
}

FaceCounts PlyFileSource::read_triangles_from(std::uint64_t face, const TriangleVisitor& visit,
                                              const BlockRunner& runner) {
  const std::size_t first = first_face_element();
  auto body = body_at(first);
  if (face > 0)
    body = make_body(input(), plan_, {triangle_blocks_->offset_of(face), 0});
  const PlaceOf place = [this](std::uint32_t vertex) { return place_of(vertex); };
  TriangleBlocks blocks(visit, &place);
  for (std::size_t i = first; i < plan_.elements.size(); ++i) {
    const PlyElementPlan& element = plan_.elements[i];
    if (!element.has_faces()) {
      body->skip(element);
    } else if (plan_.encoding == PlyEncoding::ascii) {
      const PlyLinesRead lines = read_polygon_lines(input(), element, description_.vertex_count,
                                                    body->position(), blocks, runner);
      body = make_body(input(), plan_, lines.position);
      body->read_faces(element, lines.row, blocks);
    } else {
      body->read_faces(element, i == first ? face : 0, blocks);
    }
    note_odd(i, *body);
    starts_[i + 1] = body->position();
  }
  expect_end(*body);
  return blocks.finish();
}

/// Reads strips, each triangle of which is a face.
FaceCounts read_strips(PlyBody& body, const PlyElementPlan& plan, const PlyFaceVisitor& visit) {
  PlyFace face;
  const TriangleVisitor each = [&](std::span<const Triangle<VertexId>> triangles) {
    for (const Triangle<VertexId>& t : triangles) {
      face.corners = {raw(t[0]), raw(t[1]), raw(t[2])};
      visit(face);
    }
  };
  TriangleBlocks blocks(each);
  body.read_faces(plan, 0, blocks);
  return blocks.finish();
}

FaceCounts PlyFileSource::read_faces(const PlyFaceVisitor& visit) {
  const std::size_t first = first_face_element();
  const PlyFaceLimits limits{description_.vertex_count, 0, texture_count()};
  PlyFace face;
  const auto body = body_at(first);
  FaceCounts counts;
  for (std::size_t i = first; i < plan_.elements.size(); ++i) {
    const PlyElementPlan& element = plan_.elements[i];
    if (element.role == PlyElementPlan::Role::strips) {
      const FaceCounts strips = read_strips(*body, element, visit);
      counts.faces += strips.faces;
      counts.degenerate_triangles += strips.degenerate_triangles;
    } else if (element.has_faces()) {
      body->read_rows(element, [&](const PlyRow& row) {
        std::string defect = take_face(element, row, limits, face);
        if (defect.empty())
          visit(face);
        return defect;
      });
      counts.faces += element.element.count;
    } else {
      body->skip(element);
    }
    note_odd(i, *body);
    starts_[i + 1] = body->position();
  }
  expect_end(*body);
  return counts;
}

void PlyFileSource::read_texture_vertices(const std::function<void(std::array<float, 2>)>& visit) {
  const std::size_t index = element_of(PlyElementPlan::Role::texture_vertices);
  const auto texcoord = plan_.elements[index].texcoord;
  body_at(index)->read_rows(plan_.elements[index], [&](const PlyRow& row) {
    visit({static_cast<float>(row.values[texcoord[0]][0]),
           static_cast<float>(row.values[texcoord[1]][0])});
    return std::string();
  });
}

void PlyFileSource::read_texture_faces(const PlyTextureFaceVisitor& visit) {
  const std::size_t index = element_of(PlyElementPlan::Role::texture_faces);
  const PlyElementPlan& plan = plan_.elements[index];
  const auto count_of = [&](PlyElementPlan::Role role) {
    return plan_.elements[element_of(role)].element.count;
  };
  const PlyFaceLimits limits{count_of(PlyElementPlan::Role::texture_vertices),
                             count_of(PlyElementPlan::Role::polygons), texture_count()};
  PlyTextureFace face;
  body_at(index)->read_rows(plan, [&](const PlyRow& row) {
    std::string defect = take_texture_face(plan, row, limits, face);
    if (defect.empty())
      visit(face);
    return defect;
  });
}

}  // namespace

std::optional<PlyPlan> plan_of(std::string_view start, const std::filesystem::path& path,
                               const AttributeChoice& attributes) {
  try {
    return make_ply_plan(parse_ply_header(start, path), UINT64_MAX, path, PlyWrittenBy::anyone,
                         attributes);
  } catch (const Error&) {
    return std::nullopt;  // the reading itself will say why it cannot be read
  }
}

std::unique_ptr<PlySource> make_ply_source(std::unique_ptr<storage::File> file,
                                           const PlyReading& reading) {
  return std::make_unique<PlyFileSource>(std::move(file), reading);
}

}  // namespace meshhier::mesh_io
