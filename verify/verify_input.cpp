// Proves the hierarchy lossless: the partitions hold the input's vertices and triangles, whatever
// their order.
//
// Both sides become sums over multisets: a vertex is hashed from the bits of its position (as
// stored) and attributes, a triangle from the hashes of its corners in their order around it. The
// sums are of two independent 64-bit hashes: two different multisets have the same sums with a
// chance of 2^-128. One 64-bit hash is kept for each input vertex, in a spool, with its position
// and texture coordinate for the texels (verify_texels.h).
//
// Where vertices of equal coordinates are one place, the input's distinct coordinates are counted,
// by sorting them. Copies lie where their places do (decode_tile), so if there are as many places
// no two of them lie together.
#include "base/error.h"
#include "base/plain_text.h"
#include "export/tile_vertices.h"
#include "hierarchy/cut.h"
#include "hierarchy/drawing_rule.h"
#include "hierarchy/lattice.h"
#include "import/input_record.h"
#include "import/mesh_input.h"
#include "mesh_io/mesh_source.h"
#include "partition/external_sort.h"
#include "partition/renumber.h"
#include "storage/io/hash.h"
#include "verify/input_use.h"
#include "verify/verify_objects.h"
#include "verify/verify_parts.h"
#include "verify/verify_texels.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

namespace meshhier::verifying {
namespace {

constexpr std::size_t kSpoolBlockBytes = std::size_t{1} << 20;
constexpr std::size_t kLongestName = 255;

/// XXH3 of a salt and some bytes: another salt is another, independent hash.
class SaltedHash {
 public:
  explicit SaltedHash(std::uint32_t salt) { append(&salt, sizeof salt); }
  void append(const void* bytes, std::size_t count) {
    std::memcpy(buffer_.data() + used_, bytes, count);
    used_ += count;
  }
  std::uint64_t value() const { return storage::checksum(std::span(buffer_).first(used_)); }

 private:
  /// The longest content: a position and all channels of a vertex.
  std::array<std::byte, 4 + sizeof(Vec3f) + kMaxChannels * sizeof(float)> buffer_;
  std::size_t used_ = 0;
};

enum Salt : std::uint32_t { kVertexTable = 1, kVertexA, kVertexB, kTriangleA, kTriangleB };

std::uint64_t hash_vertex(Salt salt, Vec3f position, std::span<const float> attributes) {
  SaltedHash hash(salt);
  hash.append(&position, sizeof position);
  if (!attributes.empty())
    hash.append(attributes.data(), attributes.size_bytes());
  return hash.value();
}

std::uint64_t hash_triangle(Salt salt, const Triangle<std::uint64_t>& corners) {
  SaltedHash hash(salt);
  hash.append(corners.data(), sizeof corners);
  return hash.value();
}

/// A sum that tells multisets apart.
struct MultisetSum {
  std::uint64_t count = 0, a = 0, b = 0;

  void add(std::uint64_t hash_a, std::uint64_t hash_b) {
    ++count;
    a += hash_a;
    b += hash_b;
  }
  friend bool operator==(const MultisetSum&, const MultisetSum&) = default;
};

struct MeshSums {
  MultisetSum vertices, triangles;

  void add_vertex(Vec3f position, std::span<const float> attributes) {
    vertices.add(hash_vertex(kVertexA, position, attributes),
                 hash_vertex(kVertexB, position, attributes));
  }
  /// Corners as kVertexTable hashes. Equal ones may be anywhere: the least of all turns is taken.
  void add_triangle(const Triangle<std::uint64_t>& t) {
    const Triangle<std::uint64_t> least = std::min({t, turned(t, 1), turned(t, 2)});
    triangles.add(hash_triangle(kTriangleA, least), hash_triangle(kTriangleB, least));
  }
};

/// Adds the first `own` of them to the sums, and hashes of all to `hashes`.
void add_vertices(const VertexArray& vertices, std::size_t own, MeshSums& sums,
                  std::vector<std::uint64_t>& hashes) {
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto attributes = vertices.attributes_of(v);
    if (v < own)
      sums.add_vertex(vertices.positions[v], attributes);
    hashes.push_back(hash_vertex(kVertexTable, vertices.positions[v], attributes));
  }
}

void add_tile(const PublishedTile& tile, MeshSums& sums) {
  const TileMesh& mesh = tile.mesh;
  std::vector<std::uint64_t> hashes;
  add_vertices(mesh.vertices, mesh.own_count, sums, hashes);
  add_vertices(mesh.copies.vertices, exporting::own_copy_count(mesh), sums, hashes);
  const auto add = [&](const TileTriangle& t) {
    sums.add_triangle({hashes[raw(t[0])], hashes[raw(t[1])], hashes[raw(t[2])]});
  };
  // A triangle that several tiles list is counted by the one that draws it among all partitions.
  const auto before = [&](std::size_t ghost) {
    return draws_before(tile.node, mesh.ghosts[ghost].tile, tile.node.level);
  };
  const VertexNumbers numbers = exporting::vertex_numbers(mesh);
  const auto interior = numbers.numbered(mesh.interior, mesh.interior_wedges);
  std::for_each(interior.begin(), interior.end(), add);
  const auto border = numbers.numbered(mesh.border, mesh.border_wedges);
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (draws(mesh, mesh.border[i], before))
      add(border[i]);
  }
}

