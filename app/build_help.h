// What `build` prints instead of a build, and below its help.
#pragma once

#include <map>
#include <string>

namespace meshhier::app {

/// Texts by the names of their forms.
using References = std::map<std::string, std::string (*)()>;
/// Returns the forms that --help-config prints.
const References& key_references();
/// Returns the forms that --help-formats prints.
const References& format_references();

/// Returns what stands below the options in the help of `build`: what FILE may be, the defaults,
/// examples.
std::string build_footer();

}  // namespace meshhier::app
