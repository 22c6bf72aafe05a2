#include "import/gltf_objects.h"

#include "base/error.h"
#include "execution/spool_cursor.h"
#include "import/place_lookup.h"
#include "mesh_io/gltf_elements.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <span>
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
  unread_.tables = place.is_batch_unread ? 1 : 0;
  if (choice.from == ObjectSource::feature || (choice.is_evident() && has_features(place.batch)))
    features_.emplace(file, *objects_, place.batch, place.name);
  if (features_ || choice.is_evident())
    note_unread();
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
    ++unread_.tables;
    return false;
  }
}

/// Calls `visit(ids, attributes)` for all sets of ids of each mesh and of the copies of it, until
/// it returns true.
template <class Visit>
void GltfObjects::for_each_features(const Visit& visit) const {
  std::vector<bool> seen(document_.meshes.size());
  for (const mesh_io::GltfInstance& instance : scene_.instances) {
    if (instance.copies &&
        visit(feature_ids_of(file_, instance.copies->features), instance.copies->attributes))
      return;
    if (seen[instance.mesh])
      continue;
    seen[instance.mesh] = true;
    for (const mesh_io::GltfPrimitive& primitive : document_.meshes[instance.mesh].primitives) {
      if (visit(feature_ids_of(file_, primitive.features), primitive.attributes))
        return;
    }
  }
}

/// A primitive, or a copy of a mesh, has features with properties.
bool GltfObjects::are_features_evident(mesh_io::FeatureTable* batch) const {
  const bool has_batch = batch != nullptr && !batch->columns().empty();
  bool is_any = false;
  for_each_features([&](const auto& all, const mesh_io::GltfAttributes& attributes) {
    is_any = (has_batch && batch_ids_in(attributes) != nullptr) ||
             std::ranges::any_of(all, [&](const mesh_io::GltfFeatureIds& ids) {
               return ids.table && !ids.is_in_texture &&
                      (!ids.attribute || attributes.contains(*ids.attribute));
             });
    return is_any;
  });
  return is_any;
}

void GltfObjects::note_unread() {
  try {
    for_each_features([&](const auto& all, const auto&) {
      const auto textures = static_cast<std::uint64_t>(
          std::ranges::count(all, true, &mesh_io::GltfFeatureIds::is_in_texture));
      unread_.in_textures += textures;
      unread_.further_sets += std::max<std::uint64_t>(all.size() - textures, 1) - 1;
      return false;
    });
    const mesh_io::GltfOtherProperties others = other_properties_of(file_);
    unread_.property_textures = others.textures;
    unread_.property_attributes = others.attributes;
  } catch (const Error& error) {  // has_features() has counted it
    if (error.code() != ErrorCode::input)
      throw;
  }
}

UnreadMetadata GltfObjects::unread() const {
  UnreadMetadata all = unread_;
  all.tables += features_ ? features_->unread_tables() : 0;
  return all;
}

void GltfObjects::begin(const mesh_io::GltfInstance& instance) {
  instance_ = &instance;
  copy_ids_.reset();
  copy_feature_.reset();
  if (!features_ || !instance.copies)
    return;
  copy_ids_ = features_->ids_of(instance.copies->features, instance.copies->attributes);
  if (!copy_ids_ || !copy_ids_->attribute)
    return;
  auto source = gltf_elements_of(file_, instance.copies->attributes.at(*copy_ids_->attribute));
  if (source.components != 1)
    file_.fail(source.name + " is of no type that feature ids may have");
  copy_feature_.emplace(file_, std::move(source), mesh_io::GltfElements::Integers::stored);
}

/// A copy without a number of its own is numbered by its place among the copies.
std::uint32_t GltfObjects::object_of_copy() {
  const std::uint64_t number = copy_ - 1;
  if (!copy_feature_)
    return features_->object_of(*copy_ids_, static_cast<double>(number));
  if (number >= copy_feature_->size())
    file_.fail(fmt::format("{} has {} elements for the features of more copies",
                           copy_feature_->source().name, copy_feature_->size()));
  return features_->object_of(*copy_ids_, copy_feature_->at(number)[0]);
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
  const auto sum_of = [](const std::string& name) {
    return storage::checksum(std::as_bytes(std::span(name)));
  };
  std::uint64_t count = taken_[sum_of(wanted)];
  std::string name = wanted;
  while (++count > 1) {
    name = fmt::format("{} ({})", wanted, count);
    if (taken_.emplace(sum_of(name), 1).second)
      break;
  }
  taken_[sum_of(wanted)] = count;
  return name;
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
  if (copy_ids_)
    return objects_->runs.add(object_of_copy(), triangles);
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

void GltfObjects::read_features(const mesh_io::GltfFeatureIds& ids, const PrimitiveSources& sources,
                                const storage::RecordSpool<std::uint32_t>& used,
                                std::uint64_t count, storage::RecordSpool<double>& features) {
  std::optional<mesh_io::GltfElements> all;
  if (ids.attribute) {
    const auto source = *sources.attribute(*ids.attribute, 1, 1);
    if (source.count != count)
      file_.fail(fmt::format("{} has {} elements, but there are {} vertices", source.name,
                             source.count, count));
    all.emplace(file_, source, mesh_io::GltfElements::Integers::stored);
  }
  execution::SpoolCursor vertices(used, room_.cancel);
  for (std::uint64_t i = 0; i < used.size(); ++i) {
    const std::uint32_t vertex = vertices.at(i);
    features.append(all ? all->at(vertex)[0] : static_cast<double>(vertex));
  }
}

/// The feature of a triangle is that of most of its corners, of three different ones the first's.
bool GltfObjects::add_features(const mesh_io::GltfPrimitive& primitive,
                               const PrimitiveSources& sources, std::uint64_t first,
                               const storage::RecordSpool<std::uint32_t>& used,
                               std::uint64_t count) {
  const auto ids = features_->ids_of(primitive.features, primitive.attributes);
  if (!ids)
    return false;
  storage::RecordSpool<double> features(room_.scratch, kImportSpoolBytes);
  read_features(*ids, sources, used, count, features);
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
