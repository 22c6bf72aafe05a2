#include "server/catalogue.h"

#include "server/descriptions.h"
#include "server/gallery.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Model model(std::string path, std::string title = {}, std::vector<std::string> tags = {}) {
  const std::size_t slash = path.rfind('/');
  Model made{.path = path, .name = path.substr(slash == std::string::npos ? 0 : slash + 1)};
  made.title = std::move(title);
  made.tags = std::move(tags);
  return made;
}

Catalogue catalogue() {
  std::vector<Model> models{
      model("a/scan 10"),      model("a/scan 9", "", {"stone", "old"}),
      model("a/scan 09x"),     model("b/\xC3\x89glise", "Saint Pierre", {"stone"}),
      model("b/\xFF no text"), model("top")};
  models[0].bytes = 5;
  models[3].modified = 100;
  models[5].triangles = 7;
  models[5].folder = "B/inner";
  models[3].place = GlobePlace{2.5, 48.25};
  return Catalogue(std::move(models));
}

std::vector<std::string> found(const ListingWish& wish) {
  static const Catalogue all = catalogue();
  std::vector<std::string> names;
  for (const std::uint32_t i : all.find(wish))
    names.push_back(shown_name(all.models()[i]));
  return names;
}

TEST(CatalogueTest, WordsAreFoundInNamesTitlesFoldersAndTags) {
  EXPECT_THAT(found({.search = "EGLISE"}), ElementsAre("Saint Pierre"));
  EXPECT_THAT(found({.search = "pierre b"}), ElementsAre("Saint Pierre"));
  EXPECT_THAT(found({.search = "stone"}), SizeIs(2));
  EXPECT_THAT(found({.search = "inner"}), ElementsAre("top"));
  EXPECT_THAT(found({.search = "sto sca"}), ElementsAre("scan 9"));
  EXPECT_THAT(found({.search = "nobody"}), IsEmpty());
  EXPECT_THAT(found({.search = " -!"}), SizeIs(6));
  EXPECT_THAT(found({.tag = "stone"}), SizeIs(2));
  EXPECT_THAT(found({.tag = "sto"}), IsEmpty());
  EXPECT_THAT(found({.path = "top"}), ElementsAre("top"));
}

TEST(CatalogueTest, OrdersAreThoseOfPeople) {
  EXPECT_THAT(found({.search = "scan", .order = ModelOrder::name}),
              ElementsAre("scan 9", "scan 09x", "scan 10"));
  EXPECT_EQ(found({.order = ModelOrder::newest}).front(), "Saint Pierre");
  EXPECT_EQ(found({.order = ModelOrder::size}).front(), "scan 10");
  EXPECT_EQ(found({.order = ModelOrder::triangles}).front(), "top");
  EXPECT_EQ(found({.order = ModelOrder::folder}).back(), "top");
}

TEST(CatalogueTest, AWishIsReadFromATarget) {
  EXPECT_FALSE(read_wish("/models.json"));
  EXPECT_FALSE(read_wish("/models.json?search=a&order=name"));
  EXPECT_FALSE(read_wish("/models.json?count=-1"));
  const auto wish = read_wish(
      "/models.json?search=st+pierre%20%C3%A9&order=newest&first=7&count=99999999&tag=a%2Bb&"
      "path=models%2Fsub%2520dir%2Fx.3tz%2F&state=ab");
  ASSERT_TRUE(wish);
  EXPECT_EQ(wish->search, "st pierre \xC3\xA9");
  EXPECT_EQ(wish->order, ModelOrder::newest);
  EXPECT_EQ(wish->first, 7U);
  EXPECT_EQ(wish->count, 1000U);
  EXPECT_EQ(wish->tag, "a+b");
  EXPECT_EQ(wish->path, "sub dir/x.3tz");
  EXPECT_EQ(wish->state, "ab");
  EXPECT_EQ(read_wish("/models.json?count=1&order=x&first=%zz&search=%zz")->order,
            ModelOrder::folder);
  EXPECT_EQ(read_wish("/models.json?count=1&path=../x")->path, "/");
}

