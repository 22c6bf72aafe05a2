#include "bench/textured_files.h"

#include "base/error.h"
#include "bench/buffered_file.h"
#include "bench/require_range.h"
#include "execution/cancel.h"
#include "execution/parallel.h"
#include "images/row_writer.h"
#include "storage/io/little_endian.h"

#include <array>
#include <bit>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace meshhier::bench {
namespace {

/// The files of one mesh.
class Names {
 public:
  Names(std::filesystem::path mesh, ImageFormat format)
      : mesh_(std::move(mesh)), ending_(row_of(format).file.endings[0]) {}

  std::string material(std::uint32_t image) const {
    return fmt::format("{}_{:04}", mesh_.stem().string(), image);
  }
  std::string image(std::uint32_t image) const {
    return fmt::format("{}{}", material(image), ending_);
  }
  std::string mtl_name() const { return mesh_.stem().string() + ".mtl"; }
  std::filesystem::path beside(const std::string& name) const { return mesh_.parent_path() / name; }

 private:
  std::filesystem::path mesh_;
  std::string_view ending_;
};

/// A texture coordinate as OBJ and PLY have it: v from below.
Vec2f file_texcoord(TexelPlace texel, std::uint32_t side) {
  return {static_cast<float>(texel.x / side), static_cast<float>(1 - texel.y / side)};
}

/// Calls visit(corners) for each triangle of a chart, row by row of its cells.
template <class Visit>
void visit_triangles(const PlacedChart& chart, const Visit& visit) {
  for (std::uint32_t row = 0; row < chart.cells.rows(); ++row) {
    for (std::uint32_t column = 0; column < chart.cells.columns(); ++column) {
      for (const auto& corners : triangles_of(grid_point(chart, column, row)))
        visit(corners);
    }
  }
}

/// Returns where a point of the grid lies within its chart.
ChartPlace place_in(const PlacedChart& chart, PatchPoint at) {
  return {static_cast<double>(at.column - chart.cells.column_begin),
          static_cast<double>(at.row - chart.cells.row_begin)};
}

// ---- OBJ -----------------------------------------------------------------------------------

class ObjFile {
 public:
  ObjFile(std::shared_ptr<storage::File> file, const TexturedScan& surface, const Names& names)
      : out_(std::move(file)), surface_(surface), names_(names) {}

  std::uint64_t write() {
    out_.print("# meshgen textured: {}\nmtllib {}\n", description_of(surface_.options().surface),
               names_.mtl_name());
    surface_.surface().visit_vertices([&](const ReliefVertex& v) { write_position(v); });
    surface_.visit_charts([&](const PlacedChart& chart) { write_chart(chart); });
    out_.flush();
    return out_.size();
  }

 private:
  void write_position(const ReliefVertex& vertex) {
    const Vec3d at = surface_.surface().stored(vertex);
    if (surface_.options().surface.double_coordinates)
      out_.print("v {} {} {}\n", at.x, at.y, at.z);
    else
      out_.print("v {} {} {}\n", to_float(at).x, to_float(at).y, to_float(at).z);
  }

  void write_chart(const PlacedChart& chart) {
    if (material_ != chart.image + std::uint64_t{1}) {
      out_.print("usemtl {}\n", names_.material(chart.image));
      material_ = chart.image + std::uint64_t{1};
    }
    write_texcoords(chart);
    visit_triangles(chart, [&](const std::array<PatchPoint, 3>& corners) {
      const auto& [a, b, c] = corners;
      out_.print("f {}/{} {}/{} {}/{}\n", position(a), texcoord(chart, a), position(b),
                 texcoord(chart, b), position(c), texcoord(chart, c));
    });
    texcoords_ += std::uint64_t{chart.cells.columns() + 1} * (chart.cells.rows() + 1);
  }

  void write_texcoords(const PlacedChart& chart) {
    for (std::uint32_t row = 0; row <= chart.cells.rows(); ++row) {
      for (std::uint32_t column = 0; column <= chart.cells.columns(); ++column) {
        const auto [u, v] =
            file_texcoord(chart.texel_of({static_cast<double>(column), static_cast<double>(row)}),
                          surface_.atlas().options().side);
        out_.print("vt {} {}\n", u, v);
      }
    }
  }

  std::uint64_t position(PatchPoint at) const { return surface_.grid().index(at) + 1; }
  std::uint64_t texcoord(const PlacedChart& chart, PatchPoint at) const {
    return texcoords_ + 1 +
           std::uint64_t{at.row - chart.cells.row_begin} * (chart.cells.columns() + 1) +
           (at.column - chart.cells.column_begin);
  }

  BufferedFile out_;
  const TexturedScan& surface_;
  const Names& names_;
  std::uint64_t material_ = 0;   ///< number of the material in use, plus 1
  std::uint64_t texcoords_ = 0;  ///< written before the current chart
};

std::string library_text(const TexturedScan& surface, const Names& names) {
  std::string text;
  for (std::uint32_t i = 0; i < surface.atlas().options().images; ++i) {
    text += fmt::format("newmtl {}\nKd 1 1 1\nillum 0\nmap_Kd {}\n\n", names.material(i),
                        names.image(i));
  }
  return text;
}

void write_library(storage::FileSystem& files, const storage::OutputRequest& request,
                   const TexturedScan& surface, const Names& names) {
  storage::OutputFile output(files, {names.beside(names.mtl_name()), request.replace, {}});
  const std::string text = library_text(surface, names);
  output.publish(std::as_bytes(std::span(text)));
}

// ---- PLY -----------------------------------------------------------------------------------

class PlyFile {
 public:
  PlyFile(std::shared_ptr<storage::File> file, const TexturedScan& surface, const Names& names)
      : out_(std::move(file)), surface_(surface), names_(names) {}

