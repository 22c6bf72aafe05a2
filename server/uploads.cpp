#include "server/uploads.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/small_letters.h"
#include "execution/size_text.h"
#include "mesh_io/formats.h"
#include "mesh_io/other_formats.h"
#include "server/build_target.h"
#include "server/folder_scan.h"
#include "server/multipart.h"
#include "server/readiness.h"
#include "server/secret.h"
#include "server/staged_upload.h"
#include "server/url_path.h"
#include "storage/io/system_failure.h"

#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

constexpr std::size_t kStoreBytes = 256 * 1024;
/// After so many bytes the disk is asked to begin, so that the sync at the end has little left to
/// do.
constexpr std::uint64_t kSyncEvery = 64 * 1024 * 1024;
/// After so many bytes it is asked what is free.
constexpr std::uint64_t kLookEvery = 1024 * 1024;
/// A photo scan has some hundred pictures.
constexpr std::size_t kMostFiles = 4096;

using Source = std::function<std::size_t(std::span<std::byte>)>;
/// Throws if the disk is too full to go on.
using Look = std::function<void()>;

/// A server that ends sends no bodies any more.
Reply ending() {
  return {.status = 503};
}

/// Returns a refusal if the body has ended too early; nothing if all has come.
std::optional<Reply> refuse_end(const Body& body) {
  switch (body.end()) {
    case Body::End::whole:
      return std::nullopt;
    case Body::End::lost:
      return text_reply(400, "The request has ended before its body.");
    case Body::End::slow:
      return text_reply(408, "The upload was too slow.");
    case Body::End::stopping:
      return ending();
  }
  return std::nullopt;
}

/// Writes all that comes, and forces it to the disk. Throws Error(io), Error(interrupted) if the
/// server ends, and what `look` throws.
void store(storage::File& file, const Body& body, const Source& source, const Look& look) {
  std::vector<std::byte> buffer(kStoreBytes);
  std::uint64_t written = 0, unsynced = 0;
  while (const std::size_t count = source(buffer)) {
    if (written / kLookEvery != (written + count) / kLookEvery)
      look();
    file.write_at(written, std::span(buffer).first(count));
    written += count;
    unsynced += count;
    if (unsynced >= kSyncEvery) {
      file.start_sync();
      unsynced = 0;
    }
  }
  if (refuse_end(body))
    return;
  file.sync([&] {
    if (body.is_stopping())
      throw Error(ErrorCode::interrupted, "the server ends");
  });
}

/// Returns a refusal if the name of a mesh, "scan.ply" or "house/scan.obj", is too long for its
/// model; nothing if it is not.
std::optional<Reply> refuse_length(const std::string& name, const std::string& suffix) {
  const std::size_t excess = excess_of_name(name, suffix);
  if (excess == 0)
    return std::nullopt;
  return text_reply(400, fmt::format("The name is too long by {} for the files that are made of "
                                     "it: shorten it.",
                                     counted(excess, "bytes")));
}

/// The files of a form, in a folder that is being made.
class FolderFiles {
 public:
  /// `name`: the folder's to be; `suffix`: the hierarchies'.
  FolderFiles(storage::FileSystem& files, std::filesystem::path folder, std::string name,
              std::string suffix, Look look)
      : files_(files),
        folder_(std::move(folder)),
        name_(std::move(name)),
        suffix_(std::move(suffix)),
        look_(std::move(look)) {
    files_.make_directories(folder_);
  }

  /// Takes all files; returns why not all could be taken, or nothing. Throws as store().
  std::optional<Reply> take(Body& body, MultipartReader& form) {
    auto next = form.next();
    for (; next == MultipartReader::Next::file; next = form.next()) {
      if (auto refused = refuse_name(form.name()))
        return refused;
      const auto file = files_.create(folder_ / form.name());
      look_();
      store(
          *file, body, [&](std::span<std::byte> bytes) { return form.read(bytes); }, look_);
      if (auto refused = refuse_end(body))
        return refused;
    }
    if (auto refused = refuse_end(body))
      return refused;
    if (next == MultipartReader::Next::malformed)
      return text_reply(400, "The body is no form of files.");
    if (meshes_ == 0 && rasters_ != 1)
      return text_reply(
          400, fmt::format("There is no mesh among the files: {}.", mesh_io::mesh_endings_text()));
    files_.sync_directory(folder_);
    return std::nullopt;
  }

