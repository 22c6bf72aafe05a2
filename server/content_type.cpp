#include "server/content_type.h"

#include "server/text.h"

#include <array>
#include <string>
#include <utility>

namespace meshhier::server {
namespace {

// What hierarchies, streams, stories' pictures and the viewer's page consist of.
constexpr std::array<std::pair<std::string_view, std::string_view>, 23> kTypes{
    {{".3tz", "application/vnd.maxar.archive.3tz+zip"},
     {".avif", "image/avif"},
     {".css", "text/css; charset=utf-8"},
     {".gif", "image/gif"},
     {".glb", "model/gltf-binary"},
     {".gltf", "model/gltf+json"},
     {".html", "text/html; charset=utf-8"},
     {".ico", "image/x-icon"},
     {".jpeg", "image/jpeg"},
     {".jpg", "image/jpeg"},
     {".js", "text/javascript; charset=utf-8"},
     {".json", "application/json"},
     {".ktx2", "image/ktx2"},
     {".map", "application/json"},
     {".mjs", "text/javascript; charset=utf-8"},
     {".png", "image/png"},
     {".svg", "image/svg+xml"},
     {".txt", "text/plain; charset=utf-8"},
     {".wasm", "application/wasm"},
     {".webmanifest", "application/manifest+json"},
     {".webp", "image/webp"},
     {".woff", "font/woff"},
     {".woff2", "font/woff2"}}};

}  // namespace

std::string_view content_type(std::string_view file_name) {
  const std::string name = lower_case(file_name);
  for (const auto& [extension, type] : kTypes) {
    if (name.ends_with(extension))
      return type;
  }
  return "application/octet-stream";
}

}  // namespace meshhier::server
