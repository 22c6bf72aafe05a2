#include "server/site.h"

#include "base/error.h"
#include "base/small_letters.h"
#include "hierarchy/image_format.h"
#include "server/conditions.h"
#include "server/file_reply.h"
#include "server/url_path.h"
#include "storage/io/system_failure.h"

#include <array>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// Returns the type of a file by its name, in the words of HTTP; "application/octet-stream" if
/// nothing better is known.
std::string_view content_type(std::string_view file_name) {
  const std::string name = small_letters(file_name);
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

constexpr std::string_view kModels = "models/";
constexpr std::string_view kInbox = "/inbox/";
constexpr std::string_view kAssets = "assets/";
constexpr std::string_view kPageEnding = ".html";
// The page's own policy (viewer/lean/policy.ts) says what it may load; a host can only say the
// rest.
constexpr const char* kPolicy = "Content-Security-Policy";
constexpr std::string_view kPagePolicy = "base-uri 'none'; form-action 'none'; object-src 'none'";
// A worker is bound by its script's. It may fetch models from any host; what transcodes KTX2 makes
// functions of texts.
constexpr std::string_view kScriptPolicy =
    "default-src 'self' http: https: data: blob:; script-src 'self' blob: 'unsafe-eval'";
// All else is data: opened by itself it may do nothing.
constexpr std::string_view kFilePolicy = "default-src 'none'";
constexpr const char* kMethods = "GET, HEAD, OPTIONS";
constexpr const char* kMethodsOfViews = "GET, HEAD, OPTIONS, PUT";
constexpr const char* kMethodsOfInbox = "GET, HEAD, OPTIONS, POST, PUT";

// A hierarchy is never changed, but `build --force` puts another one in its place, under the same
// names: a client that mixed tiles of the two would show cracks. So it asks each time, and is told
// within a millisecond that it has the file already; or it names the build, "?build=NAME", and
// keeps the file for ever: that address never has one of another build.
constexpr const char* kRevalidate = "no-cache";
// For addresses that name their content.
constexpr const char* kForever = "public, max-age=31536000, immutable";

Reply not_found() {
  return text_reply(404, "There is no such file.");
}

/// Forbids caches to keep a reply: a file that is not there now may be there in a moment.
void forbid_keeping(Reply& reply) {
  std::erase_if(reply.headers, [](const auto& header) {
    return header.first == "Cache-Control" || header.first == "ETag";
  });
  reply.headers.emplace_back("Cache-Control", "no-store");
}

/// Whether the request was meant for this host. One that names none is of HTTP/1.0, as health
/// checks of proxies are; browsers always name one.
bool is_for_this_host(const Request& request) {
  return !request.host || is_loopback_name(*request.host);
}

}  // namespace

Site::Site(SiteOptions options, Hierarchies& hierarchies, Jobs jobs, Hierarchies::Tell tell)
    : options_(std::move(options)),
      jobs_(std::move(jobs)),
      tell_(std::move(tell)),
      hierarchies_(hierarchies),
      gallery_(hierarchies_) {}

Reply Site::answer(const Request& request) {
  Reply reply;
  try {
    reply = route(request);
  } catch (const storage::Busy& failure) {
    tell_busy(failure.what());
    reply = busy_reply();
  } catch (const std::bad_alloc& failure) {
    tell_busy(failure.what());
    reply = busy_reply();
  } catch (const std::exception& failure) {
    tell_(failure.what());
    reply = text_reply(500, "The server could not read this; its terminal says why.");
  }
  if (reply.status >= 400)
    forbid_keeping(reply);
  add_safety_headers(reply);
  if (!options_.cors.empty() && !is_vital(request))
    add_cors_headers(reply);
  return reply;
}

/// Tells people once; clients are told by their replies.
void Site::tell_busy(const std::string& cause) {
  if (!told_busy_.exchange(true))
    tell_(cause +
          "; requests get status 503 as long as that is so (ulimit -n says how many files "
          "may be open)");
}

Reply Site::route(const Request& request) {
  if (options_.is_loopback && !is_for_this_host(request)) {
    return text_reply(421,
                      "This server answers to localhost, 127.x.x.x and [::1] only; start it with "
                      "--host to be reached by other names.");
  }
  if (request.method == "OPTIONS") {
    return {.status = 204, .headers = {{"Allow", methods(request.target)}}};
  }
  if (is_upload(request))
    return options_.uploads->take(request, request.target.substr(kInbox.size() - 1));
  if (options_.views != nullptr && request.method == "PUT" && ViewRequests::is_view(request.target))
    return take_view(request);
  if (request.method != "GET" && request.method != "HEAD") {
    Reply reply = text_reply(405, "Files are read here, nothing else.");
    reply.headers.emplace_back("Allow", methods(request.target));
    return reply;
  }
  if (request.has_body)
    return text_reply(413, "This server takes no request with a body.");
  const std::optional<std::string> path = decode_path(request.target);
  if (!path)
    return not_found();
  if (is_vital(request))
    return options_.vitals->answer(request, *path);
  if (*path == "models.json")
    return models_json(request);
  if (path->starts_with(kModels))
    return model_file(request, std::string_view(*path).substr(kModels.size()));
  return viewer_file(request, *path);
}

