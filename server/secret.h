// A secret word that a client must know (RFC 6750): "Authorization: Bearer WORD".
#pragma once

#include "server/http.h"

#include <string_view>

namespace meshhier::server {

/// Whether two secrets are equal. The time that it takes does not depend on where they differ.
bool is_same_secret(std::string_view a, std::string_view b);

/// Whether a request tells the secret, which must not be empty.
bool knows_secret(const Request& request, std::string_view secret);

/// Returns the refusal of a request that does not: 401.
Reply secret_needed();

}  // namespace meshhier::server
