// The finest parts of a scene: what is drawn from nearby.
//
//   PagedLOD   range 0: coarse geometry, in this file     <- drawn if the finer file is missing
//              range 1: "Tile_L18_0.osgb"                 <- drawn else: its name is the answer
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <osg/Geometry>
#include <osg/Material>
#include <osg/Matrixd>
#include <osg/Node>
#include <osg/Texture>

namespace meshhier::mesh_io::osgb {

/// What states of nodes and of a drawable say of its look; the deepest one counts.
struct Look {
  const osg::Texture* texture = nullptr;
  const osg::Material* material = nullptr;
  bool is_blended = false;
  std::optional<float> cutoff{};  ///< of alpha, below which nothing is drawn
  auto operator<=>(const Look&) const = default;
};

struct Part {
  const osg::Geometry* geometry = nullptr;
  osg::Matrixd place;
  Look look;
};

struct FinerFile {
  std::size_t name = 0;
  osg::Matrixd place;
};

struct FinestParts {
  std::vector<Part> parts;
  std::vector<FinerFile> finer;
  std::size_t missing = 0;  ///< finer files in whose place coarser parts stand, or nothing
  std::size_t others = 0;   ///< drawables that are no geometry
};

/// Returns the files that nodes name, each once, ascending.
std::set<std::string> names_in(const osg::Node& scene);

/// Returns the finest parts where the files of `present` are there, numbered by it. Throws
/// std::runtime_error if nodes are shown too often, or lie in each other too deep.
FinestParts finest_parts(const osg::Node& scene, const std::map<std::string, std::size_t>& present);

}  // namespace meshhier::mesh_io::osgb
