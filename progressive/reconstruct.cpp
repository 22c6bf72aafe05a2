#include "progressive/reconstruct.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "execution/size_text.h"
#include "hierarchy/detail.h"
#include "mesh_io/output_name.h"
#include "mesh_io/ply_writer.h"
#include "progressive/detail_file.h"
#include "progressive/reconstruction.h"
#include "progressive/stream_index.h"
#include "storage/format/layout.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace meshhier::progressive {
namespace {

namespace fs = std::filesystem;
using progressive::ProgressiveFile;
using progressive::ProgressiveIndex;
using progressive::Reconstruction;
using progressive::StreamSize;

std::uint32_t details_wanted(const ProgressiveIndex& index, const ReconstructOptions& options) {
  const std::size_t all = index.files.size() - 1;
  if (options.details && *options.details > all) {
    throw Error(ErrorCode::usage,
                fmt::format("--details {}: the stream has {}", *options.details, all));
  }
  return options.details.value_or(static_cast<std::uint32_t>(all));
}

void require_memory(const StreamSize& size, const AttributeLayout& layout, std::uint64_t budget) {
  const std::uint64_t needed = Reconstruction::memory_bytes(size, layout);
  if (needed > budget) {
    throw Error(
        ErrorCode::budget,
        fmt::format("the mesh needs {} in memory, the budget is {}; --memory-budget {} would do",
                    execution::rounded_size_text(needed), execution::rounded_size_text(budget),
                    execution::exact_size_text((needed / (1U << 20) + 1) * (1U << 20))));
  }
}

/// Counts a file's runs by list.
struct ListCounts {
  std::array<std::uint64_t, 3> entries{};
  void add(const DetailRun& run) {
    entries[run.index()] += std::visit([](const auto& list) { return list.indices.size(); }, run);
  }
};

class Client {
 public:
  Client(storage::FileSystem& files, const fs::path& stream, const ProgressiveIndex& index,
         const StreamSize& size)
      : files_(files), stream_(stream), index_(index), mesh_(size, index.source.attributes) {}

  /// Reads the file of a step and puts it into its places.
  ReconstructedStep take(std::uint32_t step, const execution::CancelToken& cancel) {
    const execution::Clock clock = execution::steady_clock();
    const double start = clock();
    const ProgressiveFile& file = index_.files[step];
    const std::string name = storage::detail_path(stream_, step).string();
    const std::vector<std::byte> bytes = read(step);
    progressive::DetailFileReader reader(bytes, step, index_.source.attributes, name);
    ListCounts counts;
    while (const std::optional<DetailRun> run = reader.next()) {
      cancel.check();
      apply(*run, name);
      counts.add(*run);
    }
    check(file, counts, name);
    const auto& e = counts.entries;
    return {name,
            file.bytes,
            mesh_.shown_vertices(),
            mesh_.shown_triangles(),
            e[0] + e[1] + e[2],
            clock() - start};
  }

  Reconstruction& mesh() { return mesh_; }

 private:
  std::vector<std::byte> read(std::uint32_t step) {
    try {
      return progressive::read_detail_file(files_, stream_, index_, step);
    } catch (const Error& error) {
      if (step == 0)
        throw;
      throw Error(error.code(),
                  fmt::format("{}; the files before it show level {}: --details {}", error.what(),
                              raw(index_.files[step - 1].level), step - 1));
    }
  }

  void apply(const DetailRun& run, const std::string& name) {
    try {
      mesh_.apply(run);
    } catch (const Error& error) {
      throw error.within(name);
    }
  }

  void check(const ProgressiveFile& file, const ListCounts& counts, const std::string& name) const {
    const bool same = counts.entries == std::array{file.vertices, file.triangles, file.merges} &&
                      mesh_.shown_vertices() == file.shown_vertices &&
                      mesh_.shown_triangles() == file.shown_triangles;
    if (!same)
      throw Error(ErrorCode::corrupt, name + ": its counts are not those of the index");
  }

