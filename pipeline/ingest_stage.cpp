#include "pipeline/ingest_stage.h"

#include "base/error.h"
#include "hierarchy/value_channels.h"
#include "import/input_record.h"
#include "import/text_blocks.h"
#include "partition/top_tree.h"
#include "pipeline/origin.h"
#include "pipeline/survey.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::pipeline {
namespace {

constexpr std::size_t kBlock = mesh_io::MeshSource::kBlockSize;

Vec3d widened(Vec3f p) {
  return to_double(p);
}
Vec3d widened(Vec3d p) {
  return p;
}

std::vector<ValueTally> tallies_of(const AttributeLayout& layout) {
  return {layout.values.begin(), layout.values.end()};
}

std::vector<LabelGuess> guesses_of(const AttributeLayout& layout) {
  return {layout.values.begin(), layout.values.end()};
}

/// Adds the values of vertices. `attributes`: their channels, one vertex after another.
void add_values(std::span<const float> attributes, const AttributeLayout& layout,
                std::span<ValueTally> tallies, std::span<LabelGuess> guesses) {
  if (tallies.empty())
    return;
  const auto stride = static_cast<std::size_t>(layout.channels());
  const std::vector<PlacedValue> values = placed_values(layout);
  for (std::size_t i = 0; i < tallies.size(); ++i) {
    const float* const first = attributes.data() + values[i].channel;
    tallies[i].add(first, stride, attributes.size() / stride);
    guesses[i].add(first, stride, attributes.size() / stride);
  }
}

/// The facts that one block of vertices tells.
struct BlockScan {
  std::size_t count = 0;
  BoundsD bounds;
  bool float_exact = true;
  std::vector<Vec3d> sample;  ///< the vertices that SampleIds names
  mesh_io::ZeroedCounts zeroed;
  ColourRange colours;
  std::vector<ValueTally> values;
  std::vector<LabelGuess> guesses;

  void look_at(const mesh_io::VertexBlock& block, const AttributeLayout& layout,
               const partition::SampleIds& ids) {
    zeroed = block.zeroed;
    colours = {};
    colours.add(block.attributes, layout);
    values = tallies_of(layout);
    guesses = guesses_of(layout);
    add_values(block.attributes, layout, values, guesses);
    float_exact = block.fits_float();
    block.exact.empty() ? look_at(block.first, block.positions, ids)
                        : look_at(block.first, block.exact, ids);
  }

 private:
  template <class Scalar>
  void look_at(std::uint64_t first, std::span<const Vec3<Scalar>> positions,
               const partition::SampleIds& ids) {
    count = positions.size();
    BoundsOf<Scalar> box;  // in a local, so that it stays in registers
    for (const Vec3<Scalar>& p : positions)
      box.add(p);
    bounds = BoundsD{widened(box.min), widened(box.max)};
    sample.clear();
    for (std::uint64_t i = ids.first_from(first); i < ids.count() && ids[i] < first + count; ++i)
      sample.push_back(widened(positions[ids[i] - first]));
  }
};

/// Whether a box reaches out of `limit`; an empty one never does.
bool is_beyond(const BoundsD& box, const BoundsD& limit) {
  BoundsD both = limit;
  both.add(box);
  return both != limit;
}

void warn_of_far(const FarVertices& far, execution::Progress& progress) {
  if (far.count == 0)
    return;
  const Vec3d& p = far.first;
  const std::string others =
      far.count > 1 ? fmt::format(" and {}", counted(far.count - 1, "more vertices")) : "";
  progress.warn(fmt::format(
      "triangles reach far from nearly all of the mesh, to {} {} {}{}: coordinates there may be "
      "rounded, and views show all of the space between. If they are mistakes, delete them",
      p.x, p.y, p.z, others));
}

/// Warns if rounding is more than a thousandth of an edge: that shows where light falls flat.
void warn_of_rounding(double rounding, double median_edge, execution::Progress& progress) {
  constexpr double kMost = 1e-3;
  if (median_edge == 0 || rounding <= kMost * median_edge)
    return;
  progress.warn(fmt::format(
      "32-bit floats round coordinates by up to {:.3g}, {:.2g} % of the median edge of {:.3g}: "
      "fine relief loses its shape. Build smaller parts of the mesh (\"crop\"), each has an origin "
      "of its own",
      rounding, 100 * rounding / median_edge, median_edge));
}

/// Warns of a mesh that may have degrees beside metres: 1,000 times as high as it is wide.
void warn_of_degrees(const BoundsD& box, execution::Progress& progress) {
  constexpr double kSlimmest = 1e-3;
  constexpr double kMost = 180;
  const Vec3d size = box.max - box.min;
  const auto is_angle = [&](double least, double most, double width) {
    return least >= -kMost && most <= kMost && width > 0 && width < kSlimmest * size.z;
  };
  if (box.empty() || !is_angle(box.min.x, box.max.x, size.x) ||
      !is_angle(box.min.y, box.max.y, size.y))
    return;
  progress.warn(fmt::format(
      "the mesh is {:.2g} x {:.2g} wide and {:.2g} high: viewers show a line. If x and y are "
      "longitude and latitude, bring it into a projected CRS, such as UTM, first",
      size.x, size.y, size.z));
}

}  // namespace

