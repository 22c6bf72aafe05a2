#include "inspection/export.h"

#include "hierarchy/cut.h"
#include "hierarchy/error.h"
#include "hierarchy/plain_text.h"
#include "hierarchy/srgb.h"
#include "inspection/cut_file.h"
#include "inspection/cut_mesh.h"
#include "inspection/cut_vertices.h"
#include "inspection/export_parts.h"
#include "inspection/tile_vertices.h"
#include "mesh_io/ply_writer.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"
#include "storage/io/paths.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::inspection {
namespace {

namespace fs = std::filesystem;

using TriangleSpool = storage::RecordSpool<CutTriangle>;

/// Triangles on their way from the scratch to the writer: 768 KiB.
constexpr std::size_t kTriangleBlock = 65536;
/// Grain of the scratch: large writes, small beside any budget.
constexpr std::size_t kScratchBlockBytes = std::size_t{1} << 20;

/// What the four kinds of export share.
struct ExportJob {
  storage::FileSystem& files;
  const storage::HierarchyReader& reader;
  const storage::OutputFile& output;
  std::uint64_t memory_budget;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
};

bool has_origin(const storage::HierarchyReader& reader) {
  return reader.manifest().origin != Vec3d{};
}

mesh_io::PlyContent content_for(const storage::HierarchyReader& reader, const std::string& what) {
  mesh_io::PlyContent content;
  content.attributes = reader.tile_format().attributes;
  content.attributes.space = ColourSpace::srgb;
  content.attributes.tints = false;
  content.double_coordinates = has_origin(reader);
  content.comments = {"meshhier export: " + what};
  return content;
}

/// Light as PLY has colours: those of a screen.
std::vector<float> screen_attributes(const AttributeLayout& layout, std::span<const float> given) {
  const auto channels = static_cast<std::size_t>(layout.channels());
  std::vector<float> attributes(given.begin(), given.end());
  const double full = full_number(layout.colour);
  for (std::size_t v = 0; v < attributes.size(); v += channels) {
    float* colour = &attributes[v + static_cast<std::size_t>(layout.colour_offset())];
    std::transform(colour, colour + 3, colour,
                   [&](float x) { return static_cast<float>(full * value_of(x / full)); });
  }
  return attributes;
}

/// `count` vertices from the first on, in doubles where the hierarchy has an origin.
void write_vertices(mesh_io::PlyWriter& writer, const storage::HierarchyReader& reader,
                    const VertexArray& vertices, std::size_t count) {
  const auto positions = std::span(vertices.positions).first(count);
  const auto given =
      std::span(vertices.attributes).first(count * static_cast<std::size_t>(vertices.channels));
  const AttributeLayout& layout = reader.tile_format().attributes;
  std::vector<float> converted;
  if (layout.space == ColourSpace::linear)
    converted = screen_attributes(layout, given);
  const std::span<const float> attributes = converted.empty() ? given : std::span(converted);
  if (!has_origin(reader))
    return writer.write_vertices(positions, attributes);
  std::vector<Vec3d> exact(count);
  std::transform(positions.begin(), positions.end(), exact.begin(),
                 [&](Vec3f p) { return to_double(p) + reader.manifest().origin; });
  writer.write_vertices(exact, attributes);
}

void copy_triangles(const TriangleSpool& from, mesh_io::PlyWriter& to) {
  std::vector<CutTriangle> block;
  for (std::uint64_t first = 0; first < from.size(); first += block.size()) {
    block.resize(std::min<std::uint64_t>(kTriangleBlock, from.size() - first));
    from.read(first, block);
    to.write_triangles(block);
  }
}

/// PLY names its counts first, so triangles wait in a scratch file until they are counted, and
/// vertices are read in a second pass over the tiles.
std::string export_cut(const ExportJob& job, Cut cut, const std::string& what) {
  const Tree& tree = job.reader.tree();
  const NumberedCut numbered = number_vertices(job.reader, std::move(cut));
  CutVertices vertices(job.reader, numbered, job.memory_budget / 8, job.cancel);
  // What is left: a tile, the writer, the cut.
  storage::MemoryPool pool(job.memory_budget / 2);
  storage::ScratchFile scratch(job.files, job.output.scratch(), pool);
  TriangleSpool triangles(scratch, kScratchBlockBytes);

  job.progress.stage("export", 2 * numbered.cut.size(), "tiles");
  for (std::size_t i = 0; i < numbered.cut.size(); ++i) {
    job.cancel.check();
    const PublishedTile tile = job.reader.read_tile(numbered.cut[i]);
    auto drawn = vertices.triangles(i, tile, draw_tile(tree, numbered, i, tile));
    for (CutTriangle& triangle : drawn)
      triangle = canonical(triangle);
    std::sort(drawn.begin(), drawn.end());
    triangles.append(drawn);
    job.progress.advance(1);
  }
  mesh_io::PlyContent content = content_for(job.reader, what);
  content.vertex_count = vertices.count();
  content.triangle_count = triangles.size();
  mesh_io::PlyWriter writer(job.output.file(), content);
  for (NodeId node : numbered.cut.nodes()) {
    job.cancel.check();
    const PublishedTile tile = job.reader.read_tile(node);
    write_vertices(writer, job.reader, tile.mesh.vertices, tile.mesh.own_count);
    write_vertices(writer, job.reader, tile.mesh.copies.vertices, own_copy_count(tile.mesh));
    job.progress.advance(1);
  }
  copy_triangles(triangles, writer);
  writer.finish();
  return fmt::format("{}: {}, {}, {}", what, counted(numbered.cut.size(), "tiles"),
                     counted(content.vertex_count, "vertices"),
                     counted(content.triangle_count, "triangles"));
}

/// Corners as the tile's file numbers them.
void write_triangles(mesh_io::PlyWriter& writer, const TileMesh& mesh,
                     const std::vector<TileTriangle>& list,
                     const std::vector<CornerWedges>& wedges) {
  std::vector<CutTriangle> triangles;
  for (const TileTriangle& t : vertex_numbers(mesh).numbered(list, wedges))
    triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
  writer.write_triangles(triangles);
}

std::string export_tile(const ExportJob& job, NodeId node) {
  require_node(job.reader.tree(), node);
  job.progress.stage("export", 1, "tiles");
  const PublishedTile tile = job.reader.read_tile(node);
  const TileMesh& mesh = tile.mesh;
  const std::string what = "tile " + to_text(tile.node);
  mesh_io::PlyContent content = content_for(job.reader, what);
  content.vertex_count = mesh.vertices.size() + mesh.copies.size();
  content.triangle_count = mesh.interior.size() + mesh.border.size();
  mesh_io::PlyWriter writer(job.output.file(), content);
  write_vertices(writer, job.reader, mesh.vertices, mesh.vertices.size());
  write_vertices(writer, job.reader, mesh.copies.vertices, mesh.copies.size());
  write_triangles(writer, mesh, mesh.interior, mesh.interior_wedges);
  write_triangles(writer, mesh, mesh.border, mesh.border_wedges);
  writer.finish();
  job.progress.advance(1);
  const std::size_t foreign = mesh.ghosts.size() + mesh.copies.size() - own_copy_count(mesh);
  return fmt::format("{}: {}, {} of them its neighbours', {}, {} of them border", what,
                     counted(content.vertex_count, "vertices"), foreign,
                     counted(content.triangle_count, "triangles"), mesh.border.size());
}

/// Whether a PLY leaves them out.
bool loses_textures(const storage::HierarchyReader& reader, const ExportSelection& selection) {
  return reader.manifest().textures && !std::holds_alternative<OutlineSelection>(selection);
}

std::string export_outline(const ExportJob& job) {
  job.progress.stage("export", 1, "outlines");
  const Outline outline = job.reader.read_outline();
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t line = 0; line < outline.polyline_count(); ++line) {
    for (std::uint32_t v = outline.starts[line]; v + 1 < outline.starts[line + 1]; ++v) {
      edges.push_back({v, v + 1});
    }
  }
  mesh_io::PlyContent content = content_for(job.reader, "outline");
  content.attributes = {};
  content.vertex_count = outline.vertices.size();
  content.edge_count = edges.size();
  mesh_io::PlyWriter writer(job.output.file(), content);
  VertexArray vertices;
  vertices.positions = outline.vertices;
  write_vertices(writer, job.reader, vertices, vertices.size());
  writer.write_edges(edges);
  writer.finish();
  job.progress.advance(1);
  return fmt::format("outline: {}, {}, {}", counted(outline.polyline_count(), "lines"),
                     counted(content.vertex_count, "vertices"),
                     counted(content.edge_count, "edges"));
}

