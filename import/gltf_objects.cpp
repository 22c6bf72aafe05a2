#include "import/gltf_objects.h"

#include "base/error.h"
#include "execution/spool_cursor.h"
#include "import/place_lookup.h"
#include "mesh_io/gltf_elements.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using mesh_io::ObjectSource;

/// Paths that are longer begin with "...": hostile ones would take the square of the file's size.
constexpr std::size_t kLongestWay = 4096;

}  // namespace

GltfObjects::GltfObjects(mesh_io::GltfFile& file, const mesh_io::GltfScene& scene, RawMesh& mesh,
                         const GltfPlace& place, const ImportRoom& room)
    : file_(file),
      document_(file.document()),
      scene_(scene),
      mesh_(mesh),
      objects_(mesh.objects.get()),
      room_(room) {
  if (objects_ == nullptr)
    return;
  const mesh_io::ObjectChoice& choice = objects_->choice;
  unread_ = place.is_batch_unread ? 1 : 0;
  if (choice.from == ObjectSource::feature || (choice.is_evident() && has_features(place.batch)))
    features_.emplace(file, *objects_, place.batch, place.name);
  are_materials_ = choice.from == ObjectSource::material;
  are_nodes_ = choice.from == ObjectSource::node ||
               (choice.is_evident() && !features_ && !place.is_tile && are_nodes_evident());
  if (are_nodes_)
    parents_ = parents_of(document_);
  if (!features_ && !are_materials_ && !are_nodes_)
    objects_ = nullptr;  // others say whose the triangles are: the file, a label, or nobody
}

/// Metadata that nobody asked for stops no mesh: what is damaged is counted.
bool GltfObjects::has_features(mesh_io::FeatureTable* batch) {
  try {
    return are_features_evident(batch);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input)
      throw;
    ++unread_;
    return false;
  }
}

/// A primitive has features with properties.
bool GltfObjects::are_features_evident(mesh_io::FeatureTable* batch) const {
  const bool has_batch = batch != nullptr && !batch->columns().empty();
  const auto has_rows = [&](const mesh_io::GltfPrimitive& primitive) {
    return (has_batch && primitive.attribute("_BATCHID")) ||
           std::ranges::any_of(feature_ids_of(file_, primitive),
                               [](const auto& ids) { return ids.attribute && ids.table; });
  };
  return std::ranges::any_of(scene_.instances, [&](const mesh_io::GltfInstance& instance) {
    return std::ranges::any_of(document_.meshes[instance.mesh].primitives, has_rows);
  });
}

/// Two nodes have names.
bool GltfObjects::are_nodes_evident() const {
  return std::ranges::count_if(scene_.instances, [&](const mesh_io::GltfInstance& instance) {
           return !name_of_node(instance.node).empty();
         }) > 1;
}

const std::string& GltfObjects::name_of_node(std::uint32_t node) const {
  const mesh_io::GltfNode& one = document_.nodes[node];
  return one.name.empty() && one.mesh ? document_.meshes[*one.mesh].name : one.name;
}

/// Returns the names from the root to the node: "house/storey/wall".
std::string GltfObjects::path_to(std::uint32_t node) const {
  std::string path = name_of_node(node);
  if (path.empty())
    path = fmt::format("node {}", node);
  for (node = parents_[node]; node != mesh_io::kNoParent; node = parents_[node]) {
    const std::string& name = document_.nodes[node].name;
    if (path.size() + name.size() > kLongestWay)
      return ".../" + path;
    if (!name.empty())
      path = name + '/' + path;
  }
  return path;
}

/// A name that several nodes have gets a number: "wall", "wall (2)".
std::string GltfObjects::own_name(const std::string& wanted) {
  std::uint64_t& count = taken_[wanted];
  while (++count > 1) {
    std::string name = fmt::format("{} ({})", wanted, count);
    if (taken_.emplace(name, 1).second)
      return name;
  }
  return wanted;
}

ObjectValues GltfObjects::values_of(std::uint32_t node) {
  ObjectValues values;
  for (const auto& [name, value] : document_.nodes[node].extras) {
    if (const auto property = objects_->properties.number(name))
      values.emplace_back(*property, value);
  }
  return values;
}

std::uint32_t GltfObjects::object_here() {
  const std::pair here(instance_->node, copy_);
  if (here == known_)
    return object_;
  std::string path = path_to(instance_->node);
  if (copy_ > 0)
    path += fmt::format("/{}", copy_);
  known_ = here;
  return object_ =
             objects_->names.add({.name = own_name(path), .values = values_of(instance_->node)});
}

void GltfObjects::add(const mesh_io::GltfPrimitive& primitive, const PrimitiveSources& sources,
                      std::uint64_t first, const storage::RecordSpool<std::uint32_t>& used,
                      std::uint64_t count) {
  const std::uint64_t triangles = mesh_.triangles.size() - first;
  if (objects_ == nullptr || triangles == 0)
    return;
  if (features_ && add_features(primitive, sources, first, used, count))
    return;
  if (are_nodes_)
    objects_->runs.add(object_here(), triangles);
  else if (are_materials_ && primitive.material)
    objects_->runs.add(objects_->names.number(document_.materials[*primitive.material].name),
                       triangles);
  else
    objects_->runs.add(objects_->names.number(""), triangles);
}

/// The feature of a triangle is that of most of its corners, of three different ones the first's.
bool GltfObjects::add_features(const mesh_io::GltfPrimitive& primitive,
                               const PrimitiveSources& sources, std::uint64_t first,
                               const storage::RecordSpool<std::uint32_t>& used,
                               std::uint64_t count) {
  const auto ids = features_->ids_of(primitive);
  const auto source = ids ? sources.attribute(*ids->attribute, 1, 1) : std::nullopt;
  if (!source)
    return false;
  if (source->count != count)
    file_.fail(fmt::format("{} has {} elements, but there are {} vertices", source->name,
                           source->count, count));
  mesh_io::GltfElements all(file_, *source, mesh_io::GltfElements::Integers::stored);
  storage::RecordSpool<double> features(room_.scratch, kImportSpoolBytes);
  execution::SpoolCursor vertices(used, room_.cancel);
  for (std::uint64_t i = 0; i < used.size(); ++i)
    features.append(all.at(vertices.at(i))[0]);
  SpoolLookup<double> feature(features);
  execution::SpoolCursor triangles(mesh_.triangles, room_.cancel);
  const std::uint64_t base = mesh_.vertex_count();
  std::optional<double> last;
  std::uint32_t object = 0;
  for (std::uint64_t i = first; i < triangles.size(); ++i) {
    const Triangle<std::uint32_t>& t = triangles.at(i);
    const double a = feature.at(t[0] - base), b = feature.at(t[1] - base);
    const double most = b == feature.at(t[2] - base) ? b : a;
    if (!last || *last != most)
      object = features_->object_of(*ids, most);
    last = most;
    objects_->runs.add(object, 1);
  }
  return true;
}

}  // namespace meshhier::importing
