// Local frames on the globe (WGS 84).
#pragma once

#include "base/vec.h"
#include "hierarchy/frame.h"
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

/// Returns whether a geocentric place is near the ellipsoid, where things stand.
bool is_on_globe(Vec3d place);

/// Returns whether a transform is rigid, on the globe, and its z axis points up there, within some
/// degrees.
bool is_local_frame(const GltfTransform& t);

/// Returns the frame east, north, up at a place that is rounded to metres.
GlobeFrame frame_at(Vec3d place);

/// Returns the frame at the middle of places on the globe; on the ellipsoid, if they are so far
/// apart that their middle lies deep below; nothing if they are all around the globe. Requires one
/// place.
std::optional<GlobeFrame> frame_amid(const std::vector<Vec3d>& places);

/// Returns the transform from geocentric coordinates to those of the frame; without a frame they
/// stay.
GltfTransform to_frame(const std::optional<GlobeFrame>& frame);

}  // namespace meshhier::mesh_io
