#include "export/page_story.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "export/base64.h"
#include "hierarchy/image_format.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::exporting {
namespace {

using Json = nlohmann::ordered_json;

/// The most arrays and objects within each other: a deeper JSON is no story.
constexpr int kDeepestStory = 64;
/// The longest address in a message.
constexpr std::size_t kMostShown = 120;

/// Returns an address without parts that may be secret: user and password, and the text behind a
/// '?'.
std::string shown_address(const std::string& address) {
  std::string shown = address.substr(0, address.find_first_of("?#"));
  const std::size_t host = shown.find("//");
  if (host != std::string::npos) {
    const std::size_t path = std::min(shown.find('/', host + 2), shown.size());
    const std::size_t user = shown.substr(0, path).rfind('@');
    if (user != std::string::npos && user > host)
      shown.erase(host + 2, user - host - 1);
  }
  return plain_text(shown, kMostShown);
}

/// Returns "it is no JPEG, PNG or GIF".
std::string no_browser_picture() {
  std::string text = "it is no ";
  for (std::size_t i = 0; i < kBrowserPictures.size(); ++i) {
    const bool is_last = i + 1 == kBrowserPictures.size();
    text += fmt::format("{}{}", i == 0 ? "" : is_last ? " or " : ", ", kBrowserPictures[i].title);
  }
  return text;
}

class Embedding {
 public:
  Embedding(std::uint64_t most_bytes, const OpenPicture& open) : room_(most_bytes), open_(open) {}

  /// Returns false if a value is to be removed from the object or list that has it.
  bool keeps(Json& value, bool is_in_body) {
    if (value.is_object() && is_in_body && is_image(value))
      return embeds(value["id"].get_ref<std::string&>());
    if (value.is_object()) {
      for (auto each = value.begin(); each != value.end();)
        each = keeps(*each, is_in_body || each.key() == "body") ? std::next(each)
                                                                : remove(value, each);
    } else if (value.is_array()) {
      for (auto each = value.begin(); each != value.end();)
        each = keeps(*each, is_in_body) ? std::next(each) : remove(value, each);
    }
    return true;
  }

  bool has_changed() const { return pictures_ > 0 || !left_out_.empty(); }
  std::uint64_t pictures() const { return pictures_; }
  std::vector<std::string> left_out() && { return std::move(left_out_); }

 private:
  static bool is_image(const Json& value) {
    const auto type = value.find("type"), id = value.find("id");
    return type != value.end() && *type == "Image" && id != value.end() && id->is_string();
  }

  static Json::iterator remove(Json& from, Json::iterator each) { return from.erase(each); }

  bool embeds(std::string& address) {
    if (address.starts_with("data:"))
      return true;
    try {
      const std::vector<std::byte> bytes = open_(address, room_);
      const std::string_view type = picture_type(bytes);
      if (type.empty())
        throw Error(ErrorCode::input, no_browser_picture());
      room_ -= std::min<std::uint64_t>(room_, bytes.size());
      address = fmt::format("data:{};base64,{}", type, base64(bytes));
      ++pictures_;
      return true;
    } catch (const Error& why) {
      if (why.code() == ErrorCode::interrupted)
        throw;
      left_out_.push_back(fmt::format("{}: {}", shown_address(address), why.what()));
      return false;
    }
  }

  std::uint64_t room_;
  const OpenPicture& open_;
  std::uint64_t pictures_ = 0;
  std::vector<std::string> left_out_;
};

}  // namespace

std::string_view picture_type(const std::vector<std::byte>& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto* const found = std::ranges::find_if(
      kBrowserPictures, [&](const PictureFile& file) { return file.is_start(text); });
  return found == kBrowserPictures.end() ? std::string_view() : found->media_type;
}

PageStory with_pictures(const std::string& text, const std::string& name, std::uint64_t most_bytes,
                        const OpenPicture& open) {
  bool is_shallow = true;
  const auto watch = [&](int depth, auto, const auto&) {
    is_shallow = is_shallow && depth < kDeepestStory;
    return depth < kDeepestStory;
  };
  Json story = storage::parse_ordered_json_text(text, watch, {.throws = false});
  if (!is_shallow || !story.is_object())
    throw Error(ErrorCode::corrupt, name + ": it is no JSON object");
  Embedding embedding(most_bytes, open);
  embedding.keeps(story, false);
  if (!embedding.has_changed())
    return {text, 0, {}};
  return {storage::json_text(story), embedding.pictures(), std::move(embedding).left_out()};
}

}  // namespace meshhier::exporting