SourceMesh::SourceMesh(std::unique_ptr<mesh_io::MeshSource> source, std::string file_name,
                       storage::ScratchFile& scratch)
    : source_(std::move(source)),
      spooled_positions_(scratch, 1 << 18),
      spooled_attributes_(scratch, 1 << 18) {
  const mesh_io::MeshDescription& description = source_->description();
  summary_.file_name = std::move(file_name);
  summary_.file_bytes = description.file_bytes;
  summary_.vertices = description.vertex_count;
  summary_.places = description.vertex_count;
  summary_.attributes = description.attributes;
}

SourceMesh ingest(std::unique_ptr<mesh_io::MeshSource> source, std::string file_name,
                  storage::ScratchFile& scratch, const StageContext& context) {
  SourceMesh mesh(std::move(source), std::move(file_name), scratch);
  try {
    mesh.summary_.counts = importing::source_counts(mesh.scan(context));
  } catch (const mesh_io::UnplacedVertexError& error) {
    throw Error(ErrorCode::input, std::string(error.what()) +
                                      "; \"topology\": \"place\" leaves them out, and faces "
                                      "that use such vertices");
  }
  mesh.choose_colour_type(context.progress);
  mesh.choose_origin(context);
  return mesh;
}

SourceMesh ingested(std::unique_ptr<mesh_io::MeshSource> source, const SourceSummary& summary,
                    Vec3d origin, storage::ScratchFile& scratch) {
  SourceMesh mesh(std::move(source), summary.file_name, scratch);
  mesh.summary_ = summary;
  mesh.origin_ = origin;
  mesh.float_exact_ = !summary.double_precision;
  return mesh;
}

mesh_io::ZeroedCounts SourceMesh::scan(const StageContext& context) {
  execution::Progress& progress = context.progress;
  summary_.places = context.tree().vertex_count();
  progress.stage("ingest", summary_.vertices, "vertices");
  const partition::SampleIds ids(summary_.vertices);
  sample_positions_.reserve(ids.count());
  const AttributeLayout layout = summary_.attributes;
  mesh_io::ZeroedCounts zeroed;
  std::vector<ValueTally> values = tallies_of(layout);
  std::vector<LabelGuess> guesses = guesses_of(layout);
  const auto take = [&](const BlockScan& block) {
    zeroed += block.zeroed;
    colours_.add(block.colours);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i].add(block.values[i]);
      guesses[i].add(block.guesses[i]);
    }
    summary_.bounds.add(block.bounds);
    float_exact_ = float_exact_ && block.float_exact;
    sample_positions_.insert(sample_positions_.end(), block.sample.begin(), block.sample.end());
    progress.advance(block.count);
    return true;
  };
  if (vertices_in_place()) {
    struct Slot {
      mesh_io::BlockMemory memory;
      BlockScan scan;
    };
    execution::ordered_blocks<Slot>(
        source_->vertex_blocks(), context.memory().blocks_in_flight, context.cancel,
        [&](std::uint64_t i, Slot& slot) {
          slot.scan.look_at(source_->read_vertex_block(i, slot.memory), layout, ids);
        },
        [&](const Slot& slot) { return take(slot.scan); });
    note_values(values, std::move(guesses));
    return zeroed;
  }
  BlockScan scan;
  source_->read_vertices(
      [&](const mesh_io::VertexBlock& block) {
        context.cancel.check();
        scan.look_at(block, layout, ids);
        take(scan);
        const bool wide = !block.exact.empty();
        spooled_positions_.append(wide ? std::as_bytes(block.exact)
                                       : std::as_bytes(block.positions));
        spooled_attributes_.append(std::as_bytes(block.attributes));
      },
      importing::parallel_blocks(context.memory().blocks_in_flight, context.cancel));
  note_values(values, std::move(guesses));
  return zeroed;
}

