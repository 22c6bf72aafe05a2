#include "server/content_type.h"

#include <array>
#include <utility>

namespace meshhier::server {
namespace {

// What hierarchies, streams and the viewer's page consist of.
constexpr std::array<std::pair<std::string_view, std::string_view>, 20> kTypes{
    {{".3tz", "application/vnd.maxar.archive.3tz+zip"},
     {".css", "text/css; charset=utf-8"},
     {".glb", "model/gltf-binary"},
     {".gltf", "model/gltf+json"},
     {".html", "text/html; charset=utf-8"},
     {".ico", "image/x-icon"},
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
  for (const auto& [extension, type] : kTypes) {
    if (file_name.ends_with(extension))
      return type;
  }
  return "application/octet-stream";
}

}  // namespace meshhier::server
