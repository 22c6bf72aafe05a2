// `meshhier page`: one file, and sites.
#include "tests/app/command_line.h"
#include "tests/support/http_host.h"

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A viewer's folder, as much of it as pages and sites need.
class CommandLinePage : public CommandLine {
 protected:
  CommandLinePage() {
    std::filesystem::create_directories(viewer() / "assets");
    write_text(viewer() / "index.html", "<title>meshhier</title>");
    write_text(viewer() / "assets/a.js", "script");
    write_text(viewer() / "single.html",
               "<title>meshhier</title>\n<!-- meshhier: hierarchy -->\n<script></script>");
  }
  Path viewer() const { return work() / "viewer"; }
  Outcome page(Arguments arguments) const {
    arguments.insert(arguments.begin(), "page");
    arguments.insert(arguments.end(), {"--viewer", viewer().string()});
    return run(arguments);
  }
  /// Returns the JSON in a page's script element.
  static nlohmann::json embedded(const Path& file) {
    const std::string text = text_of(file);
    const std::size_t begin = text.find('{'), end = text.find("\n</script>", begin);
    return nlohmann::json::parse(text.substr(begin, end - begin));
  }
};

TEST_F(CommandLinePage, OneFileHasTheHierarchyAsFarAsItFits) {
  build();
  const Path file = work() / "a.html";
  ASSERT_EQ(page({hierarchy(), "-o", file.string()}).code, 0);
  const nlohmann::json all = embedded(file);
  EXPECT_EQ(all["name"], "a");
  EXPECT_FALSE(all.contains("link"));
  std::size_t tiles = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(hierarchy())) {
    const std::string name = entry.path().lexically_relative(hierarchy()).generic_string();
    if (!entry.is_regular_file() || name.starts_with("tileset") || name == "preview.webp")
      continue;
    ASSERT_TRUE(all["files"].contains(name)) << name;
    tiles += name.starts_with("tiles/") ? 1 : 0;
  }
  EXPECT_GT(tiles, 3U);
  const auto size = std::filesystem::file_size(file);
  EXPECT_THAT(text_of(file), HasSubstr("<title>a</title>"));

  const Outcome smaller = page({hierarchy(), "-o", file.string(), "--force", "--size",
                                std::to_string(size * 2 / 3), "--link", "https://h/<a>.3tz"});
  ASSERT_EQ(smaller.code, 0) << smaller.messages;
  EXPECT_LE(std::filesystem::file_size(file), size * 2 / 3);
  EXPECT_THAT(text_of(file), Not(HasSubstr("<a>")));
  const nlohmann::json some = embedded(file);
  EXPECT_EQ(some["link"], "https://h/<a>.3tz");
  EXPECT_TRUE(some["files"].contains("tiles/00/000000.glb"));
  EXPECT_LT(some["files"].size(), all["files"].size());
  EXPECT_THAT(smaller.out, HasSubstr(std::to_string(std::filesystem::file_size(file)) +
                                     " bytes, of which the viewer takes "));
  EXPECT_THAT(smaller.out, HasSubstr("; errors up to"));
  EXPECT_THAT(smaller.out, HasSubstr(" did not fit: the page fetches them from the link"));
}