  std::uint64_t write() {
    write_header();
    surface_.surface().visit_vertices([&](const ReliefVertex& v) { write_position(v); });
    surface_.visit_charts([&](const PlacedChart& chart) {
      visit_triangles(
          chart, [&](const std::array<PatchPoint, 3>& corners) { write_face(chart, corners); });
    });
    out_.flush();
    return out_.size();
  }

 private:
  void write_header() {
    const SurfaceOptions& options = surface_.options().surface;
    out_.print("ply\nformat binary_little_endian 1.0\ncomment meshgen textured: {}\n",
               description_of(options));
    for (std::uint32_t i = 0; i < surface_.atlas().options().images; ++i)
      out_.print("comment TextureFile {}\n", names_.image(i));
    out_.print("element vertex {}\n", surface_.grid().vertex_count());
    for (const char axis : {'x', 'y', 'z'})
      out_.print("property {} {}\n", options.double_coordinates ? "double" : "float", axis);
    out_.print(
        "element face {}\nproperty list uchar uint vertex_indices\n"
        "property list uchar float texcoord\nproperty int texnumber\nend_header\n",
        surface_.grid().triangle_count());
  }

  void write_position(const ReliefVertex& vertex) {
    const Vec3d at = surface_.surface().stored(vertex);
    for (const double part : {at.x, at.y, at.z}) {
      if (surface_.options().surface.double_coordinates)
        put(std::bit_cast<std::uint64_t>(part));
      else
        put(static_cast<float>(part));
    }
  }

  void write_face(const PlacedChart& chart, const std::array<PatchPoint, 3>& corners) {
    put(std::uint8_t{3});
    for (const PatchPoint& at : corners)
      put(static_cast<std::uint32_t>(surface_.grid().index(at)));
    put(std::uint8_t{6});
    for (const PatchPoint& at : corners) {
      const auto [u, v] =
          file_texcoord(chart.texel_of(place_in(chart, at)), surface_.atlas().options().side);
      put(u);
      put(v);
    }
    put(chart.image);
  }

  template <class T>
  void put(T value) {
    std::array<std::byte, sizeof(T)> bytes{};
    storage::store_little(value, bytes.data());
    out_.append(bytes);
  }

  BufferedFile out_;
  const TexturedScan& surface_;
  const Names& names_;
};

// ---- pictures ------------------------------------------------------------------------------

std::uint64_t write_image(storage::FileSystem& files, const storage::OutputRequest& request,
                          const TexturedScan& surface, const images::WrittenImage& format,
                          std::uint32_t image) {
  storage::OutputFile output(files, request);
  BufferedFile bytes(output.file());
  const auto writer =
      images::open_row_writer(format, [&](std::span<const std::byte> more) { bytes.append(more); });
  surface.visit_rows(image,
                     [&](std::span<const std::uint8_t> row) { writer->write_row(row.data()); });
  writer->finish();
  bytes.flush();
  output.publish();
  return bytes.size();
}

std::uint64_t write_images(storage::FileSystem& files, const storage::OutputRequest& request,
                           const TexturedScan& surface, const TexturedFileOptions& options,
                           const Names& names) {
  const AtlasOptions& atlas = surface.atlas().options();
  const images::WrittenImage format{options.image, options.quality, atlas.side, atlas.side, 3};
  std::uint64_t bytes = 0;
  execution::ordered_for(
      atlas.images, execution::useful_blocks(UINT64_MAX, 1), execution::CancelToken{},
      [&](std::size_t i) {
        const auto image = static_cast<std::uint32_t>(i);
        return write_image(files, {names.beside(names.image(image)), request.replace, {}}, surface,
                           format, image);
      },
      [&](std::size_t, std::uint64_t more) { bytes += more; });
  return bytes;
}

void require_file(storage::FileSystem& files, const std::filesystem::path& path) {
  if (storage::is_standard_output(files, path))
    throw Error(ErrorCode::usage,
                "output: a textured mesh is several files, which standard output cannot take; name "
                "a file");
}

}  // namespace

TexturedFileSizes write_textured(storage::FileSystem& files, const storage::OutputRequest& request,
                                 const TexturedScan& surface, const TexturedFileOptions& options) {
  require_file(files, request.path);
  require_range("quality", options.quality, 1, 100);
  const Names names(request.path, options.image);
  storage::OutputFile output(files, request);
  TexturedFileSizes sizes;
  sizes.image_bytes = write_images(files, request, surface, options, names);
  if (options.mesh == MeshFileFormat::obj) {
    write_library(files, request, surface, names);
    sizes.mesh_bytes = ObjFile(output.file(), surface, names).write();
  } else {
    sizes.mesh_bytes = PlyFile(output.file(), surface, names).write();
  }
  output.publish();
  return sizes;
}

}  // namespace meshhier::bench
