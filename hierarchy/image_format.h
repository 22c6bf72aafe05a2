// The formats of pictures: what files, manifests, glTF and browsers call them, and how their files
// begin. What reads and writes them: images/formats.h.
#pragma once

#include "base/named_value.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace meshhier {

/// How pictures of tiles are stored.
enum class ImageFormat : std::uint8_t { jpeg, png, webp, ktx2 };

/// Quality is a number from 1 to this one, in all formats.
inline constexpr int kBestQuality = 100;
/// For formats that lose something at any quality.
inline constexpr int kNeverExact = kBestQuality + 1;

/// A file has these bytes at that place.
struct FileMark {
  std::size_t at = 0;
  std::string_view bytes;
};

/// A picture as a file.
struct PictureFile {
  std::string_view title;  ///< in sentences
  std::string_view media_type;
  std::array<std::string_view, 2> endings;  ///< the first is written; the second may be empty
  std::array<FileMark, 2> marks;            ///< a file has both; the second may be empty

  /// `start`: at least the first 16 bytes, or all.
  constexpr bool is_start(std::string_view start) const {
    for (const FileMark& mark : marks) {
      if (start.size() < mark.at || !start.substr(mark.at).starts_with(mark.bytes))
        return false;
    }
    return true;
  }
  /// `name`: in small letters.
  constexpr bool is_name(std::string_view name) const {
    for (const std::string_view ending : endings) {
      if (!ending.empty() && name.size() > ending.size() && name.ends_with(ending))
        return true;
    }
    return false;
  }
};

struct ImageFormatRow {
  ImageFormat value;
  std::string_view name;  ///< in configs and manifests
  PictureFile file;
  const char* gltf_extension;  ///< that a document requires to show it; null: none
  bool has_alpha;
  bool in_browsers;  ///< browsers show it, and meshes of others have it
  int exact_from;    ///< the least quality that loses nothing of colours
  bool graded_maps;  ///< quality decides about normal maps; else they are as good as can be
};

inline constexpr auto kImageFormats = std::to_array<ImageFormatRow>({
    {.value = ImageFormat::jpeg,
     .name = "jpeg",
     .file = {"JPEG", "image/jpeg", {".jpg", ".jpeg"}, {{{0, "\xff\xd8\xff"}}}},
     .gltf_extension = nullptr,
     .has_alpha = false,
     .in_browsers = true,
     .exact_from = kNeverExact,
     .graded_maps = true},
    {.value = ImageFormat::png,
     .name = "png",
     .file = {"PNG", "image/png", {".png"}, {{{0, "\x89PNG\r\n\x1a\n"}}}},
     .gltf_extension = nullptr,
     .has_alpha = true,
     .in_browsers = true,
     .exact_from = 1,
     .graded_maps = false},
    {.value = ImageFormat::webp,
     .name = "webp",
     .file = {"WebP", "image/webp", {".webp"}, {{{0, "RIFF"}, {8, "WEBP"}}}},
     .gltf_extension = "EXT_texture_webp",
     .has_alpha = true,
     .in_browsers = true,
     .exact_from = kBestQuality,
     .graded_maps = false},
    {.value = ImageFormat::ktx2,
     .name = "ktx2",
     .file = {"KTX2", "image/ktx2", {".ktx2"}, {{{0, "\xabKTX 20\xbb\r\n\x1a\n"}}}},
     .gltf_extension = "KHR_texture_basisu",
     .has_alpha = true,
     .in_browsers = false,
     .exact_from = kNeverExact,
     .graded_maps = false},
});

constexpr const ImageFormatRow& row_of(ImageFormat format) {
  return kImageFormats[static_cast<std::size_t>(format)];
}
static_assert(are_in_order(kImageFormats, &ImageFormatRow::value));

constexpr bool is_exact(ImageFormat format, int quality) {
  return quality >= row_of(format).exact_from;
}

/// The endings that pictures of a mesh have which no name is given for.
inline std::vector<std::string_view> unnamed_picture_endings() {
  std::vector<std::string_view> endings;
  for (const ImageFormatRow& row : kImageFormats) {
    for (const std::string_view ending : row.file.endings) {
      if (row.in_browsers && !ending.empty())
        endings.push_back(ending);
    }
  }
  return endings;
}

/// Pictures that browsers show and nothing here reads.
inline constexpr auto kOtherPictures = std::to_array<PictureFile>({
    {"GIF", "image/gif", {".gif"}, {{{0, "GIF8"}, {5, "a"}}}},
    {"AVIF", "image/avif", {".avif"}, {{{4, "ftypavi"}}}},
});

/// All that browsers show.
inline constexpr auto kBrowserPictures = [] {
  constexpr std::size_t kRead = [] {
    std::size_t count = 0;
    for (const ImageFormatRow& row : kImageFormats)
      count += row.in_browsers ? 1 : 0;
    return count;
  }();
  std::array<PictureFile, kRead + kOtherPictures.size()> all;
  std::size_t count = 0;
  for (const ImageFormatRow& row : kImageFormats) {
    if (row.in_browsers)
      all[count++] = row.file;
  }
  for (const PictureFile& file : kOtherPictures)
    all[count++] = file;
  return all;
}();

}  // namespace meshhier
