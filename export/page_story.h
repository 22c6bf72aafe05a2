// The story of a page that fetches nothing: its pictures are in it.
#pragma once

#include "storage/format/layout.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace meshhier::exporting {

/// Returns the bytes of the picture that a story names by this address, at most `most_bytes`.
/// Throws Error, which says why there are none.
using OpenPicture =
    std::function<std::vector<std::byte>(const std::string& address, std::uint64_t most_bytes)>;

/// The largest picture of a story: in base64, more would exceed a story's file.
inline constexpr std::uint64_t kMostStoryPictureBytes = storage::kMostStoryBytes / 4 * 3;

struct PageStory {
  std::string text;                   ///< JSON; empty: there is no story
  std::uint64_t pictures = 0;         ///< pictures that are in it
  std::vector<std::string> left_out;  ///< a line for each picture that is not, which says why
};

/// Puts the pictures of annotations (objects of the type "Image" in a "body") in the place of their
/// addresses, as `data:` URIs, in their order, as long as they together have no more than
/// `most_bytes`; removes those that cannot be had, or that browsers do not show. Where
/// nothing changes, the text is the same. Throws Error(corrupt) that starts with `name` if `text`
/// is no JSON object.
PageStory with_pictures(const std::string& text, const std::string& name, std::uint64_t most_bytes,
                        const OpenPicture& open);

/// Returns the media type of a picture that browsers show, by its first bytes: "image/png"; empty
/// for all else.
std::string_view picture_type(const std::vector<std::byte>& bytes);

}  // namespace meshhier::exporting
