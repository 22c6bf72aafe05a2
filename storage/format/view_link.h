// Links to a view of a model, as the page writes them: `#MODEL&px,py,pz,tx,ty,tz&NAME=VALUE…`, the
// camera first, then the keys of view_keys.h in their order.
#pragma once

#include "hierarchy/model_view.h"
#include "storage/format/view_keys.h"

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::storage {

/// A parsed link: the view, and the keys that belong to no view ("notes").
struct ViewLink {
  ModelView view;
  std::vector<std::string> others{};
  std::set<ViewPart> said{};  ///< also with values that cannot be read
};

/// Reads a link: an address with a #, or the part from there on. What cannot be read is as if it
/// were not there. Nothing if there is no #.
std::optional<ViewLink> parse_view_link(std::string_view link);

/// Returns what a link shows of a model that is seen first in another view.
ModelView over_first(const ViewLink& link, const ModelView& first);

/// Returns the part of a link behind the model's name: "" or "&1,2,3,0,0,0&colours=height". Numbers
/// have twelve digits.
std::string view_link(const ModelView& view);

}  // namespace meshhier::storage
