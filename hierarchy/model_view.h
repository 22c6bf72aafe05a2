// How a model is looked at: what links, configs and manifests keep of that. The rows that read and
// write it are in storage/format/view_keys.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace meshhier {

/// A member that has its default counts as unsaid. Lengths and coordinates are the input's, except
/// those of `camera`.
struct ModelView {
  /// Place and target in the page's world, three numbers each: the input's coordinates less the
  /// hierarchy's origin, turned until y is up, heights stretched. Empty: all of the model.
  std::vector<double> camera{};
  std::string projection = "perspective";
  std::string colours = "vertex";
  std::string shading = "smooth";
  std::string attribute{};  ///< whose values colours show; empty: the first one
  std::string ramp = "viridis";
  std::vector<double> range{};        ///< values at the ends of the ramp; empty: all
  std::optional<double> tolerance{};  ///< values not farther from 0 are one neutral band
  std::vector<double> hidden{};       ///< labels
  bool texture = true, relight = false, cavities = true, wires = false, points = false;
  bool outline = false, isolines = false;
  std::string light = "auto";  ///< a name, perhaps with the angles of its key, "sun,0.5,1"
  bool occlusion = false;
  std::string up = "file";
  std::optional<double> stretch{};  ///< heights are shown so many times as high
  std::string dollhouse = "auto";   ///< whether faces that look away are left out
  std::optional<double> level{};    ///< the finest one that is shown
  std::vector<double> cut{};        ///< kept is where x n1 + y n2 + z n3 + d >= 0
  std::vector<double> box{};        ///< two corners: what lies between them is kept
  bool caps = true;                 ///< cuts of closed models are closed
  std::vector<double> storey{};     ///< heights between which all is shown
  std::vector<double> measure{};    ///< points, three numbers each
  std::vector<double> pick{};       ///< a point
  std::string object{};             ///< the one that is picked
  std::string by{};                 ///< the property that objects are coloured by
  std::vector<double> between{};    ///< its values at the ends of the ramp; empty: all
  std::vector<std::string> only{}, hide{}, show{};  ///< objects

  bool empty() const { return *this == ModelView{}; }
  friend bool operator==(const ModelView&, const ModelView&) = default;
};

}  // namespace meshhier
