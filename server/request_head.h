// The first lines of a request as they came off the wire, before the HTTP library reads them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace meshhier::server {

/// Larger heads are refused: browsers send less than 2 KiB, with a good many cookies.
inline constexpr std::size_t kMostHeadBytes = 16 * 1024;
/// So are longer lines, without their ends: the library takes 8 KiB with them.
inline constexpr std::size_t kMostLineBytes = 8190;

struct RequestHead {
  /// The head for the library, without the header Range: it would match its value against a regular
  /// expression, recursing with each byte (2.2 MB of stack for 8 KB), and hold several ranges for
  /// as many copies of the file. A target that is a whole address is its path here, and its host
  /// is in the header Host.
  std::string text;
  std::optional<std::string> range{};  ///< the value, if there is one such header and no more
  bool has_body = false;               ///< more than 0 bytes are announced
  std::optional<std::uint64_t> body_bytes{};  ///< Content-Length, if there is one
  /// Whether there is Expect: 100-continue, which is not in `text`: the library would answer it
  /// before anybody has looked at the request.
  bool expects_continue = false;
  bool is_last = false;  ///< the client closes the connection behind it (Connection: close)

  friend bool operator==(const RequestHead&, const RequestHead&) = default;
};

/// Why a head is refused.
struct RefusedHead {
  int status = 400;
  std::string_view reason{};  ///< the status in words, "Bad Request"
  std::string why{};          ///< a line for people
};

/// Returns the refusal of a head that has more than kMostHeadBytes: 414 if its first line is too
/// long already, else 431 (RFC 9110, section 15.5.15; RFC 6585). `begin`: what has come of it.
RefusedHead refuse_size(std::string_view begin);

/// Parses a head. `raw`: up to and with the empty line. Refuses by 400 what two readers could see
/// two things in (RFC 9112, sections 3, 5 and 6): a line that ends otherwise than with CR LF or
/// goes on in the next one, a first line that is not three words with one blank between them, a
/// character of control, a target that is neither a path nor an address of a host without a user,
/// a name that is none or is followed by a blank, more than one Host, one that is none, none in
/// HTTP/1.1, or a body whose length is said twice or in no number. Lines that are too long get 414
/// or 431, methods that HTTP does not have 501, versions other than 1.x 505.
std::variant<RequestHead, RefusedHead> parse_head(std::string_view raw);

}  // namespace meshhier::server
