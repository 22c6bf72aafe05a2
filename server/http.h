// A request and its reply as values: what is answered is decided without a socket.
#pragma once

#include "storage/io/file.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::server {

/// What a client sent; nobody vouches for any of it.
struct Request {
  std::string method = "GET";
  std::string target{};  ///< as it was sent: "/models.json?x", not decoded
  std::optional<std::string> host{};
  std::optional<std::string> accept_encoding{};
  std::optional<std::string> if_none_match{};
  std::optional<std::string> if_range{};
  std::optional<std::string> range{};
  bool has_body = false;  ///< more than 0 bytes are announced behind the head
};

/// A part of a file, sent piece by piece.
struct FilePart {
  std::shared_ptr<const storage::File> file;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

struct Reply {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers{};
  std::string text{};              ///< the body, unless it is
  std::optional<FilePart> file{};  ///< this

  std::uint64_t body_bytes() const { return file ? file->bytes : text.size(); }
  /// The header's value, "" if it is not there; names are as they were put in.
  std::string_view header(std::string_view name) const;
};

inline std::string_view Reply::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name)
      return value;
  }
  return {};
}

}  // namespace meshhier::server