 private:
  std::optional<Reply> refuse_name(const std::string& name) {
    if (!is_plain_name(name))
      return text_reply(400, "A file has a name that cannot be taken: rename it.");
    if (mesh_io::is_mesh_name(name))
      ++(mesh_io::may_be_picture(name) ? rasters_ : meshes_);
    if (meshes_ > 1)
      return text_reply(400, "There are several meshes among the files: send them one by one.");
    if (!names_.insert(small_letters(name)).second)
      return text_reply(400, "Two files have the same name.");
    if (names_.size() > kMostFiles)
      return text_reply(400, fmt::format("There are more than {} files.", kMostFiles));
    if (mesh_io::is_mesh_name(name))
      return refuse_length(name_ + '/' + name, suffix_);
    return std::nullopt;
  }

  storage::FileSystem& files_;
  std::filesystem::path folder_;
  std::string name_, suffix_;
  Look look_;
  std::set<std::string> names_;  ///< in small letters: some disks make no difference
  std::size_t meshes_ = 0;
  std::size_t rasters_ = 0;  ///< files that may be one, or pictures of a mesh
};

Reply taken(const std::string& name) {
  return text_reply(409, fmt::format("{} is in the inbox already: rename yours.", name));
}

Reply publish(StagedUpload& staged, const std::string& name) {
  if (!staged.publish(name))
    return taken(name);
  return text_reply(201, fmt::format("{} is in the inbox.", name));
}

/// Whether a body is packed for its way (RFC 9110, section 8.4).
bool is_packed(const Request& request) {
  return request.content_encoding && small_letters(*request.content_encoding) != "identity";
}

/// Returns 415, and what is taken instead (RFC 9110, section 15.5.16).
Reply packed_body() {
  Reply reply =
      text_reply(415,
                 "A body that is packed for its way (Content-Encoding) is not taken: send "
                 "it without that header; a packed mesh under its own name, as "
                 "scan.ply.gz.");
  reply.headers.emplace_back("Accept-Encoding", "identity");
  return reply;
}

/// Whether it comes from a page of this server, or from no page: browsers send the origin of the
/// page with each request that is not just for reading; curl sends none.
bool is_of_own_page(const Request& request) {
  if (!request.origin)
    return true;
  const std::string host = request.host.value_or("");
  return *request.origin == "http://" + host || *request.origin == "https://" + host;
}

}  // namespace

/// Counts an upload among those that may be under way at once.
class Uploads::Slot {
 public:
  explicit Slot(std::atomic<std::size_t>& count) : count_(count), number_(++count) {}
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;
  ~Slot() { --count_; }
  std::size_t number() const { return number_; }

 private:
  std::atomic<std::size_t>& count_;
  std::size_t number_;
};

Uploads::Uploads(UploadOptions options, storage::FileSystem& files, Tell tell)
    : options_(std::move(options)), files_(files), tell_(std::move(tell)) {
  remove_stale_uploads(files_, options_.inbox);
}

std::optional<UploadOffer> Uploads::offer() const {
  if (!options_.is_loopback && options_.token.empty())
    return std::nullopt;
  return UploadOffer{options_.limit_bytes, !options_.token.empty()};
}

std::optional<Reply> Uploads::refuse_change(const Request& request) const {
  if (!is_of_own_page(request))
    return text_reply(403, "Pages of others may not send meshes here.");
  if (!offer()) {
    return text_reply(403,
                      "Meshes are taken from this machine only: start the server with "
                      "--upload-token-file to send them from others.");
  }
  if (!options_.token.empty() && !knows_secret(request, options_.token))
    return secret_needed();
  if (request.if_match)
    return text_reply(412, "Nothing here has a tag (If-Match) that a change could ask for.");
  if (is_packed(request))
    return packed_body();
  return std::nullopt;
}

std::optional<Reply> Uploads::refuse_size(const Request& request) const {
  if (request.body == nullptr)
    return text_reply(411, "The request must say how long its body is (Content-Length).");
  if (request.body->bytes() > options_.limit_bytes) {
    return text_reply(413, fmt::format("It is larger than {}, the limit (--upload-limit).",
                                       execution::exact_size_text(options_.limit_bytes)));
  }
  require_room(request.body->bytes());
  return std::nullopt;
}

