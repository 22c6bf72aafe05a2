#include "server/http_messages.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/chrono.h>

namespace meshhier::server {
namespace {

/// A thread holds so much of a file.
constexpr std::size_t kPieceBytes = 64 * 1024;

std::optional<std::string> header(const httplib::Request& request, const char* name) {
  if (request.get_header_value_count(name) != 1)
    return std::nullopt;
  return request.get_header_value(name);
}

/// Returns the host that is asked; "" if it is an empty one, which the library leaves out. Only
/// HTTP/1.0 may name none.
std::optional<std::string> host_of(const httplib::Request& request) {
  if (request.version == "HTTP/1.0")
    return header(request, "Host");
  return header(request, "Host").value_or("");
}

/// Returns a list that may be in several headers (RFC 9110, section 5.3): the list of all.
std::optional<std::string> list(const httplib::Request& request, const char* name) {
  const std::size_t count = request.get_header_value_count(name);
  if (count == 0)
    return std::nullopt;
  std::string all = request.get_header_value(name);
  for (std::size_t i = 1; i < count; ++i)
    all.append(", ").append(request.get_header_value(name, i));
  return all;
}

/// Whether a body is announced. Heads that say it in two ways were refused before.
bool announces_body(const httplib::Request& request) {
  return request.has_header("Transfer-Encoding") ||
         request.get_header_value("Content-Length").find_first_not_of('0') != std::string::npos;
}

/// Returns the origin; "" if there are several, which is nobody's origin.
std::optional<std::string> origin_of(const httplib::Request& request) {
  if (!request.has_header("Origin"))
    return std::nullopt;
  return header(request, "Origin").value_or("");
}

/// Whether a proxy says that it asks for somebody else.
bool is_passed_on(const httplib::Request& request) {
  constexpr std::array kProxyHeaders{"Forwarded", "Via", "X-Forwarded-For", "X-Real-IP"};
  return std::ranges::any_of(kProxyHeaders,
                             [&](const char* name) { return request.has_header(name); });
}

/// Sends a file piece by piece. The library has no place for exceptions here: a file that cannot be
/// read any more ends the connection, and the client misses bytes.
httplib::ContentProvider sender_of(const FilePart& part) {
  const auto buffer = std::make_shared<std::vector<std::byte>>();
  return [part, buffer](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    try {
      buffer->resize(std::min(length, kPieceBytes));
      part.file->read_exact(part.offset + offset, *buffer);
      return sink.write(reinterpret_cast<const char*>(buffer->data()), buffer->size());
    } catch (const std::exception&) {
      return false;
    }
  };
}

httplib::ContentProvider sender_of(const std::string& text) {
  return [text](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    return sink.write(text.data() + offset, length);
  };
}

}  // namespace

Request request_of(const httplib::Request& request, Body* body) {
  return {request.method,
          request.target,
          host_of(request),
          list(request, "Accept-Encoding"),
          list(request, "If-Match"),
          list(request, "If-None-Match"),
          header(request, "If-Range"),
          header(request, "Range"),
          origin_of(request),
          header(request, "Authorization"),
          header(request, "Content-Type"),
          list(request, "Content-Encoding"),
          request.has_header("Content-Range"),
          announces_body(request),
          body,
          request.remote_addr,
          is_passed_on(request)};
}

std::string http_date(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%a, %d %b %Y %H:%M:%S} GMT",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

void put(const Reply& reply, httplib::Response& response) {
  response.status = reply.status;
  std::string type;
  for (const auto& [name, value] : reply.headers) {
    if (name == "Content-Type")
      type = value;
    else
      response.set_header(name, value);
  }
  if (reply.body_bytes() > 0) {
    response.set_content_provider(reply.body_bytes(), type,
                                  reply.file ? sender_of(*reply.file) : sender_of(reply.text));
  } else if (!type.empty()) {
    response.set_header("Content-Type", type);
  }
}

}  // namespace meshhier::server
