// Makes objects of PROJ from texts of users.
#pragma once

#include "geodesy/proj_library.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace meshhier::geodesy::proj {

struct Destroy {
  void operator()(PJ_CONTEXT* context) const { library().context_destroy(context); }
  void operator()(PJ* object) const { library().destroy(object); }
};
using Context = std::unique_ptr<PJ_CONTEXT, Destroy>;
using Object = std::unique_ptr<PJ, Destroy>;

/// The length at which a quoted text is cut off.
inline constexpr std::size_t kLongestQuote = 80;
std::string in_quotes(std::string_view text);

/// Throws Error(usage).
[[noreturn]] void refuse(const std::string& what);

/// Makes a context without the network. Throws Error(io) if PROJ's database is not there.
Context make_context();
/// Makes a CRS. Throws Error(usage) if `text` is no CRS, or names files by a path.
Object make_crs(PJ_CONTEXT* context, const std::string& text);
/// Returns the part with easting and northing, or degrees; the CRS itself if it has no parts.
Object horizontal_part(PJ_CONTEXT* context, const PJ* crs);
/// Returns the part with heights of a compound CRS; else null.
Object vertical_part(PJ_CONTEXT* context, const PJ* crs);

}  // namespace meshhier::geodesy::proj