TEST(CatalogueTest, APartTellsOfTheWhole) {
  const Catalogue all = catalogue();
  const json part = json::parse(gallery_json(all, read_wish("/?count=2&first=0"), {}));
  EXPECT_THAT(part["models"], SizeIs(2));
  EXPECT_EQ(part["total"], 6);
  EXPECT_EQ(part["found"], 6);
  EXPECT_EQ(part["placed"], 1);
  EXPECT_EQ(part["state"], all.state());
  EXPECT_EQ(part["groups"],
            json::parse(R"([{"folder": "a", "count": 3}, {"folder": "b", "count": 2},
                                            {"folder": "B/inner", "count": 1}])"));
  EXPECT_EQ(part["tags"][0], json::parse(R"({"tag": "stone", "count": 2})"));
  EXPECT_EQ(json::parse(gallery_json(all, read_wish("/?count=2&first=4"), {}))["models"].size(),
            2U);
  EXPECT_EQ(json::parse(gallery_json(all, read_wish("/?count=2&first=99"), {}))["models"].size(),
            0U);
  EXPECT_EQ(json::parse(gallery_json(all, read_wish("/?count=0&places=1"), {}))["places"],
            json::parse("[[2.5, 48.25, 4]]"));
  EXPECT_FALSE(json::parse(gallery_json(all, {}, {})).contains("total"));
  EXPECT_THAT(json::parse(gallery_json(all, {}, {}))["models"], SizeIs(6));
}

TEST(CatalogueTest, PartsOfAnotherListingHaveAnotherName) {
  std::vector<Model> models = catalogue().models();
  EXPECT_EQ(Catalogue(models).state(), catalogue().state());
  models[2].tags = {"new"};
  EXPECT_NE(Catalogue(models).state(), catalogue().state());
}

TEST(StaticListingTest, ManyModelsAreListedInParts) {
  std::vector<Model> models;
  for (int i = 0; i < 500; ++i)
    models.push_back(model("m" + std::to_string(i)));
  EXPECT_THAT(static_gallery_json(models), SizeIs(1));
  for (int i = 500; i < 2321; ++i)
    models.push_back(model("m" + std::to_string(i)));
  const std::vector<ListingFile> files = static_gallery_json(models);
  ASSERT_THAT(files, SizeIs(4));
  const json first = json::parse(files[0].text);
  EXPECT_EQ(first["total"], 2321);
  EXPECT_EQ(first["parts"], json({"listing/1.json", "listing/2.json", "listing/3.json"}));
  std::vector<std::string> paths;
  for (const ListingFile& file : files) {
    const json document = json::parse(file.text);
    for (const json& each : document["models"])
      paths.push_back(each["path"]);
  }
  EXPECT_EQ(paths.size(), models.size());
  for (std::size_t i = 0; i < paths.size(); ++i)
    EXPECT_EQ(paths[i], "models/" + models[i].path);
}

TEST(DescriptionsTest, WhatPeopleSayIsRead) {
  std::vector<std::string> told;
  const auto tell = [&](const std::string& message) { told.push_back(message); };
  const DescriptionTable table = parse_descriptions(
      R"({"models": {"a.hier": {"title": "A", "folder": "/x/y/", "tags": ["t", ""], "place": [11.5, -43]},
                     "b.hier": {"titel": "B", "tags": "t", "place": [181, 0], "title": 5},
                     "c.hier": 7}})",
      "gallery.json", tell);
  EXPECT_EQ(table.at("a.hier"), (Description{"A", "x/y", {"t"}, GlobePlace{11.5, -43}}));
  EXPECT_EQ(table.at("b.hier"), Description());
  EXPECT_THAT(told, SizeIs(5));
  EXPECT_THAT(told, testing::Each(HasSubstr("not used")));
  for (const char* text : {"", "[]", "{", R"({"models": []})", "{\"models\": {\"a\xFF\": {}}}"})
    EXPECT_THROW(parse_descriptions(text, "gallery.json", tell), std::exception) << text;
}

TEST(GlobePlaceTest, IsThatOfTheEllipsoid) {
  const auto near = place_on_globe(Vec3d{4200943.0, 172454.0, 4780131.0});
  ASSERT_TRUE(near);
  EXPECT_NEAR(near->longitude, 2.3507, 1e-3);
  EXPECT_NEAR(near->latitude, 48.856, 1e-2);
  EXPECT_NEAR(place_on_globe(Vec3d{0, 0, 6356752.3142})->latitude, 90, 1e-9);
  EXPECT_NEAR(place_on_globe(Vec3d{-6378137, 0, 0})->longitude, 180, 1e-9);
  EXPECT_NEAR(place_on_globe(Vec3d{0, -6378137, 0})->longitude, -90, 1e-9);
  EXPECT_FALSE(place_on_globe(Vec3d{1, 2, 3}));
  EXPECT_FALSE(place_on_globe(Vec3d{std::nan(""), 0, 0}));
  for (double latitude = -90; latitude <= 90; latitude += 7.5) {
    const double angle = latitude * M_PI / 180, e = 6.69437999014e-3;
    const double normal = 6378137 / std::sqrt(1 - e * std::pow(std::sin(angle), 2));
    const Vec3d point{(normal + 5000) * std::cos(angle), 0,
                      (normal * (1 - e) + 5000) * std::sin(angle)};
    EXPECT_NEAR(place_on_globe(point)->latitude, latitude, 1e-7);
  }
}

}  // namespace
}  // namespace meshhier::server