/// Returns the methods that a target takes; "*" stands for all targets.
const char* Site::methods(std::string_view target) const {
  if (options_.uploads != nullptr && (target == "*" || target.starts_with(kInbox)))
    return kMethodsOfInbox;
  return options_.views != nullptr && ViewRequests::is_view(target) ? kMethodsOfViews : kMethods;
}

bool Site::is_upload(const Request& request) const {
  return options_.uploads != nullptr && (request.method == "PUT" || request.method == "POST") &&
         request.target.starts_with(kInbox);
}

bool Site::is_vital(const Request& request) const {
  const auto path = options_.vitals == nullptr ? std::nullopt : decode_path(request.target);
  return path && Vitals::is_vital(*path);
}

Reply Site::take_view(const Request& request) {
  Reply reply = options_.views->take(request);
  if (reply.status == 200)
    gallery_.refresh();
  return reply;
}

Reply Site::models_json(const Request& request) {
  Surroundings around{
      .jobs = jobs_ ? std::optional(jobs_()) : std::nullopt,
      .places = options_.places,
      .offer = options_.uploads == nullptr ? std::nullopt : options_.uploads->offer()};
  if (around.offer)
    around.offer->takes_views = options_.views != nullptr;
  const std::optional<ListingWish> wish = read_wish(request.target);
  const auto catalogue = gallery_.catalogue(wish ? wish->state : std::string());
  const std::string text = gallery_json(*catalogue, wish, around);
  const std::string tag = text_tag(text);
  const std::optional<int> status = status_by_conditions(request, tag);
  Reply reply{.headers = {{"ETag", tag}, {"Cache-Control", kRevalidate}}, .text = text};
  if (status) {
    reply.status = *status;
    reply.text.clear();
  } else {
    reply.headers.emplace_back("Content-Type", content_type(".json"));
  }
  return reply;
}

Reply Site::model_file(const Request& request, std::string_view path) {
  const std::optional<PublishedFile> found = hierarchies_.open(path);
  if (!found)
    return not_found();
  const auto build = query_value(request.target, "build");
  const bool names_build = build && !found->build.empty();
  if (names_build && *build != found->build)
    return text_reply(409, "Another build of this hierarchy is there by now.");
  return file_reply(request, {.file = found->file,
                              .tag = file_tag(found->file->version(), found->archive_offset),
                              .type = content_type(path),
                              .cache = names_build ? kForever : kRevalidate,
                              .may_be_gzip = found->is_tile});
}

Reply Site::viewer_file(const Request& request, const std::string& path) {
  const std::string name = path.empty() ? "index.html" : path;
  const bool takes_gzip = request.accept_encoding && allows_gzip(*request.accept_encoding);
  std::shared_ptr<const storage::File> file;
  if (options_.viewer && takes_gzip)
    file = options_.viewer->open(name + ".gz");
  const bool is_packed = file != nullptr;
  if (options_.viewer && !file)
    file = options_.viewer->open(name);
  if (!file && path.empty())
    return text_reply(503, options_.missing_viewer);
  if (!file)
    return not_found();
  Reply reply = file_reply(request, {.file = file,
                                     .tag = file_tag(file->version(), 0),
                                     .type = content_type(name),
                                     .cache = name.starts_with(kAssets) ? kForever : kRevalidate,
                                     .may_be_gzip = is_packed});
  if (!is_packed)
    reply.headers.emplace_back("Vary", "Accept-Encoding");
  const bool is_page = name.ends_with(kPageEnding);
  reply.headers.emplace_back(kPolicy, policy(is_page ? kPagePolicy : kScriptPolicy));
  if (is_page)
    reply.headers.emplace_back("Referrer-Policy", "same-origin");
  return reply;
}

/// Returns a policy with the pages that may show the reply in a frame. Without a word on them all
/// may, also those of a disk, which "*" leaves out.
std::string Site::policy(std::string_view directives) const {
  std::string text(directives);
  if (options_.frame != "*")
    text.append("; frame-ancestors 'self'")
        .append(options_.frame.empty() ? "" : " " + options_.frame);
  return text;
}

void Site::add_safety_headers(Reply& reply) const {
  reply.headers.emplace_back("X-Content-Type-Options", "nosniff");
  if (reply.header(kPolicy).empty())
    reply.headers.emplace_back(kPolicy, policy(kFilePolicy));
}

void Site::add_cors_headers(Reply& reply) const {
  reply.headers.emplace_back("Access-Control-Allow-Origin", options_.cors);
  reply.headers.emplace_back(
      "Access-Control-Expose-Headers",
      "Accept-Ranges, Content-Encoding, Content-Length, Content-Range, ETag");
  if (reply.status == 204) {
    reply.headers.emplace_back("Access-Control-Allow-Methods", kMethods);
    reply.headers.emplace_back("Access-Control-Allow-Headers", "If-None-Match, If-Range, Range");
    reply.headers.emplace_back("Access-Control-Max-Age", "86400");
  }
}

}  // namespace meshhier::server
