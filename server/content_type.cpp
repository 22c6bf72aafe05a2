#include "server/content_type.h"

#include "hierarchy/image_format.h"
#include "server/text.h"

#include <array>
#include <string>
#include <utility>

namespace meshhier::server {
namespace {

// The files of hierarchies, streams and the viewer's page, besides pictures.
constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kTypes{
    {{".3tz", "application/vnd.maxar.archive.3tz+zip"},
     {".css", "text/css; charset=utf-8"},
     {".glb", "model/gltf-binary"},
     {".gltf", "model/gltf+json"},
     {".html", "text/html; charset=utf-8"},
     {".ico", "image/x-icon"},
     {".js", "text/javascript; charset=utf-8"},
     {".json", "application/json"},
     {".map", "application/json"},
     {".mjs", "text/javascript; charset=utf-8"},
     {".svg", "image/svg+xml"},
     {".txt", "text/plain; charset=utf-8"},
     {".wasm", "application/wasm"},
     {".webmanifest", "application/manifest+json"},
     {".woff", "font/woff"},
     {".woff2", "font/woff2"}}};

}  // namespace

std::string_view content_type(std::string_view file_name) {
  const std::string name = lower_case(file_name);
  for (const auto& [extension, type] : kTypes) {
    if (name.ends_with(extension))
      return type;
  }
  for (const ImageFormatRow& row : kImageFormats) {
    if (row.file.is_name(name))
      return row.file.media_type;
  }
  for (const PictureFile& file : kOtherPictures) {
    if (file.is_name(name))
      return file.media_type;
  }
  return "application/octet-stream";
}

}  // namespace meshhier::server