TEST_F(CommandLinePage, AStoryBesideTheHierarchyIsTold) {
  build();
  const Path file = work() / "a.html", story = hierarchy() + ".story.json";
  const std::string text = R"({"type": "AnnotationPage", "label": "</script>", "items": []})";
  write_text(story, text);
  ASSERT_EQ(page({hierarchy() + "/", "-o", file.string()}).code, 0);
  EXPECT_EQ(embedded(file)["story"], text);
  for (const std::string& bad : {std::string("{"), std::string("[]"), std::string(100'000, '[')}) {
    write_text(story, bad);
    const Outcome outcome = page({hierarchy(), "-o", file.string(), "--force"});
    EXPECT_EQ(outcome.code, kCorrupt);
    EXPECT_THAT(outcome.messages, HasSubstr("a.hier.story.json: it is no JSON object"));
  }
  EXPECT_EQ(embedded(file)["story"], text);
}

/// A story with pictures at these addresses.
std::string story_with_pictures(const std::vector<std::string>& addresses) {
  nlohmann::json bodies = nlohmann::json::array();
  for (const std::string& address : addresses)
    bodies.push_back({{"id", address}, {"type", "Image"}});
  const nlohmann::json note{{"type", "Annotation"}, {"body", bodies}};
  return nlohmann::json{{"type", "AnnotationPage"}, {"items", {note}}}.dump();
}

TEST_F(CommandLinePage, AStorysPicturesBesideItAreInThePage) {
  build();
  const Path file = work() / "a.html";
  const std::string picture = "\x89PNG\r\n\x1a\n1";
  std::filesystem::create_directories(work() / "pictures");
  for (const Path& place : {work() / "pictures/a b.png", work() / "c.jpg",
                            work().parent_path() / "out.png", work() / ".hidden.png"})
    write_text(place, picture);
  write_text(work() / "secret.png", "root:x:0:0");
  std::filesystem::create_symlink(work() / "c.jpg", work() / "link.png");
  const auto pictures_of = [&](const std::vector<std::string>& addresses) {
    write_text(hierarchy() + ".story.json", story_with_pictures(addresses));
    const Outcome outcome = page({hierarchy() + "/", "-o", file.string(), "--force"});
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    const auto story = nlohmann::json::parse(embedded(file)["story"].get<std::string>());
    return std::pair(story["items"][0]["body"], outcome);
  };
  const auto [there, told] =
      pictures_of({"pictures/a%20b.png", "./c.jpg", "pictures/a b.png?v=2#x"});
  ASSERT_EQ(there.size(), 3U);
  for (const auto& body : there)
    EXPECT_EQ(body["id"], "data:image/png;base64,iVBORw0KGgox");
  EXPECT_THAT(told.out, HasSubstr("3 of 3 pictures of the story"));
  EXPECT_THAT(told.messages, Not(HasSubstr("left out")));

  const std::vector<std::string> bad{"../out.png",
                                     (work() / "c.jpg").string(),
                                     "pictures/../../out.png",
                                     "..%2fout.png",
                                     "%2e%2e/out.png",
                                     "link.png",
                                     ".hidden.png",
                                     "secret.png",
                                     "none.png",
                                     "pictures",
                                     "",
                                     "file://" + (work() / "c.jpg").string(),
                                     "javascript:alert(1)",
                                     "https://h.example/a.png",
                                     "//h.example/a.png"};
  const auto [none, all_told] = pictures_of(bad);
  EXPECT_TRUE(none.empty()) << none;
  EXPECT_THAT(all_told.out, HasSubstr("0 of 15 pictures of the story"));
  EXPECT_THAT(all_told.messages,
              HasSubstr("warning: a picture of the story is left out: https://h.example/a.png: it "
                        "is on another host; --fetch-pictures embeds it"));
}

TEST_F(CommandLinePage, AStorysPicturesOfOtherHostsAreFetchedWhereThatIsAsked) {
  build();
  const std::string picture = "GIF89a" + std::string(5000, 'x');
  tests::HttpHost host([&](const tests::HostRequest& request) {
    if (request.target == "/a.gif")
      return tests::answer_with(request, picture);
    if (request.target == "/whole.gif")
      return tests::answer_whole(request, picture);
    if (request.target == "/text.gif")
      return tests::answer_with(request, "no picture");
    if (request.target == "/large.gif")
      return tests::answer_with(request, std::string(3'000'000, 'x'));
    return tests::answer_status(404);
  });
  std::vector<std::string> addresses;
  for (const char* name : {"a.gif", "whole.gif", "text.gif", "large.gif", "none.gif"})
    addresses.push_back(host.url() + name);
  write_text(hierarchy() + ".story.json", story_with_pictures(addresses));
  const Path file = work() / "a.html";
  ASSERT_EQ(page({hierarchy(), "-o", file.string()}).code, 0);
  EXPECT_EQ(host.requests(), 0U);
  const Outcome outcome =
      page({hierarchy(), "-o", file.string(), "--force", "--fetch-pictures", "--size", "2MB"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  EXPECT_THAT(outcome.out, HasSubstr("2 of 5 pictures of the story"));
  EXPECT_THAT(outcome.messages, HasSubstr("text.gif: it is no JPEG"));
  EXPECT_THAT(outcome.messages, HasSubstr("large.gif: it has 2.86 MiB"));
  EXPECT_THAT(outcome.messages, HasSubstr("none.gif: there is no such file on the host"));
  EXPECT_THAT(text_of(file), Not(HasSubstr(host.url())));
}

TEST_F(CommandLinePage, WhatIsWrongIsTold) {
  build();
  const std::string file = (work() / "b.html").string();
  const auto says = [&](const Arguments& arguments, int code, const char* message) {
    const Outcome outcome = page(arguments);
    EXPECT_EQ(outcome.code, code) << message;
    EXPECT_THAT(outcome.messages, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(file));
  };
  says({hierarchy(), "-o", file, "--size", "1000"}, kUsage, "give --size ");
  says({hierarchy(), "-o", file, "--link", "david.3tz"}, kUsage, "--link: expected the address");
  for (const char* secret : {"https://me:word@h/a.3tz", "https://me@h/a.hier", "HTTP://:w@h"})
    says({hierarchy(), "-o", file, "--link", secret}, kUsage, "a user or a password in it");
  says({(work() / "none.hier").string(), "-o", file}, kIo, "none.hier");
  const std::string elsewhere = (work().parent_path() / "c.html").string();
  says({work().string(), "-o", elsewhere, "--link", "https://h/"}, kUsage,
       "--link is for the page of one");
  says({work().string(), "-o", elsewhere, "--fetch-pictures"}, kUsage,
       "--fetch-pictures is for the page of one");
  says({work().string(), "-o", (work().parent_path() / "site").string(), "--size", "20MB"}, kUsage,
       "--size is for the page of one");
  says({work().string(), "-o", elsewhere}, kUsage,
       "the name of an HTML file is for the page of one");
  says({hierarchy(), "-o", (work() / "b.glb").string()}, kUsage, "name it .html");
  std::filesystem::remove(viewer() / "single.html");
  says({hierarchy(), "-o", file}, kIo, "has no single.html");
}

TEST_F(CommandLinePage, AFolderBecomesASite) {
  write_mesh("a.ply");
  const Path models = work() / "models", site = work() / "site";
  std::filesystem::create_directories(models / "sub");
  for (const char* made : {"a.hier", "sub/b c.3tz"}) {
    const Arguments words{"build", (work() / "a.ply").string(), "-o", (models / made).string()};
    ASSERT_EQ(run(words).code, 0);
  }
  write_text(models / "notes.txt", "mine");
  write_text(models / "sub/b c.3tz.story.json", "{}");
  ASSERT_EQ(page({models.string(), "-o", site.string() + "/"}).code, 0);
  EXPECT_EQ(text_of(site / "assets/a.js"), "script");
  EXPECT_FALSE(std::filesystem::exists(site / "single.html"));
  EXPECT_FALSE(std::filesystem::exists(site / "models/notes.txt"));
  for (const char* file : {"sub/b c.3tz", "a.hier/hierarchy.json", "a.hier/tiles/00/000000.glb"})
    EXPECT_EQ(text_of(site / "models" / file), text_of(models / file)) << file;
  const auto listed = nlohmann::json::parse(text_of(site / "models.json"))["models"];
  ASSERT_EQ(listed.size(), 2U);
  EXPECT_EQ(listed[0]["path"], "models/a.hier");
  EXPECT_EQ(listed[0]["preview"], "models/a.hier/preview.webp");
  EXPECT_EQ(listed[1]["path"], "models/sub/b%20c.3tz");
  EXPECT_EQ(listed[1]["preview"], "models/sub/b%20c.3tz.webp");
  EXPECT_THAT(text_of(site / "models/sub/b c.3tz.webp"), HasSubstr("WEBP"));
  EXPECT_EQ(listed[1]["story"], "models/sub/b%20c.3tz.story.json");
  EXPECT_FALSE(listed[0].contains("story"));
  EXPECT_EQ(text_of(site / "models/sub/b c.3tz.story.json"), "{}");
  EXPECT_EQ(run({"verify", (site / "models/a.hier").string()}).code, 0);

  EXPECT_EQ(page({models.string(), "-o", site.string()}).code, kExists);
  std::filesystem::remove_all(models / "a.hier");
  ASSERT_EQ(page({models.string(), "-o", site.string(), "--force"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(site / "models/a.hier"));
  EXPECT_EQ(page({models.string(), "-o", viewer().string(), "--force"}).code, kUsage);
  EXPECT_EQ(page({models.string(), "-o", (models / "site").string()}).code, kUsage);
  EXPECT_EQ(page({viewer().string(), "-o", (work() / "none").string()}).code, kUsage);
  EXPECT_EQ(names(), (std::set<std::string>{"a.ply", "models", "site", "viewer"}));
}

}  // namespace
}  // namespace meshhier::app
