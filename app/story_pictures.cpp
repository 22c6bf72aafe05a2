#include "app/story_pictures.h"

#include "base/error.h"
#include "execution/size_text.h"
#include "server/url_path.h"
#include "storage/io/folder.h"
#include "storage/io/http_client.h"
#include "storage/io/web_address.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::app {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;
using PictureClock = std::chrono::steady_clock;

constexpr std::chrono::seconds kForOne{20}, kForAll{120};

[[noreturn]] void leave_out(const std::string& why) {
  throw Error(ErrorCode::input, why);
}

void require_room(std::uint64_t bytes, std::uint64_t most) {
  if (bytes > exporting::kMostStoryPictureBytes) {
    leave_out(fmt::format("it has {}, more than a story can hold ({})",
                          execution::rounded_size_text(bytes),
                          execution::rounded_size_text(exporting::kMostStoryPictureBytes)));
  }
  if (bytes > most) {
    leave_out(
        fmt::format("it has {}, and of the half of the page that pictures have {} are left: give a "
                    "larger --size",
                    execution::rounded_size_text(bytes), execution::rounded_size_text(most)));
  }
}

/// Whether an address begins with a scheme, "https:", and so is not relative.
bool has_scheme(const std::string& address) {
  return address.find(':') < address.find_first_of("/?#");
}

class PictureFolder {
 public:
  explicit PictureFolder(fs::path path) : path_(path.empty() ? "." : std::move(path)) {}

  Bytes read(const std::string& address, std::uint64_t most) const {
    std::string relative = address.substr(0, address.find_first_of("?#"));
    while (relative.starts_with("./"))
      relative.erase(0, 2);
    const auto name = server::decode_path("/" + relative);
    if (!name || name->empty())
      leave_out("it is no name of a file beside the story");
    const auto file = storage::open_folder(path_)->open(*name);
    if (!file)
      leave_out("there is no such file beside the story");
    require_room(file->size(), most);
    return storage::read_file(*file, most);
  }

 private:
  fs::path path_;
};

class PictureHosts {
 public:
  explicit PictureHosts(const execution::CancelToken& cancel)
      : client_({}, [this, &cancel] {
          cancel.check();
          if (PictureClock::now() > deadline_)
            leave_out(fmt::format("it takes longer than {} seconds", kForOne.count()));
        }) {}

  Bytes fetch(const std::string& address, std::uint64_t most) {
    const auto began = PictureClock::now();
    if (began >= end_)
      leave_out("the pictures before took all of the time that there is for fetching");
    deadline_ = began + kForOne;
    try {
      // One byte more than there is room for tells a picture that is too large.
      const storage::HttpAnswer answer = client_.get({address, ""}, 0, most + 1);
      require_room(std::max<std::uint64_t>(answer.total.value_or(0), answer.bytes.size()), most);
      return answer.bytes;
    } catch (const Error& why) {
      throw Error(why.code(), without_address(why.what()));
    }
  }

 private:
  /// Returns a message without the address that the client puts before it: who asked shows it.
  static std::string without_address(std::string_view what) {
    return std::string(what.substr(what.starts_with(": ") ? 2 : 0));
  }

  PictureClock::time_point deadline_;
  PictureClock::time_point end_ = PictureClock::now() + kForAll;
  storage::HttpClient client_;
};

}  // namespace

exporting::OpenPicture open_story_pictures(const PictureSources& pictures,
                                           const execution::CancelToken& cancel) {
  const auto hosts = pictures.fetches ? std::make_shared<PictureHosts>(cancel) : nullptr;
  return [folder = PictureFolder(pictures.beside), hosts](const std::string& named,
                                                          std::uint64_t most) {
    const std::string address = named.starts_with("//") ? "https:" + named : named;
    if (!storage::is_web_address(address)) {
      if (has_scheme(address))
        leave_out("it is no address of a picture");
      return folder.read(address, most);
    }
    if (hosts == nullptr)
      leave_out("it is on another host; --fetch-pictures embeds it");
    return hosts->fetch(address, most);
  };
}

}  // namespace meshhier::app