void SourceMesh::note_values(std::span<const ValueTally> values, std::vector<LabelGuess> guesses) {
  for (const ValueTally& value : values)
    summary_.values.push_back(value.statistics());
  guesses_ = std::move(guesses);
}

void SourceMesh::guess_labels(const std::function<bool(const std::string&)>& is_sure,
                              execution::Progress& progress) {
  std::vector<ScalarAttribute>& all = summary_.attributes.values;
  std::vector<std::string> labels, quantities, possible;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_none = !all[i].is_object && guesses_[i].is_quantity() && !is_sure(all[i].name);
    all[i].is_label = all[i].is_label && !is_none;
    if (all[i].is_label && !all[i].is_object)
      labels.push_back(all[i].name);
    if (is_none)
      quantities.push_back(all[i].name);
    if (!guesses_[i].classes().empty())
      possible.push_back(all[i].name);
  }
  const auto line_with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> names = labels;
    names.insert(names.end(), more.begin(), more.end());
    return labels_line(names);
  };
  if (!quantities.empty()) {
    progress.warn(
        fmt::format("the values of {} differ from nearly each vertex to the next: they are taken "
                    "for quantities, of which simplified tiles have means; {} makes labels of them",
                    fmt::join(quantities, ", "), line_with(quantities)));
  }
  if (!possible.empty()) {
    progress.warn(fmt::format(
        "the values of {} are few whole numbers: if they name something, as classes do, {} in the "
        "config keeps simplified tiles from having means of them",
        fmt::join(possible, ", "), line_with(possible)));
  }
}

void SourceMesh::choose_colour_type(execution::Progress& progress) {
  AttributeLayout& layout = summary_.attributes;
  if (!colours_.are_bytes(layout))
    return;
  progress.warn(
      fmt::format("all colours of the mesh are {} of at most {}: they are taken for 8-bit "
                  "colours",
                  layout.colour == ColourType::u16 ? "16-bit numbers" : "floats", colours_.most()));
  layout.colour = ColourType::u8;
  summary_.counts.push_back({std::string(importing::kColoursTakenForBytes), summary_.vertices});
}

void SourceMesh::choose_origin(const StageContext& context) {
  summary_.double_precision = !float_exact_;
  const std::uint64_t count = summary_.vertices;
  if (float_exact_ && !may_need_origin(sample_positions_, summary_.bounds, count))
    return;
  const Survey used = survey(*this, sample_positions_, context);
  const bool is_cloud = used.bounds.empty();
  const std::span<const Vec3d> sample = is_cloud ? sample_positions_ : used.sample;
  const Origin chosen =
      pipeline::choose_origin(is_cloud ? summary_.bounds : used.bounds, core_of(sample), count);
  origin_ = chosen.at;
  if (is_beyond(used.bounds, chosen.near))
    warn_of_far(used_outside(*this, chosen.near, context), context.progress);
  warn_of_rounding(rounding_of(sample, origin_), used.median_edge, context.progress);
  warn_of_degrees(used.bounds, context.progress);
}

