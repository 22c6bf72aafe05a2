// make_surface(): a base shape, cut into a grid, displaced by fractal relief.
#include "base/error.h"
#include "bench/block_writer.h"
#include "bench/generator.h"
#include "bench/noise.h"
#include "bench/relief_surface.h"

#include <algorithm>
#include <cmath>

namespace meshhier::bench {
namespace {

/// The pigments' largest patches, and how deep they go: visible at every level of detail.
constexpr double kColourFrequency = 3;
constexpr int kColourOctaves = 6;
/// Apart from the random sequences of the relief and of the noise.
constexpr std::uint64_t kColourStream = 0x636f6c6f7572;

float colour_byte(double value) {
  return static_cast<float>(std::floor(std::clamp(value, 0.0, 255.0) + 0.5));
}

class Surface final : public GeneratedMesh {
 public:
  explicit Surface(const SurfaceOptions& options)
      : options_(options),
        surface_(options),
        pigment_(
            {random_at(options.seed, kColourStream), 1, kColourFrequency, 0.6, kColourOctaves}) {
    content_.vertex_count = surface_.grid().vertex_count();
    content_.triangle_count = surface_.grid().triangle_count();
    content_.attributes.normals = options.normals;
    content_.attributes.colour = options.colours ? ColourType::u8 : ColourType::none;
    content_.attributes.alpha = options.alpha;
    content_.double_coordinates = options.double_coordinates;
    content_.comments = {"meshgen surface: " + description_of(options)};
  }

  const mesh_io::PlyContent& content() const override { return content_; }

  void visit_vertices(std::size_t block_size, const VertexBlockVisitor& visit) const override {
    VertexCollector blocks(block_size, visit);
    surface_.visit_vertices([&](const ReliefVertex& vertex) { add_vertex(vertex, blocks); });
    blocks.flush();
  }

  void visit_triangles(std::size_t block_size, const TriangleBlockVisitor& visit) const override {
    TriangleCollector blocks(block_size, visit);
    const PatchGrid& grid = surface_.grid();
    std::vector<std::uint32_t> lower;
    std::vector<std::uint32_t> upper;
    for (std::uint32_t patch = 0; patch < grid.patch_count(); ++patch) {
      index_row(patch, 0, upper);
      for (std::uint32_t row = 0; row < grid.cells(); ++row) {
        lower.swap(upper);
        index_row(patch, row + 1, upper);
        add_strip({patch, 0, row}, lower, upper, blocks);
      }
    }
    blocks.flush();
  }

 private:
  void index_row(std::uint32_t patch, std::uint32_t row,
                 std::vector<std::uint32_t>& indices) const {
    indices.clear();
    for (std::uint32_t column = 0; column <= surface_.grid().cells(); ++column)
      indices.push_back(static_cast<std::uint32_t>(surface_.grid().index({patch, column, row})));
  }

  static void add_strip(PatchPoint cell, const std::vector<std::uint32_t>& lower,
                        const std::vector<std::uint32_t>& upper, TriangleCollector& blocks) {
    const auto number = [&](PatchPoint at) {
      return (at.row == cell.row ? lower : upper)[at.column];
    };
    for (; cell.column + 1 < lower.size(); ++cell.column) {
      for (const auto& [a, b, c] : triangles_of(cell))
        blocks.add({number(a), number(b), number(c)});
    }
  }

  void add_vertex(const ReliefVertex& vertex, VertexCollector& blocks) const {
    std::array<float, kMaxChannels> attributes{};
    if (options_.normals)
      set_normal(vertex.base.normal, vertex.slope, attributes);
    if (options_.colours)
      set_colour(vertex.base.position, attributes);
    const auto channels = static_cast<std::size_t>(content_.attributes.channels());
    blocks.add(surface_.stored(vertex), std::span<const float>(attributes).first(channels));
  }

  /// The displaced surface leans against the relief's slope along it.
  static void set_normal(Vec3d normal, Vec3d gradient, std::span<float> attributes) {
    const Vec3d slope = gradient - normal * dot(normal, gradient);
    const Vec3d leaning = normal - slope;
    const Vec3f unit = to_float(leaning * (1 / length(leaning)));
    attributes[0] = unit.x;
    attributes[1] = unit.y;
    attributes[2] = unit.z;
  }

  /// Two pigments mixed by the noise's value, shaded a little by its slopes.
  void set_colour(Vec3d p, std::span<float> attributes) const {
    const NoiseSample pigment = pigment_.at(p);
    const auto first = content_.attributes.part(AttributeKind::colours).first;
    attributes[first] = colour_byte(150 + 70 * pigment.value);
    attributes[first + 1] = colour_byte(120 - 60 * pigment.value + 4 * pigment.gradient.x);
    attributes[first + 2] = colour_byte(100 + 4 * pigment.gradient.z);
    if (options_.alpha)
      attributes[first + 3] = colour_byte(220 + 5 * pigment.gradient.y);
  }

  SurfaceOptions options_;
  ReliefSurface surface_;
  FractalNoise pigment_;
  mesh_io::PlyContent content_;
};

}  // namespace

std::unique_ptr<GeneratedMesh> make_surface(const SurfaceOptions& options) {
  if (options.alpha && !options.colours)
    throw Error(ErrorCode::usage, "alpha is a channel of the colours: ask for colours too");
  return std::make_unique<Surface>(options);
}

}  // namespace meshhier::bench