MeshSums sum_partitions(const VerifyJob& job) {
  const Tree& tree = job.tree();
  MeshSums sums;
  for (std::uint32_t i = 0; i < tree.partition_count(); ++i) {
    job.cancel.check();
    if (const auto tile = job.tiles.find({tree.depth(), i}))
      add_tile(*tile, sums);
    job.progress.advance(1);
  }
  return sums;
}

/// Positions as the hierarchy stores them but for rounding: float, relative to its origin.
std::vector<Vec3f> stored_positions(const mesh_io::VertexBlock& block, Vec3d origin) {
  std::vector<Vec3f> positions;
  for (const Vec3d& p : block.exact)
    positions.push_back(to_float(p - origin));
  for (const Vec3f& p : block.positions) {
    positions.push_back(origin == Vec3d{} ? p : to_float(to_double(p) - origin));
  }
  return positions;
}

/// Counts the different coordinates of vertices, exactly; -0 is 0.
class PlaceCount {
 public:
  PlaceCount(storage::ScratchFile& scratch, std::uint64_t memory_bytes)
      : coordinates_(scratch, memory_bytes) {}

  void add(const mesh_io::VertexBlock& block) {
    coordinates_.add(block.exact);
    for (const Vec3f& p : block.positions)
      coordinates_.add(to_double(p));
  }
  /// Called once, after all vertices.
  std::uint64_t finish() {
    std::uint64_t places = 0;
    Vec3d last;
    coordinates_.sort();
    coordinates_.for_each_block([&](std::span<const Vec3d> block) {
      for (const Vec3d& p : block) {
        if (places == 0 || p != last)
          ++places;
        last = p;
      }
    });
    return places;
  }

 private:
  struct Key {
    auto operator()(const Vec3d& p) const { return std::tuple(p.x, p.y, p.z); }
  };
  partition::ExternalSort<Vec3d, Key> coordinates_;
};

/// The sums of the input.
struct InputSums {
  MeshSums mesh;
  /// Distinct coordinates, if the hierarchy has one place for each.
  std::optional<std::uint64_t> places;
  double worst_rounding = 0;  ///< to the hierarchy's lattice, if it has one
};

/// Returns whether vertices of equal coordinates were one place, as the manifest's config says.
bool has_topology_by_place(const VerifyJob& job) {
  const nlohmann::ordered_json& config = job.reader.manifest().config;
  const auto topology = config.find("topology");
  return topology != config.end() && *topology == "place";
}

/// Returns the attributes of an input that tiles have, besides coordinates in their own pictures.
AttributeLayout kept_layout(const AttributeLayout& layout) {
  return layout.material ? layout.without_texcoords() : layout;
}

/// The facts of a vertex that corners of triangles need.
struct CornerFacts {
  std::uint64_t hash = 0;
  InputCorner corner;
};

CornerFacts facts_of(std::uint64_t hash, Vec3f position, std::span<const float> attributes,
                     const AttributeLayout& layout) {
  CornerFacts facts{hash, {position, {}, 0}};
  if (layout.material) {
    const auto texcoord = layout.part(AttributeKind::texcoords).of(attributes);
    facts.corner.texcoord = {texcoord[0], texcoord[1]};
    facts.corner.material =
        static_cast<std::uint32_t>(attributes[layout.part(AttributeKind::material).first]);
  }
  return facts;
}

