// make_surface(): a base shape, cut into a grid, displaced by fractal relief.
#include "bench/block_writer.h"
#include "bench/generator.h"
#include "bench/noise.h"
#include "bench/patch_grid.h"
#include "hierarchy/error.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

/// Cycles of the coarsest relief along half the shape's thickness: a few large forms, as a statue
/// has.
constexpr double kFirstFrequency = 1.5;
/// More octaves than the step of 2^32 vertices can show.
constexpr int kMaxOctaves = 20;
/// The pigments' largest patches, and how deep they go: visible at every level of detail.
constexpr double kColourFrequency = 3;
constexpr int kColourOctaves = 6;
/// Apart from the relief's and the noise's random sequences.
constexpr std::uint64_t kColourStream = 0x636f6c6f7572;
constexpr std::uint64_t kNoiseStream = 0x6e6f697365;

void require_range(const char* option, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw Error(ErrorCode::usage,
                fmt::format("{} must be from {} to {}, found {}", option, low, high, value));
  }
}

void check(const SurfaceOptions& options) {
  require_range("height", options.height, 0, 0.9);
  require_range("roughness", options.roughness, 0, 0.9);
  require_range("noise", options.noise, 0, 1);
  if (options.alpha && !options.colours)
    throw Error(ErrorCode::usage, "alpha is a channel of the colours: ask for colours too");
  for (const double part : {options.offset.x, options.offset.y, options.offset.z})
    require_range("offset", part, -1e12, 1e12);
}

/// The least n with 2 n^2 patches >= triangles.
std::uint32_t cells_for(std::uint64_t triangles, std::size_t patches) {
  // A closed surface has about half as many vertices as triangles: 2^33 of them always suffice.
  constexpr std::uint64_t kMostTriangles = std::uint64_t{1} << 33;
  if (triangles < 1 || triangles > kMostTriangles) {
    throw Error(ErrorCode::usage,
                fmt::format("triangles must be from 1 to {}, found {}", kMostTriangles, triangles));
  }
  std::uint32_t cells = 1;
  for (std::uint32_t step = 1u << 16; step > 0; step /= 2) {
    const std::uint64_t tried = std::uint64_t{cells} + step;
    if (2 * (tried - 1) * (tried - 1) * patches < triangles)
      cells += step;
  }
  return cells;
}

FractalOptions relief_options(const SurfaceOptions& options, double thickness, double step) {
  FractalOptions relief;
  relief.seed = options.seed;
  relief.gain = options.roughness;
  // The octaves' heights are a geometric series that sums up to the whole.
  relief.height = options.height * thickness * (1 - options.roughness);
  relief.frequency = kFirstFrequency / thickness;
  // The finest wave is at least two steps long; shorter ones the grid cannot show.
  relief.octaves = 0;
  for (double wave = 1 / relief.frequency; wave >= 2 * step && relief.octaves < kMaxOctaves;
       wave /= 2)
    ++relief.octaves;
  return relief;
}

float colour_byte(double value) {
  return static_cast<float>(std::floor(std::clamp(value, 0.0, 255.0) + 0.5));
}

class Surface final : public GeneratedMesh {
 public:
  explicit Surface(const SurfaceOptions& options)
      : options_(options),
        base_(options.shape),
        grid_(base_.patches(), cells_for(options.triangles, base_.patches().faces.size())),
        step_(base_.patch_size() / grid_.cells()),
        relief_(relief_options(options, base_.thickness(), step_)),
        pigment_(
            {random_at(options.seed, kColourStream), 1, kColourFrequency, 0.6, kColourOctaves}) {
    content_.vertex_count = grid_.vertex_count();
    content_.triangle_count = grid_.triangle_count();
    if (content_.vertex_count > 0xffffffffu) {
      throw Error(ErrorCode::usage,
                  fmt::format("triangles: {} need {} vertices, more than 2^32 - 1; ask for fewer",
                              content_.triangle_count, content_.vertex_count));
    }
    content_.attributes.normals = options.normals;
    content_.attributes.colour = options.colours ? ColourType::u8 : ColourType::none;
    content_.attributes.alpha = options.alpha;
    content_.double_coordinates = options.double_coordinates;
    content_.comments = {fmt::format(
        "meshgen surface: {}, seed {}, height {}, roughness {}, noise {}", name_of(options.shape),
        options.seed, options.height, options.roughness, options.noise)};
  }

