#include "compare/difference_ply.h"

#include "mesh_io/ply_writer.h"

#include <algorithm>
#include <vector>

namespace meshhier::comparing {
namespace {

/// Grain of the scratch: large writes, small beside any budget.
constexpr std::size_t kDifferenceBlockBytes = std::size_t{1} << 18;
constexpr std::size_t kCopiedAtOnce = 65536;

}  // namespace

DifferencePly::DifferencePly(storage::FileSystem& files, const storage::OutputRequest& request,
                             std::uint64_t memory_bytes, const std::function<void()>& check)
    : output_(files, request, check),
      pool_(memory_bytes),
      scratch_(files, output_.scratch(), pool_),
      positions_(scratch_, kDifferenceBlockBytes),
      distances_(scratch_, kDifferenceBlockBytes),
      triangles_(scratch_, kDifferenceBlockBytes) {}

void DifferencePly::add(const PlacedTile& tile, std::span<const double> distances) {
  positions_.append(std::span(tile.places).first(tile.own_count));
  for (const double distance : distances.first(tile.own_count))
    distances_.append(static_cast<float>(distance));
  for (const Triangle<std::uint32_t>& t : tile.triangles)
    triangles_.append(
        Triangle<std::uint32_t>{tile.number(t[0]), tile.number(t[1]), tile.number(t[2])});
}

void DifferencePly::write(Vec3d origin, const std::string& comment,
                          const std::function<void()>& check) {
  mesh_io::PlyContent content;
  content.vertex_count = positions_.size();
  content.triangle_count = triangles_.size();
  content.attributes.values = {{kDistance, ValueType::f32}};
  content.double_coordinates = origin != Vec3d{};
  content.comments = {comment};
  mesh_io::PlyWriter writer(output_.file(), content);
  std::vector<Vec3f> places;
  std::vector<Vec3d> exact;
  std::vector<float> values;
  for (std::uint64_t first = 0; first < positions_.size(); first += places.size()) {
    check();
    places.resize(std::min<std::uint64_t>(kCopiedAtOnce, positions_.size() - first));
    values.resize(places.size());
    positions_.read(first, places);
    distances_.read(first, values);
    exact.clear();
    for (const Vec3f place : places)
      exact.push_back(to_double(place) + origin);
    writer.write_vertices(exact, values);
  }
  std::vector<Triangle<std::uint32_t>> block;
  for (std::uint64_t first = 0; first < triangles_.size(); first += block.size()) {
    check();
    block.resize(std::min<std::uint64_t>(kCopiedAtOnce, triangles_.size() - first));
    triangles_.read(first, block);
    writer.write_triangles(block);
  }
  writer.finish();
  output_.publish();
}

}  // namespace meshhier::comparing