  storage::FileSystem& files_;
  const fs::path& stream_;
  const ProgressiveIndex& index_;
  Reconstruction mesh_;
};

/// Splits vertices into the parts that the writer takes.
class VertexSplitter {
 public:
  VertexSplitter(const ProgressiveIndex& index, mesh_io::PlyWriter& writer)
      : origin_(index.origin),
        width_(static_cast<std::size_t>(vertex_values(index.source.attributes))),
        writer_(writer) {}

  void write(std::span<const float> values) const {
    std::vector<Vec3f> places;
    std::vector<Vec3d> exact;
    std::vector<float> attributes;
    for (; !values.empty(); values = values.subspan(width_)) {
      const Vec3f place{values[0], values[1], values[2]};
      places.push_back(place);
      exact.push_back(to_double(place) + origin_);
      attributes.insert(attributes.end(), values.begin() + 3,
                        values.begin() + static_cast<std::ptrdiff_t>(width_));
    }
    if (origin_ == Vec3d{})
      writer_.write_vertices(places, attributes);
    else
      writer_.write_vertices(exact, attributes);
  }

 private:
  Vec3d origin_;
  std::size_t width_;
  mesh_io::PlyWriter& writer_;
};

void write_mesh(const storage::OutputFile& output, const ProgressiveIndex& index,
                Reconstruction& mesh, const std::string& what,
                const execution::CancelToken& cancel) {
  mesh_io::PlyContent content;
  content.vertex_count = mesh.shown_vertices();
  content.triangle_count = mesh.shown_triangles();
  content.attributes = index.source.attributes;
  content.double_coordinates = index.origin != Vec3d{};
  content.comments = {"meshhier reconstruct: " + what};
  mesh_io::PlyWriter writer(output.file(), content);
  const VertexSplitter splitter(index, writer);
  std::move(mesh).hand_out(
      [&](std::span<const float> values) {
        cancel.check();
        splitter.write(values);
      },
      [&](std::span<const Triangle<std::uint32_t>> triangles) {
        cancel.check();
        writer.write_triangles(triangles);
      });
  writer.finish();
}

}  // namespace

ReconstructReport reconstruct(storage::FileSystem& files, const fs::path& stream,
                              const ReconstructOptions& options, execution::Progress& progress,
                              const execution::CancelToken& cancel) {
  const ProgressiveIndex index = progressive::read_progressive_index(files, stream);
  const std::uint32_t details = details_wanted(index, options);
  const StreamSize size{index.vertices, index.own_vertices, index.triangles};
  require_memory(size, index.source.attributes, options.memory_budget);
  if (!storage::is_standard_output(files, options.output))
    storage::require_outside(files, options.output);
  mesh_io::require_true_ending(options.output.string(), {".ply"},
                               "reconstruct writes a PLY; name it .ply");
  storage::OutputFile output(files, {options.output, options.replace, {stream}},
                             [&] { cancel.check(); });

  ReconstructReport report;
  report.array_bytes = Reconstruction::memory_bytes(size, index.source.attributes);
  progress.expect({{"reconstruct", "files", 0, 4}, {"write", "files", 0, 1}});  // measured
  progress.stage("reconstruct", std::uint64_t{details} + 1, "files");
  Client client(files, stream, index, size);
  for (std::uint32_t step = 0; step <= details; ++step) {
    report.steps.push_back(client.take(step, cancel));
    progress.advance(1);
  }
  const std::string what =
      fmt::format("base and {} of {} details", details, index.files.size() - 1);
  const ReconstructedStep shown = report.steps.back();
  progress.stage("write", 1, "files");
  try {
    write_mesh(output, index, client.mesh(), what, cancel);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::corrupt)
      throw error.within(stream.string());
    throw;
  }
  output.publish();
  progress.advance(1);
  report.summary = fmt::format("{}: {}, level {}: {}, {}", options.output.string(), what,
                               raw(index.files[details].level), counted(shown.vertices, "vertices"),
                               counted(shown.triangles, "triangles"));
  return report;
}

}  // namespace meshhier::progressive