  const mesh_io::PlyContent& content() const override { return content_; }

  void visit_vertices(std::size_t block_size, const VertexBlockVisitor& visit) const override {
    VertexBlocks blocks(block_size, visit);
    std::uint64_t index = 0;
    for (std::uint32_t patch = 0; patch < grid_.patch_count(); ++patch) {
      for (std::uint32_t row = 0; row <= grid_.cells(); ++row) {
        for (std::uint32_t column = 0; column <= grid_.cells(); ++column) {
          if (grid_.is_owned({patch, column, row}))
            add_vertex({patch, column, row}, index++, blocks);
        }
      }
    }
    blocks.flush();
  }

  void visit_triangles(std::size_t block_size, const TriangleBlockVisitor& visit) const override {
    TriangleBlocks blocks(block_size, visit);
    std::vector<std::uint32_t> lower;
    std::vector<std::uint32_t> upper;
    for (std::uint32_t patch = 0; patch < grid_.patch_count(); ++patch) {
      index_row(patch, 0, upper);
      for (std::uint32_t row = 0; row < grid_.cells(); ++row) {
        lower.swap(upper);
        index_row(patch, row + 1, upper);
        add_strip(row, lower, upper, blocks);
      }
    }
    blocks.flush();
  }

 private:
  void index_row(std::uint32_t patch, std::uint32_t row,
                 std::vector<std::uint32_t>& indices) const {
    indices.clear();
    for (std::uint32_t column = 0; column <= grid_.cells(); ++column)
      indices.push_back(static_cast<std::uint32_t>(grid_.index({patch, column, row})));
  }

  /// Diagonals alternate, as a checkerboard: no direction is preferred.
  static void add_strip(std::uint32_t row, const std::vector<std::uint32_t>& lower,
                        const std::vector<std::uint32_t>& upper, TriangleBlocks& blocks) {
    for (std::size_t c = 0; c + 1 < lower.size(); ++c) {
      if ((row + c) % 2 == 0) {
        blocks.add({lower[c], lower[c + 1], upper[c + 1]});
        blocks.add({lower[c], upper[c + 1], upper[c]});
      } else {
        blocks.add({lower[c], lower[c + 1], upper[c]});
        blocks.add({lower[c + 1], upper[c + 1], upper[c]});
      }
    }
  }

  void add_vertex(GridPoint at, std::uint64_t index, VertexBlocks& blocks) const {
    const double cells = grid_.cells();
    const SurfacePoint base = base_.at(at.patch, at.column / cells, at.row / cells);
    const NoiseSample relief = relief_.at(base.position);
    const double noise =
        options_.noise * step_ * signed_unit(random_at(options_.seed ^ kNoiseStream, index));
    const Vec3d moved = base.position + base.normal * (relief.value + noise) + options_.offset;
    std::array<float, kMaxChannels> attributes{};
    if (options_.normals)
      set_normal(base.normal, relief.gradient, attributes);
    if (options_.colours)
      set_colour(base.position, attributes);
    const auto channels = static_cast<std::size_t>(content_.attributes.channels());
    blocks.add(options_.double_coordinates ? moved : rounded_to_float(moved),
               std::span<const float>(attributes).first(channels));
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
    const auto first = static_cast<std::size_t>(content_.attributes.colour_offset());
    attributes[first] = colour_byte(150 + 70 * pigment.value);
    attributes[first + 1] = colour_byte(120 - 60 * pigment.value + 4 * pigment.gradient.x);
    attributes[first + 2] = colour_byte(100 + 4 * pigment.gradient.z);
    if (options_.alpha)
      attributes[first + 3] = colour_byte(220 + 5 * pigment.gradient.y);
  }

  SurfaceOptions options_;
  BaseSurface base_;
  PatchGrid grid_;
  double step_;
  FractalNoise relief_;
  FractalNoise pigment_;
  mesh_io::PlyContent content_;
};

}  // namespace

std::unique_ptr<GeneratedMesh> make_surface(const SurfaceOptions& options) {
  check(options);
  return std::make_unique<Surface>(options);
}

}  // namespace meshhier::bench