/// By the ending of its name.
enum class ExportFormat { ply, glb, obj };

ExportFormat format_of(const fs::path& output) {
  const std::string ending = storage::lower_extension(output);
  return ending == ".glb"   ? ExportFormat::glb
         : ending == ".obj" ? ExportFormat::obj
                            : ExportFormat::ply;
}

/// Another mesh's ending would name a PLY that nobody can open under it.
void require_no_other_ending(const fs::path& output) {
  constexpr std::array<std::string_view, 12> kOthers{".3ds",  ".3mf", ".dae", ".fbx",
                                                     ".gltf", ".off", ".stl", ".usd",
                                                     ".usdz", ".wrl", ".x3d", ".zip"};
  const std::string ending = storage::lower_extension(output);
  const bool is_packed = ending == ".gz";
  if (!is_packed && std::ranges::find(kOthers, ending) == kOthers.end())
    return;
  throw Error(ErrorCode::usage,
              fmt::format("{}: export writes .ply, .glb and .obj; {}", output.string(),
                          is_packed ? "pack it yourself: -o - | gzip" : "choose one of these"));
}

VertexArray first_vertices(const VertexArray& from, std::size_t count) {
  VertexArray vertices;
  vertices.channels = from.channels;
  vertices.append(from, 0, count);
  return vertices;
}

