// Local frames on the globe (WGS 84).
#pragma once

#include "hierarchy/frame.h"
#include "hierarchy/vec.h"
#include "mesh_io/gltf_transform.h"

#include <optional>
#include <vector>

namespace meshhier::mesh_io {

/// A local frame on the globe, rigid: from its coordinates to geocentric ones (EPSG:4978).
struct GlobeFrame {
  GltfTransform to_globe;

  Transform matrix() const;
  friend bool operator==(const GlobeFrame&, const GlobeFrame&) = default;
};

/// Whether a geocentric place is near the ellipsoid: where things stand.
bool is_on_globe(Vec3d place);

/// Whether it is rigid, on the globe, and its z axis points up there, within some degrees.
bool is_local_frame(const GltfTransform& t);

/// East, north, up at a place, rounded to metres.
GlobeFrame frame_at(Vec3d place);

/// That of the middle of places on the globe, on the ellipsoid if they are so far apart that it
/// lies deep below; nothing if they are all around the globe. Requires one.
std::optional<GlobeFrame> frame_amid(const std::vector<Vec3d>& places);

/// From geocentric coordinates to those of the frame; without one they stay.
GltfTransform to_frame(const std::optional<GlobeFrame>& frame);

}  // namespace meshhier::mesh_io
