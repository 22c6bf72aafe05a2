#include "mesh_io/osgb/finest_parts.h"

#include <stdexcept>
#include <utility>

#include <osg/AlphaFunc>
#include <osg/BlendFunc>
#include <osg/LOD>
#include <osg/PagedLOD>
#include <osg/ProxyNode>
#include <osg/Switch>
#include <osg/Transform>

namespace meshhier::mesh_io::osgb {
namespace {

/// The deepest nodes, and the most: files that name the same nodes again and again are hostile.
constexpr int kDeepest = 200;
constexpr std::size_t kMostNodes = std::size_t{1} << 22;

/// Something that a node shows: a node, or a file.
struct Child {
  const osg::Node* node = nullptr;
  std::string file{};
  float fineness = 0;  ///< larger: seen from nearer
};

std::string joined(const std::string& path, const std::string& name) {
  return path.empty() || name.empty() ? name : path + '/' + name;
}

/// Returns the children of a LOD that are shown at any distance. A range is of a distance, or of a
/// size on the screen.
std::vector<Child> children_of(const osg::LOD& lod) {
  const auto* const paged = dynamic_cast<const osg::PagedLOD*>(&lod);
  const unsigned names = paged == nullptr ? 0 : paged->getNumFileNames();
  std::vector<Child> children;
  unsigned next = 0;  // nodes in the file are those without a name, in their order
  for (unsigned i = 0; i < names || next < lod.getNumChildren(); ++i) {
    Child child;
    if (i < names)
      child.file = joined(paged->getDatabasePath(), paged->getFileName(i));
    if (child.file.empty() && next < lod.getNumChildren())
      child.node = lod.getChild(next++);
    const bool has_range = i < lod.getNumRanges();
    if (has_range) {
      child.fineness = lod.getRangeMode() == osg::LOD::PIXEL_SIZE_ON_SCREEN ? lod.getMaxRange(i)
                                                                            : -lod.getMinRange(i);
    }
    const bool is_shown = !has_range || lod.getMinRange(i) < lod.getMaxRange(i);
    if (is_shown && (child.node != nullptr || !child.file.empty()))
      children.push_back(std::move(child));
  }
  return children;
}

std::vector<Child> children_of(const osg::ProxyNode& proxy) {
  std::vector<Child> children;
  for (unsigned i = 0; i < proxy.getNumFileNames(); ++i) {
    if (!proxy.getFileName(i).empty())
      children.push_back({nullptr, joined(proxy.getDatabasePath(), proxy.getFileName(i)), 0});
  }
  for (unsigned i = 0; i < proxy.getNumChildren(); ++i)
    children.push_back({proxy.getChild(i), {}, 0});
  return children;
}

std::vector<Child> children_of(const osg::Group& group) {
  if (const auto* const lod = dynamic_cast<const osg::LOD*>(&group))
    return children_of(*lod);
  if (const auto* const proxy = dynamic_cast<const osg::ProxyNode*>(&group))
    return children_of(*proxy);
  const auto* const choice = dynamic_cast<const osg::Switch*>(&group);
  std::vector<Child> children;
  for (unsigned i = 0; i < group.getNumChildren(); ++i) {
    if (choice == nullptr || choice->getValue(i))
      children.push_back({group.getChild(i), {}, 0});
  }
  return children;
}

/// Counts nodes, so that a walk has an end.
class Steps {
 public:
  void enter(int depth) {
    if (depth > kDeepest)
      throw std::runtime_error("its nodes lie in each other too deep, or in a circle");
    if (++count_ > kMostNodes)
      throw std::runtime_error("it shows more nodes than are read");
  }

 private:
  std::size_t count_ = 0;
};

bool is_on(const osg::StateSet& state, GLenum mode) {
  return (state.getMode(mode) & osg::StateAttribute::ON) != 0;
}

Look with_state(Look look, const osg::StateSet* state) {
  if (state == nullptr)
    return look;
  using Attribute = osg::StateAttribute;
  if (const auto* texture =
          dynamic_cast<const osg::Texture*>(state->getTextureAttribute(0, Attribute::TEXTURE)))
    look.texture = texture;
  if (const auto* material =
          dynamic_cast<const osg::Material*>(state->getAttribute(Attribute::MATERIAL)))
    look.material = material;
  look.is_blended = look.is_blended || is_on(*state, GL_BLEND);
  const auto* const alpha =
      dynamic_cast<const osg::AlphaFunc*>(state->getAttribute(Attribute::ALPHAFUNC));
  if (alpha != nullptr && is_on(*state, GL_ALPHA_TEST) &&
      (alpha->getFunction() == osg::AlphaFunc::GREATER ||
       alpha->getFunction() == osg::AlphaFunc::GEQUAL))
    look.cutoff = alpha->getReferenceValue();
  return look;
}

class Finder {
 public:
  explicit Finder(const std::map<std::string, std::size_t>& present) : present_(present) {}

  void walk(const osg::Node& node, const osg::Matrixd& place, const Look& above, int depth) {
    steps_.enter(depth);
    if (node.getNodeMask() == 0)
      return;
    const Look look = with_state(above, node.getStateSet());
    if (const auto* geometry = dynamic_cast<const osg::Geometry*>(&node)) {
      found.parts.push_back({geometry, place, look});
    } else if (dynamic_cast<const osg::Drawable*>(&node) != nullptr) {
      ++found.others;
    } else if (const auto* group = dynamic_cast<const osg::Group*>(&node)) {
      osg::Matrixd own = place;
      if (const auto* transform = dynamic_cast<const osg::Transform*>(group))
        transform->computeLocalToWorldMatrix(own, nullptr);
      show(children_of(*group), own, look, depth);
    }
  }

  FinestParts found;

 private:
  bool is_there(const Child& child) const {
    return child.node != nullptr || present_.contains(child.file);
  }

  /// Takes the finest children of which none is missing.
  void show(const std::vector<Child>& children, const osg::Matrixd& place, const Look& look,
            int depth) {
    std::map<float, std::vector<const Child*>, std::greater<>> by_fineness;
    for (const Child& child : children)
      by_fineness[child.fineness].push_back(&child);
    for (const auto& [fineness, alike] : by_fineness) {
      std::size_t missing = 0;
      for (const Child* child : alike)
        missing += is_there(*child) ? 0 : 1;
      found.missing += missing;
      if (missing > 0 && &alike != &by_fineness.rbegin()->second)
        continue;
      for (const Child* child : alike) {
        if (child->node != nullptr)
          walk(*child->node, place, look, depth + 1);
        else if (is_there(*child))
          found.finer.push_back({present_.at(child->file), place});
      }
      return;
    }
  }

  const std::map<std::string, std::size_t>& present_;
  Steps steps_;
};

void collect_names(const osg::Node& node, Steps& steps, std::set<std::string>& names, int depth) {
  steps.enter(depth);
  const auto* const group = dynamic_cast<const osg::Group*>(&node);
  if (group == nullptr)
    return;
  for (const Child& child : children_of(*group)) {
    if (child.node != nullptr)
      collect_names(*child.node, steps, names, depth + 1);
    else
      names.insert(child.file);
  }
}

}  // namespace

std::set<std::string> names_in(const osg::Node& scene) {
  std::set<std::string> names;
  Steps steps;
  collect_names(scene, steps, names, 0);
  return names;
}

FinestParts finest_parts(const osg::Node& scene,
                         const std::map<std::string, std::size_t>& present) {
  Finder finder(present);
  finder.walk(scene, osg::Matrixd::identity(), {}, 0);
  return std::move(finder.found);
}

}  // namespace meshhier::mesh_io::osgb
