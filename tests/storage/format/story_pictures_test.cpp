#include "storage/format/story_pictures.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::string story_with(const std::vector<std::string>& pictures) {
  auto bodies = nlohmann::json::array();
  for (const std::string& picture : pictures)
    bodies.push_back({{"id", picture}, {"type", "Image"}});
  return nlohmann::json{
      {"type", "AnnotationPage"},
      {"items", nlohmann::json::array({{{"type", "Annotation"}, {"body", std::move(bodies)}}})}}
      .dump();
}

TEST(StoryPicturesTest, ThoseBesideAStoryAreFoundAsBrowsersResolveThem) {
  EXPECT_THAT(
      pictures_beside(story_with({"b.jpg", "pictures/1.PNG", "./c.webp", "x/../d.gif", "a%20b.jpeg",
                                  "e.avif?size=2#x", "b.jpg", "f g.png"})),
      ElementsAre("a b.jpeg", "b.jpg", "c.webp", "d.gif", "e.avif", "f g.png", "pictures/1.PNG"));
}

TEST(StoryPicturesTest, WhatLeadsElsewhereOrIsNoPictureIsLeftOut) {
  for (const char* address : {"",
                              "https://host/a.png",
                              "//host/a.png",
                              "/a.png",
                              "../a.png",
                              "x/../../a.png",
                              "%2e%2e/a.png",
                              "x%2fa.png",
                              "x%5ca.png",
                              "x\\a.png",
                              ".hidden/a.png",
                              ".a.png",
                              "data:image/png;base64,AA==",
                              "a.svg",
                              "a.html",
                              "a.png/",
                              "a.png.exe",
                              "x//a.png",
                              ".png",
                              "x/.png",
                              "a%.png",
                              "a%zz.png",
                              "a%00.png",
                              "file:///a.png",
                              "C:a.png",
                              "hierarchy.json"})
    EXPECT_THAT(pictures_beside(story_with({address})), IsEmpty()) << address;
}

TEST(StoryPicturesTest, TheyMayBeAnywhereInAManifest) {
  EXPECT_THAT(pictures_beside(R"({"type": "Manifest", "items": [{"items": [{"items": [
                {"body": {"type": "Choice", "items": [{"type": "Image", "id": "en.png"},
                                                      {"type": "Image", "id": "de.png"}]}}]}]}]})"),
              ElementsAre("de.png", "en.png"));
}

TEST(StoryPicturesTest, WhatIsNoStoryHasNone) {
  for (const char* text : {"", "{", "[]", "7", "null", "{\"type\": \"Image\"}",
                           "{\"type\": \"Image\", \"id\": 7}", "{\"type\": 7, \"id\": \"a.png\"}"})
    EXPECT_THAT(pictures_beside(text), IsEmpty()) << text;
  EXPECT_THAT(pictures_beside(std::string(1'000'000, '[')), IsEmpty());
}

}  // namespace
}  // namespace meshhier::storage
