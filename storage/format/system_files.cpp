#include "storage/format/system_files.h"

#include "storage/format/archive_format.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace meshhier::storage {
namespace {

constexpr std::array<std::string_view, 3> kFolders{"__MACOSX", "@eaDir", ".AppleDouble"};
constexpr std::array<std::string_view, 3> kFiles{".DS_Store", "Thumbs.db", "desktop.ini"};

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// Whether it is a file that was removed while another machine had it open.
bool is_of_nfs(std::string_view name) {
  constexpr std::string_view kStart = ".nfs";
  return name.starts_with(kStart) && name.size() > kStart.size() &&
         name.find_first_not_of("0123456789abcdefABCDEF", kStart.size()) == std::string_view::npos;
}

bool is_in_folder(std::string_view name) {
  for (std::size_t begin = 0, end = 0; end != std::string_view::npos; begin = end + 1) {
    end = name.find('/', begin);
    if (is_one_of(kFolders, name.substr(begin, end - begin)))
      return true;
  }
  return false;
}

}  // namespace

bool is_system_file(std::string_view name) {
  const std::string_view last = name.substr(name.rfind('/') + 1);  // 0 if there is no slash
  const bool is_apple_double = last.starts_with("._") && last.size() > 2;
  return name == kArchiveIndexName || is_one_of(kFiles, last) || is_apple_double ||
         is_of_nfs(last) || is_in_folder(name);
}

}  // namespace meshhier::storage