/// Adds up the vertices; puts into `table` what corners need of each.
void sum_vertices(const VerifyJob& job, mesh_io::MeshSource& source,
                  storage::RecordSpool<CornerFacts>& table, InputSums& result) {
  const AttributeLayout& layout = source.description().attributes;
  const auto all_channels = static_cast<std::size_t>(layout.channels());
  const auto channels = static_cast<std::size_t>(kept_layout(layout).channels());
  const Vec3d origin = job.reader.manifest().origin;
  const auto& quantization = job.reader.manifest().quantization;
  std::optional<PlaceCount> places;
  if (has_topology_by_place(job))
    places.emplace(job.scratch, job.options.memory_budget / 4);
  source.read_vertices([&](const mesh_io::VertexBlock& block) {
    job.cancel.check();
    if (places)
      places->add(block);
    std::vector<Vec3f> positions = stored_positions(block, origin);
    if (quantization) {
      const double worst = round_to(quantization->lattice, positions);
      result.worst_rounding = std::max(result.worst_rounding, worst);
    }
    std::vector<CornerFacts> facts;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto all = block.attributes.subspan(i * all_channels, all_channels);
      const auto attributes = all.first(channels);
      result.mesh.add_vertex(positions[i], attributes);
      facts.push_back(
          facts_of(hash_vertex(kVertexTable, positions[i], attributes), positions[i], all, layout));
    }
    table.append(facts);
  });
  if (places)
    result.places = places->finish();
}

/// Adds up the triangles by the table of vertices. `texels` takes those of a textured input; else
/// it is null.
void sum_triangles(const VerifyJob& job, mesh_io::MeshSource& source,
                   const storage::RecordSpool<CornerFacts>& table, TexelCheck* texels,
                   MeshSums& sums) {
  partition::Renumberer<CornerFacts> renumberer(
      table,
      partition::plan_renumbering(table.size(), sizeof(CornerFacts), job.options.memory_budget / 4),
      job.scratch);
  partition::Renumbered<CornerFacts> renumbered;
  const auto add = [&] {
    for (const Triangle<CornerFacts>& t : renumbered.finished) {
      sums.add_triangle({t[0].hash, t[1].hash, t[2].hash});
      if (texels != nullptr)
        texels->add({t[0].corner, t[1].corner, t[2].corner});
    }
    renumberer.keep(renumbered);
  };
  source.read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
    job.cancel.check();
    renumberer.translate(triangles, renumbered);
    add();
  });
  while (renumberer.next_round()) {
    for (std::uint64_t batch = 0; batch < renumberer.batches(); ++batch) {
      job.cancel.check();
      renumberer.translate_batch(batch, renumbered);
      add();
    }
  }
}

InputSums sum_input(const VerifyJob& job, mesh_io::MeshSource& source, TexelCheck* texels) {
  InputSums result;
  storage::RecordSpool<CornerFacts> table(job.scratch, kSpoolBlockBytes);
  sum_vertices(job, source, table, result);
  sum_triangles(job, source, table, texels, result.mesh);
  return result;
}

/// The input file's name starts the problem.
class InputProblems {
 public:
  explicit InputProblems(const VerifyJob& job) : job_(job) {}

  template <class Value>
  void compare(std::string_view what, const Value& expected, const Value& found) const {
    if (expected == found)
      return;
    add(fmt::format("{} {}, but the hierarchy was made of {}", found, what, expected));
  }
  void add(const std::string& problem) const {
    job_.problems.add(job_.options.input.string() + ": " + problem);
  }

 private:
  const VerifyJob& job_;
};

std::string described(const SourceFile& file) {
  return fmt::format("{} ({})", plain_text(file.name, kLongestName), file.format);
}

/// Tells which of several files are others.
void compare_each(const std::vector<SourceFile>& expected, const std::vector<SourceFile>& found,
                  const InputProblems& problems) {
  const auto is_in = [](const SourceFile& file, const std::vector<SourceFile>& all) {
    return std::ranges::any_of(all, [&](const SourceFile& one) {
      return one.checksum == file.checksum && one.format == file.format;
    });
  };
  for (const SourceFile& file : found) {
    if (!is_in(file, expected))
      problems.add(described(file) + ": not what the hierarchy was made of");
  }
  for (const SourceFile& file : expected) {
    if (std::ranges::find(found, file.format, &SourceFile::format) == found.end())
      problems.add(described(file) + ": the hierarchy was made of it, but the input has none");
  }
}

