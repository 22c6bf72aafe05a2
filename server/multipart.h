// Forms of files, as browsers and curl send them (RFC 7578): read as they come, a part at a time.
//
//   --BOUNDARY CR LF
//   Content-Disposition: form-data; name="file"; filename="house.obj" CR LF
//   other headers CR LF
//   CR LF
//   content CR LF
//   --BOUNDARY CR LF      the next part, or
//   --BOUNDARY-- CR LF    the end
#pragma once

#include "server/http.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace meshhier::server {

/// Returns the boundary that a Content-Type tells; nothing if it is another type, or a boundary
/// that RFC 2046 (section 5.1.1) does not allow.
std::optional<std::string> form_boundary(std::string_view content_type);

/// Reads a form strictly: nothing stands before the first boundary or behind the last one, and each
/// part is a file. Holds a fixed number of bytes, whatever comes. For one thread; never throws.
class MultipartReader {
 public:
  /// `body` must outlive this. Requires a boundary that form_boundary() returned.
  MultipartReader(Body& body, const std::string& boundary);

  enum class Next {
    file,      ///< name() is its name as it was sent; read() gives its content
    end,       ///< there is no other one
    malformed  ///< or the body has ended too early: its end() says so
  };
  /// Goes to the next file. Requires that read() has returned 0 since the last one.
  Next next();
  const std::string& name() const { return name_; }
  /// Reads up to bytes.size() of the content and returns how many; 0 at its end, and if the body
  /// has ended too early, which next() tells.
  std::size_t read(std::span<std::byte> bytes);

 private:
  bool fill();
  bool hold(std::size_t bytes);
  bool take(std::string_view text);
  Next finish();
  std::optional<std::string> take_headers();
  std::string_view held() const { return std::string_view(window_).substr(begin_); }

  Body& body_;
  std::string delimiter_;  ///< CR LF included: it belongs to no content
  std::string window_;     ///< bytes of the body; those from begin_ on are not yet taken
  std::size_t begin_ = 0;
  std::string name_;
};

}  // namespace meshhier::server
