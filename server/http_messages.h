// Requests and replies, from and to those of the library that speaks HTTP.
#pragma once

#include "server/http.h"

#include <chrono>
#include <string>

#include <httplib.h>

namespace meshhier::server {

/// Returns the request as we know it. A header that is there several times counts as none,
/// but of a list as one. `body`:
/// null if none is to be read; must outlive the result.
Request request_of(const httplib::Request& request, Body* body);

/// Puts a reply into the library's. Bodies are always given as providers: others the library would
/// compress at will. A file that cannot be read any more ends the connection.
void put(const Reply& reply, httplib::Response& response);

/// Returns a time as HTTP has it, "Sun, 06 Nov 1994 08:49:37 GMT".
std::string http_date(std::chrono::system_clock::time_point time);

}  // namespace meshhier::server