void compare_files(const VerifyJob& job, importing::MeshInput& input,
                   const InputProblems& problems) {
  const SourceSummary& expected = job.reader.manifest().source;
  problems.compare("bytes", expected.file_bytes, input.files().bytes());
  const std::uint64_t checksum = input.checksum(job.cancel);
  if (checksum == expected.checksum)
    return;
  problems.add(fmt::format("checksum {:016x}, but the hierarchy was made of a file with {:016x}",
                           checksum, expected.checksum));
  SourceSummary found;
  input.complete(found);
  if (found.files.size() > 1 || expected.files.size() > 1)
    compare_each(expected.files, found.files, problems);
}

/// Returns the attributes of an input as the manifest has those of the mesh it was made of.
AttributeLayout layout_as_told(const VerifyJob& job, const AttributeLayout& layout) {
  const SourceSummary& expected = job.reader.manifest().source;
  AttributeLayout kept = kept_layout(layout);
  if (job.reader.manifest().screen_colours)
    kept.space = expected.attributes.space;  // older formats did not tell the two apart
  kept.tints = expected.attributes.tints;    // says how colours are seen, not which they are
  if (kept.has_colours() && expected.count_of(importing::kColoursTakenForBytes) > 0)
    kept.colour = ColourType::u8;
  return kept;
}

void compare_counts(const VerifyJob& job, const InputSums& sums, const InputProblems& problems) {
  const SourceSummary& expected = job.reader.manifest().source;
  problems.compare("vertices", expected.vertices, sums.mesh.vertices.count);
  problems.compare("triangles", expected.triangles, sums.mesh.triangles.count);
  if (sums.places)
    problems.compare("different places of vertices", job.tree().vertex_count(), *sums.places);
}

void compare_sums(const MeshSums& input, const MeshSums& partitions,
                  const InputProblems& problems) {
  const auto compare = [&](std::string_view what, const MultisetSum& in, const MultisetSum& out) {
    if (in == out)
      return;
    const std::string how =
        in.count == out.count
            ? fmt::format("{} {}, but some are not the same", in.count, what)
            : fmt::format("{} {}, the partitions hold {}", in.count, what, out.count);
    problems.add("not what the partitions hold: " + how);
  };
  compare("vertices", input.vertices, partitions.vertices);
  compare("triangles", input.triangles, partitions.triangles);
}

void compare_with_lattice(const VerifyJob& job, double worst_rounding,
                          const InputProblems& problems) {
  const auto& quantization = job.reader.manifest().quantization;
  if (quantization && worst_rounding > quantization->worst_rounding) {
    problems.add(fmt::format("a vertex is {} from its place on the lattice, more than the {} told",
                             worst_rounding, quantization->worst_rounding));
  }
}

void read_input(const VerifyJob& job, importing::MeshInput& files) {
  if (job.reader.manifest().source.count_of(importing::kDroppedUnplaced) > 0)
    files.note_unplaced();
  if (files.needs_import()) {
    files.import({job.scratch.path().string() + "-import", job.scratch.path().string() + "-sorts",
                  job.scratch.pool(), job.options.memory_budget / 8, job.progress, job.cancel});
  }
}

}  // namespace

void verify_input(const VerifyJob& job) {
  const InputProblems problems(job);
  const SourceSummary& expected = job.reader.manifest().source;
  mesh_io::InputPaths inputs = job.options.input;
  const importing::InputUse use = take_input_use(job, inputs);
  importing::MeshInput files(inputs, job.files, use);
  read_input(job, files);
  job.progress.stage("input", job.tree().partition_count(), "partitions");
  compare_files(job, files, problems);
  const auto source = files.open();
  const AttributeLayout& layout = source->description().attributes;
  if (layout_as_told(job, layout) != expected.attributes ||
      layout.material != expected.textures.has_value()) {
    problems.add("has other vertex attributes than the mesh the hierarchy was made of");
    return;
  }
  if (files.objects())
    compare_objects(job, files.objects()->file,
                    [&](const std::string& text) { problems.add(text); });
  std::optional<TexelCheck> texels;
  if (layout.material)
    texels.emplace(job, files);
  const InputSums sums = sum_input(job, *source, texels ? &*texels : nullptr);
  compare_counts(job, sums, problems);
  compare_sums(sums.mesh, sum_partitions(job), problems);
  compare_with_lattice(job, sums.worst_rounding, problems);
  job.checks.push_back(
      fmt::format("input: {}{} and {} compared with those of the partitions, bit for bit",
                  counted(sums.mesh.vertices.count, "vertices"),
                  job.reader.manifest().quantization ? ", rounded to the lattice," : "",
                  counted(sums.mesh.triangles.count, "triangles")));
  if (texels)
    texels->compare();
}

}  // namespace meshhier::verifying