std::vector<partition::IdPoint> SourceMesh::take_sample(const importing::CopyList& copies) {
  const partition::SampleIds ids(summary_.vertices);
  const std::vector<Vec3d> positions = std::exchange(sample_positions_, {});
  std::vector<partition::IdPoint> sample;
  sample.reserve(positions.size());
  importing::CopyCursor cursor(copies);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto id = static_cast<std::uint32_t>(ids[i]);
    if (!cursor.is_copy(id))
      sample.push_back({to_float(positions[i] - origin_), id});
  }
  return sample;
}

std::uint64_t SourceMesh::vertex_blocks() const {
  return vertices_in_place() ? source_->vertex_blocks() : (summary_.vertices + kBlock - 1) / kBlock;
}

mesh_io::VertexBlock SourceMesh::read_input_block(std::uint64_t index,
                                                  mesh_io::BlockMemory& memory) const {
  if (vertices_in_place())
    return source_->read_vertex_block(index, memory);
  const std::uint64_t first = index * kBlock;
  const std::size_t count = std::min<std::uint64_t>(kBlock, summary_.vertices - first);
  const auto channels = static_cast<std::size_t>(summary_.attributes.channels());
  memory.attributes.resize(count * channels);
  spooled_attributes_.read(first * channels * sizeof(float),
                           std::as_writable_bytes(std::span(memory.attributes)));
  mesh_io::VertexBlock block;
  block.first = first;
  block.attributes = memory.attributes;
  if (source_->description().wide_coordinates) {
    memory.exact.resize(count);
    spooled_positions_.read(first * sizeof(Vec3d), std::as_writable_bytes(std::span(memory.exact)));
    block.exact = memory.exact;
  } else {
    memory.positions.resize(count);
    spooled_positions_.read(first * sizeof(Vec3f),
                            std::as_writable_bytes(std::span(memory.positions)));
    block.positions = memory.positions;
  }
  return block;
}

SourceVertices SourceMesh::read_vertex_block(std::uint64_t index,
                                             mesh_io::BlockMemory& memory) const {
  const mesh_io::VertexBlock block = read_input_block(index, memory);
  if (!block.exact.empty()) {
    memory.positions.resize(block.exact.size());
    std::transform(block.exact.begin(), block.exact.end(), memory.positions.begin(),
                   [&](Vec3d p) { return to_float(p - origin_); });
    return {block.first, memory.positions, block.attributes};
  }
  if (origin_ == Vec3d{})
    return {block.first, block.positions, block.attributes};
  memory.positions.resize(block.positions.size());  // they may be there already
  std::transform(block.positions.begin(), block.positions.end(), memory.positions.begin(),
                 [&](Vec3f p) { return to_float(to_double(p) - origin_); });
  return {block.first, memory.positions, block.attributes};
}

std::uint64_t input_block_bytes(const JobSize& job) {
  // A block has a copy, a sorted copy and ranks.
  return kBlock * (2 * job.vertex_bytes() + 32);
}

std::uint64_t sample_bytes(const JobSize& job) {
  // While the sample is sorted there are its points, as they were and in order, and their keys.
  return std::min(job.vertex_count, partition::kSampleVertices) * (16 + 16 + 16);
}

StageMemory ingest_memory(const JobSize& job) {
  const std::uint64_t block = input_block_bytes(job);
  const std::uint64_t least = 2 * block + sample_bytes(job) + survey_bytes(job.vertex_count);
  return {block, 2 * job.threads, least, least};
}

StageTimes ingest_time(const JobSize& job, const TilePopulation& /*tiles*/) {
  constexpr double kVertexSeconds = 47e-9;
  return {{"ingest", "vertices", job.vertex_count,
           static_cast<double>(job.vertex_count) * kVertexSeconds}};
}

DiskVolumes ingest_disk(const JobSize& job, const TilePopulation& /*tiles*/,
                        const MemoryPlan& /*memory*/) {
  if (job.vertices_in_place)
    return {};
  const double vertex = (job.wide_coordinates ? 24 : 12) + 4.0 * job.channels;
  return {{static_cast<double>(job.vertex_count) * vertex, DiskMoment::splits, DiskMoment::noted,
           true}};
}

}  // namespace meshhier::pipeline