std::string write_parts(const PartsJob& job, const ExportedParts& parts, ExportFormat format) {
  return format == ExportFormat::glb ? write_glb(job, parts) : write_obj(job, parts);
}

std::string export_parts_of_cut(const PartsJob& job, Cut cut, std::uint64_t memory_budget,
                                ExportFormat format) {
  CutParts parts(job.reader, std::move(cut), memory_budget / 4);
  const ExportedParts exported{parts.size(), [&](std::size_t i) { return parts.cut()[i]; },
                               [&](std::size_t i) { return parts.load(i); },
                               [&](std::size_t i) {
                                 const PublishedTile tile = job.reader.read_tile(parts.cut()[i]);
                                 return first_vertices(tile.mesh.vertices, tile.mesh.own_count);
                               }};
  return counted(parts.size(), "tiles") + ", " + write_parts(job, exported, format);
}

std::string export_parts_of_tile(const PartsJob& job, NodeId node, ExportFormat format) {
  require_node(job.reader.tree(), node);
  const NodeId tile_node = job.reader.record(node).node;
  const ExportedParts exported{
      1, [&](std::size_t) { return tile_node; },
      [&](std::size_t) { return part_of_tile(job.reader.read_tile(node)); },
      [&](std::size_t) { return job.reader.read_tile(node).mesh.vertices; }};
  return write_parts(job, exported, format);
}

/// As GLB or OBJ, published.
std::string export_parts(const PartsJob& job, const ExportOptions& options, ExportFormat format) {
  const Tree& tree = job.reader.tree();
  if (const auto* level = std::get_if<Level>(&options.selection)) {
    require_level(tree, *level);
    return fmt::format(
        "level {}: {}", raw(*level),
        export_parts_of_cut(job, Cut::of_level(tree, *level), options.memory_budget, format));
  }
  if (const auto* node = std::get_if<NodeId>(&options.selection))
    return fmt::format("tile {}: {}", to_text(*node), export_parts_of_tile(job, *node, format));
  if (const auto* path = std::get_if<fs::path>(&options.selection)) {
    return "cut: " + export_parts_of_cut(job, read_cut(job.files, tree, *path),
                                         options.memory_budget, format);
  }
  throw Error(ErrorCode::usage, options.output.string() +
                                    ": the outline is lines, which are exported as a PLY alone");
}

std::string export_selection(const ExportJob& job, const ExportSelection& selection) {
  const Tree& tree = job.reader.tree();
  if (const auto* level = std::get_if<Level>(&selection)) {
    require_level(tree, *level);
    return export_cut(job, Cut::of_level(tree, *level), fmt::format("level {}", raw(*level)));
  }
  if (const auto* node = std::get_if<NodeId>(&selection))
    return export_tile(job, *node);
  if (const auto* path = std::get_if<fs::path>(&selection)) {
    return export_cut(job, read_cut(job.files, tree, *path), "cut");
  }
  return export_outline(job);
}

}  // namespace

std::string export_mesh(storage::FileSystem& files, const fs::path& hierarchy,
                        const ExportOptions& options, execution::Progress& progress,
                        const execution::CancelToken& cancel) {
  require_no_other_ending(options.output);
  storage::OutputRequest request{options.output, options.replace, {hierarchy}};
  if (const auto* cut = std::get_if<fs::path>(&options.selection))
    request.inputs.push_back(*cut);
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader reader(place.files(), hierarchy);
  if (!storage::is_standard_output(files, options.output))
    storage::require_outside(files, options.output);
  storage::OutputFile output(files, request, [&] { cancel.check(); });
  const ExportFormat format = format_of(options.output);
  if (format != ExportFormat::ply) {
    const PartsJob job{files, reader, request, output, progress, cancel};
    return fmt::format("{}: {}", options.output.string(), export_parts(job, options, format));
  }
  const ExportJob job{files, reader, output, options.memory_budget, progress, cancel};
  const std::string summary = export_selection(job, options.selection);
  output.publish();
  return fmt::format("{}: {}{}", options.output.string(), summary,
                     loses_textures(reader, options.selection)
                         ? "; without textures, which a .glb or an .obj has"
                         : "");
}

}  // namespace meshhier::inspection
