// Objects of PROJ, made of texts from outside.
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

/// A quoted text is cut off at this length.
inline constexpr std::size_t kLongestQuote = 80;
std::string in_quotes(std::string_view text);

/// Throws Error(usage).
[[noreturn]] void refuse(const std::string& what);

/// Without the network. Throws Error(io) if PROJ's database is not there.
Context make_context();
/// Throws Error(usage) if `text` is no CRS, or names files by a path.
Object make_crs(PJ_CONTEXT* context, const std::string& text);
/// The part with easting and northing, or degrees; of one without parts itself.
Object horizontal_part(PJ_CONTEXT* context, const PJ* crs);
/// The part with heights of a compound one; else null.
Object vertical_part(PJ_CONTEXT* context, const PJ* crs);

}  // namespace meshhier::geodesy::proj
