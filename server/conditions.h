// Headers by which a client says what it has and what it takes (RFC 9110, sections 12 and 13).
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace meshhier::server {

/// Returns the ETag of a file, in quotes: another one whenever the file is another one, or was
/// changed. `offset`: where its content begins, if it lies in an archive; else 0.
std::string file_tag(const storage::FileVersion& version, std::uint64_t offset);
/// Returns the ETag of a text.
std::string text_tag(std::string_view text);

/// Whether If-None-Match names `tag`; weak tags count as well.
bool names_tag(std::string_view if_none_match, std::string_view tag);

/// Whether Accept-Encoding allows gzip.
bool allows_gzip(std::string_view accept_encoding);

/// Whether a Host header names this machine by its loopback: "localhost", "[::1]" or an address
/// that begins with "127.", of any port. A page that had its own name point here (DNS rebinding)
/// sends that name.
bool is_loopback_name(std::string_view host);

}  // namespace meshhier::server
