#include "export/export.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "export/cut_mesh.h"
#include "export/cut_vertices.h"
#include "export/export_parts.h"
#include "export/named_cut.h"
#include "export/piece.h"
#include "export/ply_vertices.h"
#include "export/tile_vertices.h"
#include "hierarchy/cut.h"
#include "mesh_io/output_name.h"
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

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;

using TriangleSpool = storage::RecordSpool<CutTriangle>;

/// Triangles on their way from the scratch to the writer: 768 KiB.
constexpr std::size_t kTriangleBlock = 65536;
/// Grain of the scratch: large writes, small beside any budget.
constexpr std::size_t kScratchBlockBytes = std::size_t{1} << 20;

/// The means that the four kinds of export share.
struct ExportJob {
  storage::FileSystem& files;
  const storage::HierarchyReader& reader;
  const storage::OutputFile& output;
  std::uint64_t memory_budget;
  execution::Progress& progress;
  const execution::CancelToken& cancel;
};

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
  // The other half is for a tile, the writer and the cut.
  storage::MemoryPool pool(job.memory_budget / 2);
  storage::ScratchFile scratch(job.files, job.output.scratch(), pool);
  TriangleSpool triangles(scratch, kScratchBlockBytes);

  job.reader.will_read(numbered.cut.nodes());
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
  mesh_io::PlyContent content = ply_content(job.reader, what);
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
  mesh_io::PlyContent content = ply_content(job.reader, what);
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

/// Returns whether a PLY leaves textures out.
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
  mesh_io::PlyContent content = ply_content(job.reader, "outline");
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

/// The format of an output, by the ending of its name.
enum class ExportFormat { ply, glb, obj };

ExportFormat format_of(const fs::path& output) {
  const std::string ending = storage::lower_extension(output);
  return ending == ".glb"   ? ExportFormat::glb
         : ending == ".obj" ? ExportFormat::obj
                            : ExportFormat::ply;
}

