// The colours of vertices, as light.
#pragma once

#include "base/vec.h"
#include "hierarchy/attributes.h"

#include <span>

namespace meshhier::render {

class VertexLight {
 public:
  explicit VertexLight(const AttributeLayout& layout)
      : colours_(layout.part(AttributeKind::colours)),
        full_(full_number(layout.colour)),
        space_(layout.space) {}

  /// Returns the linear light, 0 to 1 each, of a vertex with these attributes; kPlainColour if the
  /// layout has no colours.
  Vec3f of(std::span<const float> attributes) const;

 private:
  AttributePart colours_;
  double full_;
  ColourSpace space_;
};

}  // namespace meshhier::render
