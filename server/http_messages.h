// Requests and replies, from and to those of the library that speaks HTTP.
#pragma once

#include "server/http.h"

#include <httplib.h>

namespace meshhier::server {

/// Returns the request as we know it. A header that is there several times counts as none. `body`:
/// null if none is to be read; must outlive the result.
Request request_of(const httplib::Request& request, Body* body);

/// Puts a reply into the library's. Bodies are always given as providers: others the library would
/// compress at will. A file that cannot be read any more ends the connection.
void put(const Reply& reply, httplib::Response& response);

}  // namespace meshhier::server
