#include "query/row_source.h"

#include "base/error.h"
#include "mesh_io/input_stream.h"
#include "mesh_io/mesh_source.h"
#include "query/npy_rows.h"
#include "query/start_of_stream.h"
#include "query/text_rows.h"
#include "storage/io/output_file.h"
#include "storage/io/stream.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace meshhier::querying {
namespace {

/// Bytes that come by a pipe.
class StandardInput final : public mesh_io::InputStream {
 public:
  explicit StandardInput(const std::function<void()>& check) : check_(check) {}
  std::size_t read(std::span<std::byte> to) override {
    std::size_t count = 0;
    while (count < to.size()) {
      const std::size_t some = storage::read_standard_input(to.subspan(count), check_);
      if (some == 0)
        break;
      count += some;
    }
    return count;
  }

 private:
  const std::function<void()>& check_;
};

std::uint64_t read_stream(StartOfStream& stream, const std::string& name, RowKind kind,
                          const RowVisitor& visit) {
  return is_npy(stream.start()) ? read_npy_rows(stream, name, kind, visit)
                                : read_text_rows(stream, name, kind, visit);
}

/// Whether bytes begin as a PLY does.
bool is_ply(std::string_view start) {
  return start.starts_with("ply\n") || start.starts_with("ply\r");
}

/// Reads the vertices of a PLY.
std::uint64_t read_ply_rows(storage::FileSystem& files, const std::filesystem::path& path,
                            RowKind kind, const RowVisitor& visit,
                            const std::function<void()>& check) {
  const auto source = mesh_io::open_mesh(files, path);
  const AttributeLayout& layout = source->description().attributes;
  const auto channels = static_cast<std::size_t>(layout.channels());
  const auto normal = layout.part(AttributeKind::normals).first;
  if (kind == RowKind::rays && !layout.normals)
    throw Error(ErrorCode::input,
                fmt::format("{}: its vertices have no normals (nx, ny, nz), which would be the "
                            "directions of rays",
                            path.string()));
  std::vector<double> rows;
  source->read_vertices([&](const mesh_io::VertexBlock& block) {
    check();
    const std::size_t count = std::max(block.positions.size(), block.exact.size());
    rows.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3d place = block.exact.empty() ? to_double(block.positions[i]) : block.exact[i];
      rows.insert(rows.end(), {place.x, place.y, place.z});
      if (kind == RowKind::rays) {
        const auto direction = block.attributes.subspan(i * channels + normal, 3);
        rows.insert(rows.end(), direction.begin(), direction.end());
      }
    }
    visit(rows);
  });
  return source->description().vertex_count;
}

}  // namespace

std::uint64_t read_rows(storage::FileSystem& files, const std::filesystem::path& path, RowKind kind,
                        const RowVisitor& visit, const std::function<void()>& check) {
  if (path == storage::kStandardOutput) {
    StandardInput input(check);
    StartOfStream stream(input);
    if (is_ply(stream.start()))
      throw Error(ErrorCode::input, "a PLY cannot be read from standard input: name its file");
    if (stream.start().starts_with("\x1f\x8b"))
      throw Error(ErrorCode::input, "standard input is packed by gzip: name its file");
    return read_stream(stream, "standard input", kind, visit);
  }
  const auto file = files.open(path);
  const auto input = mesh_io::open_stream({*file, file->size()}, [&](std::uint64_t) { check(); });
  StartOfStream stream(*input);
  if (is_ply(stream.start()))
    return read_ply_rows(files, path, kind, visit, check);
  return read_stream(stream, path.string(), kind, visit);
}

}  // namespace meshhier::querying
