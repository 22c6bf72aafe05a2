// The types of files, by their names, in the words of HTTP.
#pragma once

#include <string_view>

namespace meshhier::server {

/// Returns the Content-Type; "application/octet-stream" if nothing better is known.
std::string_view content_type(std::string_view file_name);

}  // namespace meshhier::server