/// Throws Error(budget) if the inbox's disk has no room for so many bytes more, or that of the
/// hierarchies for none.
void Uploads::require_room(std::uint64_t more) const {
  std::string why = why_below_floor(options_.inbox, options_.disk_floor, more, files_);
  if (why.empty() && !options_.folder.empty())
    why = why_below_floor(options_.folder, options_.disk_floor, 0, files_);
  if (!why.empty())
    throw Error(ErrorCode::budget, fmt::format("The disk has no room for it: {}.", why));
}

std::optional<Reply> Uploads::refuse_name(const std::string& name) const {
  const std::filesystem::path path = options_.inbox / name;
  if (files_.exists(path) || files_.is_link(path))
    return taken(name);
  return refuse_length(name, options_.suffix);
}

UploadCounts Uploads::counts() const {
  return {taken_, refused_, bytes_, at_once_};
}

Reply Uploads::take(const Request& request, std::string_view place) {
  Reply reply = reply_to(request, place);
  ++(reply.status == 201 ? taken_ : refused_);
  if (reply.status == 201)
    bytes_ += request.body->bytes();
  return reply;
}

Reply Uploads::reply_to(const Request& request, std::string_view place) {
  if (auto refused = refuse_change(request))
    return std::move(*refused);
  const std::optional<std::string> name = decode_path(place);
  if (!name || !is_plain_name(*name))
    return text_reply(400,
                      "The name cannot be taken: one part, no dot in front, at most 255 bytes.");
  try {
    return take_whole(request, *name);
  } catch (const storage::Busy&) {
    throw;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted)
      return ending();
    if (error.code() == ErrorCode::budget)
      return text_reply(507, error.what());
    tell_(fmt::format("{}: {}", *name, error.what()));
    return text_reply(507, "It could not be stored; the server's terminal says why.");
  }
}

Reply Uploads::take_whole(const Request& request, const std::string& name) {
  const bool is_file = request.method == "PUT";
  if (is_file && !mesh_io::is_mesh_name(name)) {
    return text_reply(400,
                      fmt::format("A mesh ends in {}; what belongs to it is sent with it, as a "
                                  "form.",
                                  mesh_io::mesh_endings_text()));
  }
  const std::string type = request.content_type.value_or("");
  const auto boundary = is_file ? std::string() : form_boundary(type);
  if (!boundary)
    return text_reply(415, "The files of a folder are sent as a form (multipart/form-data).");
  if (request.is_part)
    return text_reply(400, "Parts of files (Content-Range) are not taken: send all of it.");
  if (auto refused = refuse_size(request))
    return std::move(*refused);
  if (auto refused = refuse_name(name))
    return std::move(*refused);
  const Slot slot(at_once_);
  if (slot.number() > options_.most_at_once) {
    Reply reply = text_reply(503, "Too many uploads are under way: try again later.");
    reply.headers.emplace_back("Retry-After", "10");
    return reply;
  }
  return is_file ? take_file(*request.body, name) : take_folder(*request.body, *boundary, name);
}

Reply Uploads::take_file(Body& body, const std::string& name) {
  StagedUpload staged(files_, options_.inbox);
  store(
      *files_.create(staged.path()), body,
      [&](std::span<std::byte> bytes) { return body.read(bytes); }, [this] { require_room(0); });
  if (auto refused = refuse_end(body))
    return std::move(*refused);
  if (is_archive_name(name) && is_hierarchy(files_.open(staged.path())))
    return text_reply(400, "It is a hierarchy already: put it into the folder that is served.");
  return publish(staged, name);
}

Reply Uploads::take_folder(Body& body, const std::string& boundary, const std::string& name) {
  StagedUpload staged(files_, options_.inbox);
  MultipartReader form(body, boundary);
  FolderFiles files(files_, staged.path(), name, options_.suffix, [this] { require_room(0); });
  if (auto refused = files.take(body, form))
    return std::move(*refused);
  return publish(staged, name);
}

}  // namespace meshhier::server
