// Headers by which a client says what it has and what it takes (RFC 9110, sections 12 and 13).
#pragma once

#include "server/http.h"
#include "storage/io/file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshhier::server {

/// Returns the ETag of a file, in quotes: another one whenever the file is another one, or was
/// changed. `offset`: where its content begins, if it lies in an archive; else 0.
std::string file_tag(const storage::FileVersion& version, std::uint64_t offset);
/// Returns the ETag of a text.
std::string text_tag(std::string_view text);

/// Whether weak tags, "W/...", count as well: in If-None-Match, but not in If-Match.
enum class WeakTags { count, do_not };
/// Whether a list of tags names `tag`; "*" names all.
bool names_tag(std::string_view tags, std::string_view tag, WeakTags weak = WeakTags::count);

/// Returns 412 or 304 if a request's If-Match or If-None-Match ask for it, of what has `tag` (RFC
/// 9110, section 13.2.2); else nothing.
std::optional<int> status_by_conditions(const Request& request, std::string_view tag);

/// Whether a list, "a, b", has an item; letters of either case are the same.
bool has_item(std::string_view list, std::string_view item);

/// Whether Accept-Encoding allows gzip.
bool allows_gzip(std::string_view accept_encoding);

/// Whether it is what a Host header may say (RFC 9110, section 7.2): "a.org", "[::1]:80", or "".
bool is_host(std::string_view text);

/// Whether a Host header names this machine by its loopback: "localhost", "[::1]" or an address
/// that begins with "127.", of any port. A page that had its own name point here (DNS rebinding)
/// sends that name.
bool is_loopback_name(std::string_view host);

}  // namespace meshhier::server
