// Tests that files, folders and headings that documents name are there.
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::SizeIs;

const fs::path kRoot = MESHHIER_SOURCE_DIR;

std::vector<fs::path> documents() {
  std::vector<fs::path> found{kRoot / "viewer/README.md", kRoot / "python/README.md"};
  const auto add = [&](const fs::directory_entry& entry) {
    if (entry.path().extension() == ".md")
      found.push_back(entry.path());
  };
  std::ranges::for_each(fs::directory_iterator(kRoot), add);
  std::ranges::for_each(fs::recursive_directory_iterator(kRoot / "docs"), add);
  return found;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The first group of each match.
std::vector<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

/// A heading as the anchor that GitHub makes of it.
std::string anchor(const std::string& heading) {
  std::string result;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ')
      result += '-';
    else if (byte >= 0x80 || std::isalnum(byte) != 0 || c == '-' || c == '_')
      result += static_cast<char>(std::tolower(byte));
  }
  return result;
}

bool has_anchor(const fs::path& document, const std::string& name) {
  const std::string text = text_of(document);
  const std::vector<std::string> headings = matches(text, "\n#+ ([^\n]+)");
  return text.find("id=\"" + name + "\"") != std::string::npos ||
         std::ranges::any_of(headings, [&](const std::string& h) { return anchor(h) == name; });
}

bool leads_somewhere(const fs::path& document, const std::string& link) {
  const std::string name = link.substr(0, link.find('#'));
  const fs::path target = name.empty() ? document : document.parent_path() / name;
  const bool is_plain = name.size() == link.size() || target.extension() != ".md";
  return fs::exists(target) && (is_plain || has_anchor(target, link.substr(name.size() + 1)));
}

/// Returns whether a path that begins with a folder of the sources is there, perhaps without its
/// ending. What a build makes is not looked for.
bool is_there(const std::string& path) {
  static const std::array<const char*, 5> endings{"", ".h", ".cpp", ".ts", ".mjs"};
  if (!fs::is_directory(kRoot / path.substr(0, path.find('/'))) || path.starts_with("build/") ||
      path.find("/dist") != std::string::npos || path.find("NAME") != std::string::npos)
    return true;
  return std::ranges::any_of(
      endings, [&](const char* ending) { return fs::exists(kRoot / (path + ending)); });
}

TEST(DocumentsTest, LinksLeadSomewhere) {
  std::vector<std::string> dead;
  for (const fs::path& document : documents()) {
    for (const std::string& link : matches(text_of(document), R"(\]\(([^):\s]+)\))")) {
      if (!leads_somewhere(document, link))
        dead.push_back(document.string() + ": " + link);
    }
  }
  EXPECT_THAT(dead, IsEmpty());
}

TEST(DocumentsTest, PathsOfSourcesAreThere) {
  std::vector<std::string> gone;
  for (const fs::path& document : documents()) {
    for (const std::string& path : matches(text_of(document), R"(`(\w+/[\w./-]+)`)")) {
      if (document.filename() != "CHANGELOG.md" && !is_there(path))
        gone.push_back(document.string() + ": " + path);
    }
  }
  EXPECT_THAT(gone, IsEmpty());
}

TEST(DocumentsTest, WhatIsNotThereIsNoticed) {
  const fs::path document = kRoot / "docs/architecture.md";
  EXPECT_THAT(documents(), testing::Contains(document));
  EXPECT_TRUE(leads_somewhere(document, "file_format.md#0-conventions"));
  EXPECT_FALSE(leads_somewhere(document, "file_format.md#0-nothing"));
  EXPECT_FALSE(leads_somewhere(document, "nothing.md"));
  EXPECT_TRUE(is_there("hierarchy/published"));
  EXPECT_FALSE(is_there("hierarchy/nothing"));
  EXPECT_THAT(matches("[a](b.md) [c](https://d)", R"(\]\(([^):\s]+)\))"), SizeIs(1));
}

}  // namespace
}  // namespace meshhier