void require_own_ending(const fs::path& output) {
  mesh_io::require_true_ending(
      output.string(), {".ply", ".glb", ".obj"},
      storage::lower_extension(output) == ".gz"
          ? "export packs nothing; pack it yourself: -o - | gzip"
          : "export writes .ply, .glb, .obj, .hier, .3tz and .tif; choose one of these");
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
  job.reader.will_read(parts.cut().nodes());
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

std::string text_of(const Piece& piece) {
  return fmt::format("{} of {}", piece.size(), counted(piece.cut_size(), "tiles"));
}

/// Exports as export_cut(), but for the order of vertices.
std::string export_piece(const ExportJob& job, Piece& piece, const RegionRequest& region,
                         const std::string& what) {
  storage::MemoryPool pool(job.memory_budget / 4);
  storage::ScratchFile scratch(job.files, job.output.scratch(), pool);
  storage::RecordSpool<Vec3f> positions(scratch, kScratchBlockBytes);
  storage::RecordSpool<float> attributes(scratch, kScratchBlockBytes);
  TriangleSpool triangles(scratch, kScratchBlockBytes);
  PieceNumbers numbers(job.memory_budget / 4);
  job.progress.stage("export", piece.size(), "tiles");
  for (std::size_t i = 0; i < piece.size(); ++i) {
    job.cancel.check();
    const CutPart part = piece.load(i);
    const PieceNumbers::Numbered numbered = numbers.add(piece, i, part);
    for (const std::uint32_t vertex : numbered.fresh) {
      positions.append(part.vertices.positions[vertex]);
      attributes.append(part.vertices.attributes_of(vertex));
    }
    for (const auto& t : part.triangles)
      triangles.append(
          CutTriangle{numbered.numbers[t[0]], numbered.numbers[t[1]], numbered.numbers[t[2]]});
    job.progress.advance(1);
  }
  if (triangles.size() == 0)
    fail_empty(job.reader, region);
  mesh_io::PlyContent content = ply_content(job.reader, what);
  content.vertex_count = numbers.count();
  content.triangle_count = triangles.size();
  mesh_io::PlyWriter writer(job.output.file(), content);
  VertexArray block;
  block.channels = job.reader.tile_format().attributes.channels();
  for (std::uint64_t first = 0; first < positions.size(); first += block.size()) {
    block.positions.resize(std::min<std::uint64_t>(kTriangleBlock, positions.size() - first));
    block.attributes.resize(block.size() * static_cast<std::size_t>(block.channels));
    positions.read(first, block.positions);
    attributes.read(first * static_cast<std::uint64_t>(block.channels), block.attributes);
    write_vertices(writer, job.reader, block, block.size());
  }
  copy_triangles(triangles, writer);
  writer.finish();
  return fmt::format("{}: {}, {}, {}", what, text_of(piece),
                     counted(content.vertex_count, "vertices"),
                     counted(content.triangle_count, "triangles"));
}

/// Writes a piece into a file with the parts' pictures.
std::string export_parts_of_piece(const PartsJob& job, Piece& piece, const RegionRequest& region,
                                  ExportFormat format) {
  std::vector<std::uint32_t> bases{0};
  for (std::size_t i = 0; i < piece.size(); ++i) {
    job.cancel.check();
    bases.push_back(bases.back() + static_cast<std::uint32_t>(piece.load(i).vertices.size()));
  }
  if (bases.back() == 0)
    fail_empty(job.reader, region);
  const ExportedParts exported{piece.size(), [&](std::size_t i) { return piece.node(i); },
                               [&](std::size_t i) {
                                 CutPart part = piece.load(i);
                                 for (std::size_t v = 0; v < part.places.size(); ++v)
                                   part.places[v] = bases[i] + static_cast<std::uint32_t>(v);
                                 return part;
                               },
                               [&](std::size_t i) { return piece.load(i).vertices; }};
  return fmt::format("{}, {}", text_of(piece), write_parts(job, exported, format));
}

struct NamedPiece {
  Piece piece;
  std::string name;  ///< for people: "level 3, box"
};

/// Returns the piece that the options ask for: of no outline.
template <class Job>
NamedPiece piece_of(const Job& job, const ExportOptions& options) {
  const RegionRequest& request = options.region;
  const Clipping clipping = options.clip ? Clipping::at_border : Clipping::whole_triangles;
  if (const auto* node = std::get_if<NodeId>(&options.selection)) {
    require_node(job.reader.tree(), *node);
    return {{job.reader, *node, region_of(job.files, job.reader, request, job.cancel), clipping},
            fmt::format("tile {}, {}", to_text(*node), request.name())};
  }
  NamedCut cut = cut_of(job.files, job.reader, options.selection).value();
  return {{job.reader, std::move(cut.cut), region_of(job.files, job.reader, request, job.cancel),
           clipping, options.memory_budget / 4},
          fmt::format("{}, {}", cut.name, request.name())};
}

/// Writes a GLB or OBJ and publishes it.
std::string export_parts(const PartsJob& job, const ExportOptions& options, ExportFormat format) {
  if (options.region.is_any()) {
    auto [piece, name] = piece_of(job, options);
    return fmt::format("{}: {}", name, export_parts_of_piece(job, piece, options.region, format));
  }
  if (const auto* node = std::get_if<NodeId>(&options.selection))
    return fmt::format("tile {}: {}", to_text(*node), export_parts_of_tile(job, *node, format));
  std::optional<NamedCut> cut = cut_of(job.files, job.reader, options.selection);
  if (!cut) {
    throw Error(ErrorCode::usage, options.output.string() +
                                      ": the outline is lines, which are exported as a PLY alone");
  }
  return fmt::format("{}: {}", cut->name,
                     export_parts_of_cut(job, std::move(cut->cut), options.memory_budget, format));
}

std::string export_selection(const ExportJob& job, const ExportOptions& options) {
  if (options.region.is_any()) {
    auto [piece, name] = piece_of(job, options);
    return export_piece(job, piece, options.region, name);
  }
  if (const auto* node = std::get_if<NodeId>(&options.selection))
    return export_tile(job, *node);
  std::optional<NamedCut> cut = cut_of(job.files, job.reader, options.selection);
  if (!cut)
    return export_outline(job);
  return export_cut(job, std::move(cut->cut), cut->name);
}

void require_pieces(const ExportOptions& options) {
  if (options.region.is_any() && std::holds_alternative<OutlineSelection>(options.selection)) {
    throw Error(
        ErrorCode::usage,
        fmt::format("the outline is whole: a piece ({}) is taken of a level, a node, a cut or "
                    "what an error allows",
                    options.region.name()));
  }
}

}  // namespace

std::vector<fs::path> files_named(const ExportOptions& options) {
  std::vector<fs::path> files{options.region.polygon};
  if (const auto* cut = std::get_if<fs::path>(&options.selection))
    files.push_back(*cut);
  return files;
}

std::string export_mesh(storage::FileSystem& files, const fs::path& hierarchy,
                        const ExportOptions& options, execution::Progress& progress,
                        const execution::CancelToken& cancel) {
  if (!storage::is_standard_output(files, options.output))
    storage::require_outside(files, options.output);
  require_own_ending(options.output);
  require_pieces(options);
  storage::OutputRequest request{options.output, options.replace, files_named(options)};
  request.inputs.push_back(hierarchy);
  const storage::HierarchyFiles place(files, hierarchy);
  const storage::HierarchyReader reader(place.files(), hierarchy);
  storage::OutputFile output(files, request, [&] { cancel.check(); });
  const ExportFormat format = format_of(options.output);
  if (format != ExportFormat::ply) {
    const PartsJob job{files,
                       reader,
                       request,
                       output,
                       progress,
                       cancel,
                       options.memory_budget,
                       options.numbers_objects};
    return fmt::format("{}: {}", options.output.string(), export_parts(job, options, format));
  }
  const ExportJob job{files, reader, output, options.memory_budget, progress, cancel};
  const std::string summary = export_selection(job, options);
  output.publish();
  return fmt::format("{}: {}{}", options.output.string(), summary,
                     loses_textures(reader, options.selection)
                         ? "; without textures, which a .glb or an .obj has"
                         : "");
}

}  // namespace meshhier::exporting
