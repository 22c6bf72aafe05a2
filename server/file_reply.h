// A file as the answer to a request: the whole, a part of it, or that the client has it already.
#pragma once

#include "server/http.h"
#include "storage/io/file.h"

#include <memory>
#include <string>
#include <string_view>

namespace meshhier::server {

/// A file and the headers that it is sent with.
struct SentFile {
  std::shared_ptr<const storage::File> file;
  std::string tag;
  std::string_view type;
  std::string_view cache;
  bool may_be_gzip = false;  ///< stored as a gzip member, sent as one if its bytes say so
};

/// Returns 200, 206, 304, 412, 416, or 406: a file that is stored as gzip is never unpacked here,
/// so that no request makes the server hold a tile. Clients that say nothing of encodings take any
/// (RFC 9110, 12.5.3). Reads at most the first bytes; the reply keeps the file open. Thread-safe.
/// Throws Error(io).
Reply file_reply(const Request& request, const SentFile& sent);

}  // namespace meshhier::server
