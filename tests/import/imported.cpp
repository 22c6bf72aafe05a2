#include "import/imported.h"

#include "hierarchy/value_channels.h"
#include "storage/format/object_table.h"
#include "tests/support/warnings.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace meshhier::tests {
namespace {

void read(mesh_io::MeshSource& source, Imported& into) {
  source.read_vertices([&](const mesh_io::VertexBlock& block) {
    for (const Vec3f& p : block.positions)
      into.positions.push_back(to_double(p));
    into.positions.insert(into.positions.end(), block.exact.begin(), block.exact.end());
    into.attributes.insert(into.attributes.end(), block.attributes.begin(), block.attributes.end());
  });
  source.read_triangles([&](std::span<const Triangle<VertexId>> triangles) {
    for (const auto& t : triangles)
      into.triangles.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
  });
}

std::string colour_text(const std::array<float, 4>& colour) {
  std::string text = "#";
  for (std::size_t i = 0; i < (colour[3] < 1 ? 4U : 3U); ++i)
    text += fmt::format("{:02x}", std::lround(255 * colour[i]));
  return text;
}

}  // namespace

std::uint64_t Imported::count(const std::string& name) const {
  return summary.count_of(name);
}

std::vector<std::string> Imported::companions() const {
  std::vector<std::string> all;
  for (const importing::ReadFile& file : record.files) {
    if (file.part != importing::InputPart::mesh)
      all.push_back(file.path.generic_string());
  }
  for (const std::filesystem::path& place : record.awaited)
    all.push_back("no " + place.generic_string());
  return all;
}

std::vector<std::uint32_t> Imported::objects_of_triangles() const {
  const auto place = placed_object(layout);
  std::vector<std::uint32_t> all;
  for (const auto& triangle : triangles) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; place && k < 3; ++k) {
      const std::size_t first = triangle[k] * static_cast<std::size_t>(layout.channels());
      corners[k] = static_cast<std::uint32_t>(place->in(attributes.data() + first));
    }
    if (!place || corners[0] != corners[1] || corners[0] != corners[2])
      throw std::logic_error("the corners of a triangle have no object, or several");
    all.push_back(corners[0]);
  }
  return all;
}

std::vector<std::string> Imported::names_of_triangles() const {
  std::vector<std::string> names;
  for (const std::uint32_t object : objects_of_triangles())
    names.push_back(objects.at(object).name);
  return names;
}

std::vector<std::string> Imported::object_names() const {
  std::vector<std::string> names;
  for (const ObjectRow& row : objects)
    names.push_back(row.name);
  return names;
}

std::uint32_t Imported::material_of(std::size_t triangle) const {
  const auto channels = static_cast<std::size_t>(layout.channels());
  const auto offset = layout.part(AttributeKind::material).first;
  std::array<float, 3> all{};
  for (std::size_t k = 0; k < 3; ++k)
    all[k] = attributes.at(triangles.at(triangle)[k] * channels + offset);
  if (all[0] != all[1] || all[1] != all[2] || !(all[0] < float(materials.materials.size())))
    throw std::logic_error("the corners of a triangle name no material, or several");
  return static_cast<std::uint32_t>(all[0]);
}

std::vector<double> Imported::values(std::size_t attribute) const {
  const PlacedValue value = placed_values(layout)[attribute];
  std::vector<double> all;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const std::size_t first = v * static_cast<std::size_t>(layout.channels());
    all.push_back(value.in(attributes.data() + first));
  }
  return all;
}

Vec2f Imported::texcoord(std::size_t triangle, std::size_t corner) const {
  const std::size_t first =
      triangles.at(triangle)[corner] * static_cast<std::size_t>(layout.channels()) +
      layout.part(AttributeKind::texcoords).first;
  return {attributes.at(first), attributes.at(first + 1)};
}

std::string Imported::shown(std::size_t triangle) const {
  std::string text;
  if (layout.material) {
    const images::Material& material = materials.materials[material_of(triangle)];
    if (!material.image)
      return colour_text(material.colour);
    text = materials.images[*material.image].file.filename().string() + ' ';
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2f at = texcoord(triangle, k);
    text += fmt::format("{}{} {}", k > 0 ? ", " : "", at.u, at.v);
  }
  return text;
}

std::vector<std::string> Imported::all_shown() const {
  std::vector<std::string> all;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    all.push_back(shown(t));
  return all;
}

std::vector<ValueStatistics> Imported::statistics() const {
  std::vector<ValueStatistics> all;
  const std::vector<PlacedValue> placed = placed_values(layout);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    ValueTally tally(layout.values[i]);
    tally.add(attributes.data() + placed[i].channel, static_cast<std::size_t>(layout.channels()),
              positions.size());
    all.push_back(tally.statistics());
  }
  return all;
}

Imported import_files(storage::FileSystem& files, const mesh_io::InputPaths& inputs,
                      const ImportHow& how) {
  storage::MemoryPool pool(how.memory.pool_bytes);
  Warnings warnings;
  const execution::CancelToken cancel;
  importing::MeshInput input(
      inputs, files,
      {how.weld, how.textures, how.crop, how.attributes, {}, how.objects, how.object_table});
  if (input.needs_import()) {
    input.import({how.folder / "imported.ply", how.folder / "import", pool, how.memory.sort_bytes,
                  warnings, cancel});
  }
  Imported result;
  result.layout = input.description().attributes;
  result.materials = input.materials();
  if (input.objects()) {
    const storage::ObjectTable table(files.open(input.objects()->file), &input.objects()->facts);
    result.properties = table.properties();
    table.for_each([&](std::uint32_t, const ObjectRow& row) { result.objects.push_back(row); });
  }
  read(*input.open(), result);
  result.summary.attributes = result.layout;
  result.summary.values = result.statistics();
  input.complete(result.summary);
  result.record = input.record(0);
  result.warnings = input.files().warnings();
  result.warnings.insert(result.warnings.end(), warnings.all.begin(), warnings.all.end());
  result.summary.unused = input.files().unused();
  result.disk_bytes = pool.scratch_use().peak_bytes_on_disk();
  result.predicted_bytes = importing::predict_import(input.files(), how.memory);
  return result;
}

}  // namespace meshhier::tests
