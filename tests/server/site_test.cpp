#include "server/site.h"

#include "base/error.h"
#include "server/conditions.h"
#include "server/static_site.h"
#include "storage/format/gzip.h"
#include "storage/format/input_note.h"
#include "storage/format/layout.h"
#include "tests/server/path_tricks.h"
#include "tests/server/refusing_folder.h"
#include "tests/server/served_folder.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using tests::text_of;

std::string body_of(const Reply& reply) {
  if (!reply.file)
    return reply.text;
  std::string text(reply.file->bytes, '\0');
  reply.file->file->read_exact(reply.file->offset, std::as_writable_bytes(std::span(text)));
  return text;
}

class SiteTest : public testing::Test {
 protected:
  SiteTest() { open({}); }

  void open(SiteOptions options, const Site::Jobs& jobs = {}) {
    options.viewer = storage::open_folder(folder_.viewer());
    open_as(std::move(options), storage::open_folder(folder_.models()), jobs);
  }
  /// These names in the folder of models cannot be read.
  void open_refusing(std::set<std::string> refused) {
    open_as({},
            std::make_shared<tests::RefusingFolder>(storage::open_folder(folder_.models()),
                                                    std::move(refused)),
            {});
  }
  void open_as(SiteOptions options, std::shared_ptr<const storage::Folder> models,
               const Site::Jobs& jobs) {
    const auto tell = [this](const std::string& message) { told_.push_back(message); };
    site_.reset();
    hierarchies_ = std::make_unique<Hierarchies>(std::move(models), tell);
    site_ = std::make_unique<Site>(std::move(options), *hierarchies_, jobs, tell);
  }

  static Request request(const std::string& target) {
    return {.target = target, .host = "localhost:8080"};
  }
  Reply get(const std::string& target) { return site_->answer(request(target)); }
  /// The paths in a list that is made anew.
  std::vector<std::string> listed() {
    site_->refresh();
    const Reply reply = get("/models.json");
    EXPECT_EQ(reply.status, 200) << reply.text;
    std::vector<std::string> paths;
    const json document = json::parse(reply.text);
    for (const json& model : document["models"])
      paths.push_back(model["path"]);
    return paths;
  }

  tests::ServedFolder folder_;
  std::vector<std::string> told_;
  std::unique_ptr<Hierarchies> hierarchies_;
  std::unique_ptr<Site> site_;
};

TEST_F(SiteTest, EachReplyHasOnePolicy) {
  const auto policy = [&](const std::string& target) {
    const Reply reply = get(target);
    EXPECT_EQ(std::ranges::count(reply.headers, "Content-Security-Policy",
                                 [](const auto& header) { return header.first; }),
              1)
        << target;
    return std::string(reply.header("Content-Security-Policy"));
  };
  EXPECT_THAT(policy("/"), AllOf(HasSubstr("object-src 'none'"), Not(HasSubstr("script-src")),
                                 EndsWith("frame-ancestors 'self'")));
  EXPECT_EQ(get("/").header("Referrer-Policy"), "same-origin");
  for (const char* target : {"/models.json", "/models/plain.hier/hierarchy.json", "/nothing",
                             "/models/plain.hier/nothing"})
    EXPECT_EQ(policy(target), "default-src 'none'; frame-ancestors 'self'") << target;
  Request again = request("/");
  again.if_none_match = get("/").header("ETag");
  EXPECT_EQ(site_->answer(again).status, 304);
  EXPECT_EQ(site_->answer(again).header("Content-Security-Policy"), policy("/"));
}

TEST_F(SiteTest, OthersMayFrameThePageWhereThatIsAllowed) {
  open({.frame = "https://a.example:8443"});
  for (const char* target : {"/", "/models.json"}) {
    EXPECT_THAT(std::string(get(target).header("Content-Security-Policy")),
                EndsWith("frame-ancestors 'self' https://a.example:8443"));
  }
  open({.frame = "*"});
  EXPECT_THAT(std::string(get("/").header("Content-Security-Policy")),
              Not(HasSubstr("frame-ancestors")))
      << "a page of a disk is no network's, which * means";
}

TEST_F(SiteTest, TheListHasAllHierarchiesByPath) {
  const Reply reply = get("/models.json");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("Content-Type"), "application/json");
  EXPECT_EQ(reply.header("Cache-Control"), "no-cache");
  const json document = json::parse(reply.text);
  EXPECT_FALSE(document.contains("jobs"));
  EXPECT_THAT(listed(), ElementsAre("models/packed.3tz/", "models/plain.hier",
                                    "models/sub%20dir/zipped.hier"));
  const json model = document["models"][1];
  EXPECT_EQ(model["name"], "plain");
  EXPECT_EQ(model["source"], "plain.ply");
  const json manifest = json::parse(text_of(folder_.models() / "plain.hier/hierarchy.json"));
  EXPECT_EQ(model["vertices"], manifest["source"]["vertices"]);
  EXPECT_EQ(model["triangles"], manifest["source"]["triangles"]);
  const std::string preview = model["preview"];
  EXPECT_EQ(preview, std::string(model["path"]) + "/preview.webp");
  const Reply picture = get("/" + preview);
  EXPECT_EQ(picture.header("Content-Type"), "image/webp");
  EXPECT_EQ(picture.body_bytes(), manifest["preview"]["bytes"]);
  EXPECT_EQ(model["bytes"], manifest["total_bytes"]);
}

TEST_F(SiteTest, AStoryBesideAHierarchyIsListedAndServed) {
  const auto stories = [&] {
    site_->refresh();
    std::vector<std::string> listed;
    const json document = json::parse(get("/models.json").text);
    for (const json& model : document["models"])
      listed.push_back(model.value("story", ""));
    return listed;
  };
  EXPECT_THAT(stories(), ElementsAre("", "", ""));
  for (const char* name :
       {"packed.3tz", "plain.hier", "sub dir/zipped.hier", "notes.txt", "none.hier", ""})
    tests::write_text(folder_.models() / (std::string(name) + ".story.json"), name);
  EXPECT_THAT(stories(), ElementsAre("models/packed.3tz.story.json", "models/plain.hier.story.json",
                                     "models/sub%20dir/zipped.hier.story.json"));
  const Reply story = get("/models/sub%20dir/zipped.hier.story.json");
  EXPECT_EQ(body_of(story), "sub dir/zipped.hier");
  EXPECT_EQ(story.header("Content-Type"), "application/json");
  EXPECT_EQ(story.header("Cache-Control"), "no-cache");
  EXPECT_EQ(body_of(get("/models/packed.3tz.story.json")), "packed.3tz");
  for (const char* target :
       {"/models/notes.txt.story.json", "/models/none.hier.story.json", "/models/.story.json",
        "/models/stream.prog.story.json", "/models/plain.hier/.story.json"})
    EXPECT_EQ(get(target).status, 404) << target;
}

TEST_F(SiteTest, PicturesThatAStoryNamesAreServedAndNoOthers) {
  const auto story = [](const std::string& picture) {
    return R"({"items": [{"body": [{"type": "Image", "id": ")" + picture + "\"}]}]}";
  };
  fs::create_directories(folder_.models() / "sub dir/pictures");
  for (const char* name : {"a.jpg", "b.jpg", "evil.svg", "sub dir/pictures/1.PNG", "sub dir/c.webp",
                           "plain.hier/inside.png"})
    tests::write_text(folder_.models() / name, name);
  for (const char* target : {"/models/a.jpg", "/models/sub%20dir/pictures/1.PNG"})
    EXPECT_EQ(get(target).status, 404) << "no story names it: " << target;
  tests::write_text(folder_.models() / "plain.hier.story.json", story("a.jpg"));
  tests::write_text(folder_.models() / "sub dir/zipped.hier.story.json", story("pictures/1.PNG"));
  tests::write_text(folder_.models() / "none.hier.story.json", story("b.jpg"));
  const Reply picture = get("/models/a.jpg");
  EXPECT_EQ(body_of(picture), "a.jpg");
  EXPECT_EQ(picture.header("Content-Type"), "image/jpeg");
  EXPECT_EQ(picture.header("Cache-Control"), "no-cache");
  EXPECT_EQ(picture.header("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(get("/models/sub%20dir/pictures/1.PNG").header("Content-Type"), "image/png");
  for (const char* target :
       {"/models/b.jpg", "/models/evil.svg", "/models/sub%20dir/c.webp", "/models/notes.txt",
        "/models/plain.hier/inside.png", "/models/sub%20dir/a.jpg", "/models/../secret.txt"})
    EXPECT_EQ(get(target).status, 404) << target;
  tests::write_text(folder_.models() / "plain.hier.story.json", story("b.jpg?x=1"));
  EXPECT_EQ(get("/models/a.jpg").status, 404) << "it is named no more";
  EXPECT_EQ(get("/models/b.jpg").status, 200);
  tests::write_text(folder_.models() / "plain.hier.story.json", story("../secret.txt"));
  EXPECT_EQ(get("/models/secret.txt").status, 404);
}

TEST_F(SiteTest, WhereNoFileCanBeOpenedClientsAreToldToComeAgain) {
  const auto busy = std::make_shared<tests::BusyFolder>(storage::open_folder(folder_.models()));
  const auto page = std::make_shared<tests::BusyFolder>(storage::open_folder(folder_.viewer()));
  tests::write_text(folder_.models() / "plain.hier.story.json", "{}");
  const auto answer = [&](const std::string& target, int calls) {
    busy->calls_left = page->calls_left = calls;
    SiteOptions options;
    options.viewer = page;
    open_as(std::move(options), busy, {});
    return get(target);
  };
  const std::vector<std::string> targets{"/",
                                         "/assets/page-1a2b.js",
                                         "/models.json",
                                         "/models/plain.hier/hierarchy.json",
                                         "/models/plain.hier/tiles/00/000000.glb",
                                         "/models/plain.hier.story.json",
                                         "/models/packed.3tz",
                                         "/models/packed.3tz/tiles.bin",
                                         "/models/stream.prog/base.bin",
                                         "/models/sub%20dir/zipped.hier/preview.webp"};
  for (const std::string& target : targets) {
    bool was_busy = false;
    for (int calls = 0; calls < 40; ++calls) {
      const Reply reply = answer(target, calls);
      ASSERT_THAT(reply.status, testing::AnyOf(200, 503)) << target << " after " << calls;
      if (reply.status == 200)
        continue;
      was_busy = true;
      EXPECT_EQ(reply.header("Retry-After"), "1");
      EXPECT_EQ(reply.header("Cache-Control"), "no-store");
    }
    EXPECT_TRUE(was_busy) << target;
    EXPECT_EQ(answer(target, -1).status, 200) << target;
  }
}

TEST_F(SiteTest, NoFailureIsKept) {
  Request outside = request("/assets/page-1a2b.js");
  outside.range = "bytes=100000-";
  Request body = request("/models.json");
  body.has_body = true;
  Request method = request("/");
  method.method = "DELETE";
  Request packed = request("/models/sub%20dir/zipped.hier/tiles/00/000000.glb");
  packed.accept_encoding = "identity";
  for (const Request& refused : {outside, body, method, packed, request("/none"), request("/.x")}) {
    const Reply reply = site_->answer(refused);
    EXPECT_GE(reply.status, 400) << refused.target;
    EXPECT_EQ(reply.header("Cache-Control"), "no-store") << refused.target;
  }
}

TEST_F(SiteTest, WarningsOfABuildAreListedWhereAFolderIsWatched) {
  using Warnings = std::vector<std::string>;
  const auto note = [&](std::uint64_t content) {
    const storage::InputNote kept{.content = content,
                                  .files = {{"plain.ply", {}, 0}},
                                  .awaited = {},
                                  .warnings = {"wall.mtl: missing"}};
    tests::write_text(folder_.models() / storage::input_note_path("plain.hier"),
                      storage::to_json_text(kept));
    site_->refresh();
    return json::parse(get("/models.json").text)["models"][1].value("warnings", Warnings());
  };
  const std::uint64_t content = hierarchies_->look("plain.hier").value().source_checksum;
  EXPECT_THAT(note(content), IsEmpty()) << "readers learn nothing of how models were made";
  open({}, [] { return nlohmann::ordered_json::array(); });
  EXPECT_THAT(note(content), ElementsAre("wall.mtl: missing"));
  EXPECT_THAT(note(content + 1), IsEmpty()) << "it is about another build";
}

TEST_F(SiteTest, AStoryThatMayNotBeReadHidesNoModel) {
  tests::write_text(folder_.models() / "plain.hier.story.json", "{}");
  tests::write_text(folder_.models() / "packed.3tz.story.json", "{}");
  open_refusing({"plain.hier.story.json"});
  const json models = json::parse(get("/models.json").text)["models"];
  ASSERT_THAT(models, SizeIs(3));
  EXPECT_TRUE(models[0].contains("story"));
  EXPECT_FALSE(models[1].contains("story"));
  EXPECT_THAT(told_, testing::Contains(HasSubstr("plain.hier.story.json")));
  fs::resize_file(folder_.models() / "packed.3tz.story.json", storage::kMostStoryBytes + 1);
  site_->refresh();
  EXPECT_FALSE(json::parse(get("/models.json").text)["models"][0].contains("story"));
  EXPECT_EQ(get("/models/packed.3tz.story.json").status, 404);
}

TEST_F(SiteTest, TheListTellsWhenHierarchiesWereMade) {
  using namespace std::chrono_literals;
  const auto long_ago = fs::file_time_type::clock::now() - 1000h;
  const std::int64_t now = std::chrono::duration_cast<std::chrono::seconds>(
                               std::chrono::system_clock::now().time_since_epoch())
                               .count();
  fs::last_write_time(folder_.models() / "plain.hier/hierarchy.json", long_ago);
  fs::last_write_time(folder_.models() / "packed.3tz", long_ago - 1h);
  const json models = json::parse(get("/models.json").text)["models"];
  EXPECT_NEAR(models[1]["modified"].get<double>(), static_cast<double>(now - 1000 * 3600), 600);
  EXPECT_EQ(models[1]["modified"].get<std::int64_t>() - models[0]["modified"].get<std::int64_t>(),
            3600);
}

TEST_F(SiteTest, AHierarchyThatIsNotCompleteIsListedWhenItIs) {
  get("/models.json");
  for (const char* name : {"tiles.bin", "tiles/00/000000.glb"}) {
    const fs::path file = folder_.models() / "plain.hier" / name, away = folder_.models() / "away";
    fs::rename(file, away);
    open({});
    told_.clear();
    EXPECT_THAT(listed(), ElementsAre("models/packed.3tz/", "models/sub%20dir/zipped.hier"));
    EXPECT_THAT(told_, testing::Contains(HasSubstr(file.string() + " is not there")));
    fs::rename(away, file);
    EXPECT_THAT(listed(), testing::Contains("models/plain.hier"));
  }
}

TEST_F(SiteTest, AnArchiveIsListedInCapitalsToo) {
  fs::rename(folder_.models() / "packed.3tz", folder_.models() / "PACKED.3TZ");
  EXPECT_THAT(listed(), testing::Contains("models/PACKED.3TZ/"));
  EXPECT_EQ(get("/models/PACKED.3TZ/tiles.bin").status, 200);
}

TEST_F(SiteTest, AHierarchyThatCannotBeReadIsToldOnce) {
  get("/models.json");
  open({});
  told_.clear();
  get("/models.json");
  get("/models/broken.hier/tiles.bin");
  get("/models/broken.hier/hierarchy.json");
  EXPECT_THAT(told_, ElementsAre(HasSubstr("broken.hier/hierarchy.json")));
}

TEST_F(SiteTest, AManifestThatMayNotBeReadHidesNoOther) {
  open_refusing({"plain.hier/hierarchy.json", "broken.hier/"});
  for (int i = 0; i < 2; ++i)
    EXPECT_THAT(listed(), ElementsAre("models/packed.3tz/", "models/sub%20dir/zipped.hier"));
  EXPECT_EQ(get("/models/plain.hier/tiles.bin").status, 404);
  EXPECT_EQ(get("/models/packed.3tz/tiles.bin").status, 200);
  EXPECT_THAT(told_, testing::UnorderedElementsAre(
                         "not shown: cannot open plain.hier/hierarchy.json: refused",
                         "not shown: cannot open broken.hier: refused"));
}

TEST_F(SiteTest, ADirectoryThatMayNotBeReadHidesNoOther) {
  open_refusing({"sub dir/", "broken.hier/"});
  for (int i = 0; i < 2; ++i)
    EXPECT_THAT(listed(), ElementsAre("models/packed.3tz/", "models/plain.hier"));
  EXPECT_THAT(told_, testing::UnorderedElementsAre("not shown: cannot open sub dir: refused",
                                                   "not shown: cannot open broken.hier: refused"));
}

TEST_F(SiteTest, ArchivesAndStreamsThatMayNotBeReadHideNoOther) {
  open_refusing({"packed.3tz", "stream.prog/", "broken.hier/"});
  for (int i = 0; i < 2; ++i) {
    EXPECT_THAT(listed(), ElementsAre("models/plain.hier", "models/sub%20dir/zipped.hier"));
    EXPECT_EQ(get("/models/packed.3tz/tiles.bin").status, 404);
    EXPECT_EQ(get("/models/stream.prog/progressive.json").status, 404);
  }
  const auto count = [&](const char* text) {
    return std::count_if(told_.begin(), told_.end(), [&](const std::string& message) {
      return message.find(text) != std::string::npos;
    });
  };
  EXPECT_EQ(count("packed.3tz"), 1);
  EXPECT_EQ(count("stream.prog/"), 1);
}

TEST_F(SiteTest, AFolderThatMayNotBeReadIsAnError) {
  open_refusing({""});
  EXPECT_EQ(get("/models.json").status, 500);
}

TEST_F(SiteTest, NamesWithoutEndAreNotToldWithoutEnd) {
  open_refusing({"sub dir/"});
  for (int i = 0; i < 1100; ++i)
    get("/models/sub%20dir/" + std::to_string(i) + "/tiles.bin");
  EXPECT_THAT(told_, SizeIs(1000));
}

TEST_F(SiteTest, TheListIsKnownByItsTag) {
  Request again = request("/models.json");
  again.if_none_match = std::string(get("/models.json").header("ETag"));
  const Reply reply = site_->answer(again);
  EXPECT_EQ(reply.status, 304);
  EXPECT_THAT(body_of(reply), IsEmpty());
  again.if_none_match = "\"another\"";
  EXPECT_EQ(site_->answer(again).status, 200);
}

TEST_F(SiteTest, JobsAreListedWhereAFolderIsWatched) {
  open({}, [] {
    return nlohmann::ordered_json::array({{{"name", "x.ply"}, {"state", "waiting"}}});
  });
  const json document = json::parse(get("/models.json").text);
  ASSERT_THAT(document["jobs"], SizeIs(1));
  EXPECT_EQ(document["jobs"][0]["name"], "x.ply");
}

TEST_F(SiteTest, EveryFileOfEveryHierarchyIsServedAsItIs) {
  for (const char* name : {"plain.hier", "sub dir/zipped.hier", "stream.prog"}) {
    const fs::path hierarchy = folder_.models() / name;
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(hierarchy)) {
      if (!entry.is_regular_file())
        continue;
      std::string path = "/models/" + (name / entry.path().lexically_relative(hierarchy)).string();
      if (const std::size_t blank = path.find(' '); blank != std::string::npos)
        path.replace(blank, 1, "%20");
      const Reply reply = get(path);
      EXPECT_EQ(reply.status, 200) << path;
      EXPECT_EQ(body_of(reply), text_of(entry.path())) << path;
      ++files;
    }
    EXPECT_GT(files, 2U) << name;
  }
  for (const char* name : {"hierarchy.json", "tiles.bin", "outline.glb", "tileset.json",
                           "tiles/00/000000.glb", "tiles/01/000001.glb"}) {
    const Reply reply = get("/models/packed.3tz/" + std::string(name));
    EXPECT_EQ(reply.status, 200) << name;
    EXPECT_EQ(body_of(reply), tests::text_in_archive(folder_.models() / "packed.3tz", name))
        << name;
  }
}

TEST_F(SiteTest, FilesHaveTheirTypes) {
  const auto type = [&](const char* path) { return std::string(get(path).header("Content-Type")); };
  EXPECT_EQ(type("/models/plain.hier/hierarchy.json"), "application/json");
  EXPECT_EQ(type("/models/plain.hier/tiles.bin"), "application/octet-stream");
  EXPECT_EQ(type("/models/plain.hier/outline.glb"), "model/gltf-binary");
  EXPECT_EQ(type("/models/packed.3tz/tiles/00/000000.glb"), "model/gltf-binary");
  EXPECT_EQ(type("/"), "text/html; charset=utf-8");
  EXPECT_EQ(type("/assets/page-1a2b.js"), "text/javascript; charset=utf-8");
}

TEST_F(SiteTest, NamesOfContentAreKeptForeverAllElseIsAskedForAgain) {
  const auto cache = [&](const char* path) {
    return std::string(get(path).header("Cache-Control"));
  };
  EXPECT_EQ(cache("/assets/page-1a2b.js"), "public, max-age=31536000, immutable");
  EXPECT_EQ(cache("/"), "no-cache");
  EXPECT_EQ(cache("/models/plain.hier/tiles/00/000000.glb"), "no-cache");
}

TEST_F(SiteTest, GzipTilesAreSentWithTheirEncoding) {
  for (const char* path : {"/models/sub%20dir/zipped.hier/tiles/00/000000.glb",
                           "/models/packed.3tz/tiles/00/000000.glb"}) {
    Request tile = request(path);
    tile.accept_encoding = "gzip, deflate, br";
    const Reply reply = site_->answer(tile);
    EXPECT_EQ(reply.status, 200);
    EXPECT_EQ(reply.header("Content-Encoding"), "gzip");
    EXPECT_EQ(reply.header("Vary"), "Accept-Encoding");
    const std::string body = body_of(reply);
    const auto glb = storage::gunzip_glb(std::as_bytes(std::span(body)), "tile");
    EXPECT_EQ(std::memcmp(glb.data(), "glTF", 4), 0);
  }
  EXPECT_EQ(get("/models/plain.hier/tiles/00/000000.glb").header("Content-Encoding"), "");
  EXPECT_EQ(get("/models/packed.3tz/outline.glb").header("Content-Encoding"), "");
}

TEST_F(SiteTest, ScriptsArePackedForThoseWhoTakeThat) {
  const std::string text = body_of(get("/assets/page-1a2b.js"));
  const auto packed = storage::gzip(std::as_bytes(std::span(text)));
  std::ofstream(folder_.viewer() / "assets/page-1a2b.js.gz", std::ios::binary)
      .write(reinterpret_cast<const char*>(packed.data()), std::ssize(packed));
  Request script = request("/assets/page-1a2b.js");
  EXPECT_EQ(site_->answer(script).header("Content-Encoding"), "");
  EXPECT_EQ(site_->answer(script).header("Vary"), "Accept-Encoding");
  script.accept_encoding = "gzip";
  const Reply reply = site_->answer(script);
  EXPECT_EQ(reply.header("Content-Encoding"), "gzip");
  EXPECT_EQ(reply.header("Vary"), "Accept-Encoding");
  EXPECT_EQ(reply.header("Content-Type"), "text/javascript; charset=utf-8");
  EXPECT_EQ(body_of(reply).size(), packed.size());
  EXPECT_NE(reply.header("ETag"), get("/assets/page-1a2b.js").header("ETag"));
}

TEST_F(SiteTest, AClientWithoutGzipIsToldWhatToDo) {
  Request tile = request("/models/sub%20dir/zipped.hier/tiles/00/000000.glb");
  EXPECT_EQ(site_->answer(tile).status, 200) << "who says nothing takes anything";
  tile.accept_encoding = "identity";
  EXPECT_EQ(site_->answer(tile).status, 406);
  EXPECT_THAT(site_->answer(tile).text, HasSubstr("Accept-Encoding: gzip"));
  tile.target = "/models/plain.hier/tiles/00/000000.glb";
  EXPECT_EQ(site_->answer(tile).status, 200);
}

TEST_F(SiteTest, PartsAreServed) {
  const std::string whole = text_of(folder_.models() / "plain.hier/tiles.bin");
  Request part = request("/models/plain.hier/tiles.bin");
  part.range = "bytes=10-19";
  Reply reply = site_->answer(part);
  EXPECT_EQ(reply.status, 206);
  EXPECT_EQ(body_of(reply), whole.substr(10, 10));
  EXPECT_EQ(reply.header("Content-Range"), "bytes 10-19/" + std::to_string(whole.size()));
  part.range = "bytes=-7";
  EXPECT_EQ(body_of(site_->answer(part)), whole.substr(whole.size() - 7));
  part.range = "bytes=" + std::to_string(whole.size()) + "-";
  reply = site_->answer(part);
  EXPECT_EQ(reply.status, 416);
  EXPECT_EQ(reply.header("Content-Range"), "bytes */" + std::to_string(whole.size()));
  part.range = "bytes=0-1,3-4";
  EXPECT_EQ(body_of(site_->answer(part)), whole);
}

TEST_F(SiteTest, APartInAnArchiveIsOfTheFileInIt) {
  Request part = request("/models/packed.3tz/tiles.bin");
  part.range = "bytes=0-7";
  const Reply reply = site_->answer(part);
  EXPECT_EQ(reply.status, 206);
  EXPECT_EQ(body_of(reply), "MHTILES\n");
}

TEST_F(SiteTest, AnArchiveIsAFileToo) {
  const std::string whole = text_of(folder_.models() / "packed.3tz");
  Reply reply = get("/models/packed.3tz");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("Content-Type"), "application/vnd.maxar.archive.3tz+zip");
  EXPECT_EQ(reply.header("Accept-Ranges"), "bytes");
  EXPECT_EQ(body_of(reply), whole);
  Request part = request("/models/packed.3tz");
  part.range = "bytes=100-199";
  reply = site_->answer(part);
  EXPECT_EQ(reply.status, 206);
  EXPECT_EQ(body_of(reply), whole.substr(100, 100));
  std::ofstream(folder_.models() / "other.3tz") << "no hierarchy";
  for (const char* other : {"/models/other.3tz", "/models/none.3tz", "/models/plain.hier"})
    EXPECT_EQ(get(other).status, 404) << other;
}

TEST_F(SiteTest, APartOfAnotherVersionIsTheWholeFile) {
  Request part = request("/models/plain.hier/tiles.bin");
  part.range = "bytes=0-0";
  part.if_range = std::string(get(part.target).header("ETag"));
  EXPECT_EQ(site_->answer(part).status, 206);
  for (const char* other : {"\"another\"", "Sat, 01 Jan 2022 00:00:00 GMT", ""}) {
    part.if_range = other;
    EXPECT_EQ(site_->answer(part).status, 200) << other;
  }
}

TEST_F(SiteTest, HeadHasNoParts) {
  Request head = request("/models/plain.hier/tiles.bin");
  head.method = "HEAD";
  head.range = "bytes=0-0";
  const Reply reply = site_->answer(head);
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body_bytes(), fs::file_size(folder_.models() / "plain.hier/tiles.bin"));
}

TEST_F(SiteTest, AFileThatIsReplacedHasAnotherTag) {
  const std::string target = "/models/plain.hier/tiles/00/000000.glb";
  Request again = request(target);
  again.if_none_match = std::string(get(target).header("ETag"));
  EXPECT_EQ(site_->answer(again).status, 304);
  tests::build_small(folder_.path() / "meshes/plain.ply", folder_.models() / "plain.hier",
                     storage::Compression::none, 700);
  const Reply reply = site_->answer(again);
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(body_of(reply), text_of(folder_.models() / "plain.hier/tiles/00/000000.glb"));
}

/// The last text in a manifest.
std::string build_of(const std::string& manifest) {
  return json::parse(manifest)["checksum"];
}

TEST_F(SiteTest, AnAddressThatNamesABuildHasNoOther) {
  for (const char* model : {"plain.hier", "packed.3tz"}) {
    const std::string base = std::string("/models/") + model + "/";
    const std::string build = build_of(body_of(get(base + "hierarchy.json")));
    for (const char* file : {"tiles/00/000000.glb", "tiles.bin", "outline.glb"}) {
      const std::string target = base + file;
      const Reply reply = get(target + "?build=" + build);
      EXPECT_EQ(reply.status, 200) << target;
      EXPECT_EQ(body_of(reply), body_of(get(target)));
      EXPECT_EQ(reply.header("Cache-Control"), "public, max-age=31536000, immutable");
      const Reply other = get(target + "?build=0123456789abcdef");
      EXPECT_EQ(other.status, 409) << target;
      EXPECT_EQ(other.header("Cache-Control"), "no-store");
    }
    EXPECT_EQ(get(base + "tiles/00/000000.glb").header("Cache-Control"), "no-cache");
    tests::build_small(folder_.path() / "meshes/other.ply", folder_.models() / model,
                       storage::Compression::none, 700);
    EXPECT_EQ(get(base + "tiles/00/000000.glb?build=" + build).status, 409);
    const std::string now = build_of(body_of(get(base + "hierarchy.json")));
    EXPECT_EQ(get(base + "tiles/00/000000.glb?build=" + now).status, 200);
  }
}

TEST_F(SiteTest, ASiteIsMadeOfOneBuildOrNotAtAll) {
  const auto files = storage::make_posix_file_system();
  const auto viewer = storage::open_folder(folder_.viewer());
  const SiteJob job{storage::open_folder(folder_.models()), *viewer, folder_.path() / "site"};
  int copied = 0;
  const auto replace = [&] {
    if (++copied == 12)
      tests::build_small(folder_.path() / "meshes/other.ply", folder_.models() / "plain.hier",
                         storage::Compression::none, 700);
  };
  const SiteProgress progress{[] {}, [](const std::string&) {}, [](std::uint64_t) {}, replace};
  try {
    write_site(*files, job, progress);
    ADD_FAILURE() << "a site of two builds";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io) << error.what();
  }
  EXPECT_FALSE(fs::exists(job.output));
  write_site(*files, job, progress);
  EXPECT_TRUE(fs::exists(job.output / "models/plain.hier/hierarchy.json"));
}

TEST_F(SiteTest, TilesOfOneArchiveHaveTagsOfTheirOwn) {
  EXPECT_NE(get("/models/packed.3tz/tiles/01/000000.glb").header("ETag"),
            get("/models/packed.3tz/tiles/01/000001.glb").header("ETag"));
}

TEST_F(SiteTest, NoTrickLeadsAnywhere) {
  for (const std::string& trick : tests::kPathTricks) {
    const Reply reply = get(trick);
    EXPECT_EQ(reply.status, 404) << trick;
    EXPECT_THAT(body_of(reply), testing::Not(HasSubstr("not for you"))) << trick;
  }
}

TEST_F(SiteTest, LinksLeadNowhere) {
  const fs::path models = folder_.models();
  fs::rename(models / "plain.hier", folder_.path() / "outside.hier");
  fs::create_directory_symlink(folder_.path() / "outside.hier", models / "plain.hier");
  fs::create_directory_symlink("sub dir/zipped.hier", models / "inside.hier");
  fs::create_directory_symlink("/", models / "sub dir/root");
  fs::remove(models / "sub dir/zipped.hier/outline.glb");
  fs::create_symlink(folder_.path() / "secret.txt", models / "sub dir/zipped.hier/outline.glb");
  fs::rename(models / "packed.3tz", folder_.path() / "packed.3tz");
  fs::create_symlink(folder_.path() / "packed.3tz", models / "packed.3tz");
  fs::remove(folder_.viewer() / "assets/page-1a2b.js");
  fs::create_symlink(folder_.path() / "secret.txt", folder_.viewer() / "assets/page-1a2b.js");
  for (const char* target :
       {"/models/plain.hier/hierarchy.json", "/models/inside.hier/hierarchy.json",
        "/models/sub%20dir/zipped.hier/outline.glb", "/models/packed.3tz/hierarchy.json",
        "/models/sub%20dir/root/hierarchy.json", "/assets/page-1a2b.js"})
    EXPECT_EQ(get(target).status, 404) << target;
  EXPECT_EQ(get("/models/sub%20dir/zipped.hier/hierarchy.json").status, 200);
  EXPECT_THAT(json::parse(get("/models.json").text)["models"], SizeIs(1));
}

TEST_F(SiteTest, WorkInProgressIsNotServed) {
  const fs::path work = folder_.models() / ".new.hier.meshhier-work";
  fs::create_directory(work);
  fs::rename(folder_.models() / "plain.hier", work / "hierarchy");
  EXPECT_EQ(get("/models/.new.hier.meshhier-work/hierarchy/hierarchy.json").status, 404);
  EXPECT_THAT(json::parse(get("/models.json").text)["models"], SizeIs(2));
}

TEST_F(SiteTest, TheFolderMayBeAHierarchyItself) {
  open_as({}, storage::open_folder(folder_.models() / "plain.hier"), {});
  const json models = json::parse(get("/models.json").text)["models"];
  ASSERT_THAT(models, SizeIs(1));
  EXPECT_EQ(models[0]["path"], "models");
  EXPECT_EQ(models[0]["name"], "plain");
  EXPECT_EQ(get("/models/hierarchy.json").status, 200);
  EXPECT_EQ(get("/models/tiles/00/000000.glb").status, 200);
}

TEST_F(SiteTest, OtherMethodsAreRefused) {
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "TRACE", "CONNECT", "PRI"}) {
    Request other = request("/models/plain.hier/tiles.bin");
    other.method = method;
    const Reply reply = site_->answer(other);
    EXPECT_EQ(reply.status, 405) << method;
    EXPECT_EQ(reply.header("Allow"), "GET, HEAD, OPTIONS") << method;
  }
}

TEST_F(SiteTest, WhatIsAskedForByATagThatWentIsRefused) {
  for (const char* target : {"/models.json", "/models/plain.hier/tiles.bin", "/"}) {
    const std::string tag(get(target).header("ETag"));
    Request again = request(target);
    for (const std::string& tags : {tag, "\"a\", " + tag, std::string("*")}) {
      again.if_match = tags;
      EXPECT_EQ(site_->answer(again).status, 200) << target << tags;
    }
    for (const std::string& tags : {std::string("\"a\""), "W/" + tag, std::string()}) {
      again.if_match = tags;
      again.if_none_match = tag;
      EXPECT_EQ(site_->answer(again).status, 412) << target << tags;
    }
  }
}

TEST_F(SiteTest, NamesOfOthersAreNotAnsweredOnTheLoopback) {
  Request other = request("/models.json");
  for (const char* host : {"evil.example", "evil.example:8080", ""}) {
    other.host = host;
    EXPECT_EQ(site_->answer(other).status, 421) << host;
  }
  other.host.reset();
  EXPECT_EQ(site_->answer(other).status, 200);  // of HTTP/1.0: no browser asks so
  open({.is_loopback = false});
  other.host = "models.example";
  EXPECT_EQ(site_->answer(other).status, 200);
}

TEST_F(SiteTest, AllNamesOfTheLoopbackAreAnswered) {
  Request other = request("/models.json");
  for (const char* host : {"localhost", "127.0.0.1:8080", "127.0.0.2:8080", "[::1]:8080"}) {
    other.host = host;
    EXPECT_EQ(site_->answer(other).status, 200) << host;
  }
}

TEST_F(SiteTest, PagesOfOthersMayReadWhereThatIsAskedFor) {
  EXPECT_EQ(get("/models.json").header("Access-Control-Allow-Origin"), "");
  open({.cors = "https://a.example"});
  for (const char* target : {"/models.json", "/models/plain.hier/tiles.bin", "/nothing"})
    EXPECT_EQ(get(target).header("Access-Control-Allow-Origin"), "https://a.example") << target;
  EXPECT_THAT(std::string(get("/models.json").header("Access-Control-Expose-Headers")),
              HasSubstr("Content-Range"));
  Request preflight = request("/models/plain.hier/tiles.bin");
  preflight.method = "OPTIONS";
  const Reply reply = site_->answer(preflight);
  EXPECT_EQ(reply.status, 204);
  EXPECT_THAT(std::string(reply.header("Access-Control-Allow-Headers")), HasSubstr("Range"));
}

TEST_F(SiteTest, NothingIsGuessedFromContent) {
  for (const char* target : {"/", "/models.json", "/nothing", "/models/plain.hier/tiles.bin"})
    EXPECT_EQ(get(target).header("X-Content-Type-Options"), "nosniff") << target;
}

TEST_F(SiteTest, WithoutThePageAllElseIsServed) {
  open_as({.missing_viewer = "run npm"}, storage::open_folder(folder_.models()), {});
  EXPECT_EQ(get("/").status, 503);
  EXPECT_EQ(get("/").text, "run npm\n");
  EXPECT_EQ(get("/assets/page-1a2b.js").status, 404);
  EXPECT_EQ(get("/models.json").status, 200);
  EXPECT_EQ(get("/models/plain.hier/tiles.bin").status, 200);
}

TEST_F(SiteTest, ADamagedArchiveIsLeftOutAndToldOnce) {
  const fs::path archive = folder_.models() / "packed.3tz";
  fs::resize_file(archive, fs::file_size(archive) - 1);
  EXPECT_EQ(get("/models/packed.3tz/hierarchy.json").status, 404);
  EXPECT_THAT(json::parse(get("/models.json").text)["models"], SizeIs(2));
  EXPECT_EQ(get("/models/packed.3tz/hierarchy.json").status, 404);
  EXPECT_THAT(told_,
              testing::UnorderedElementsAre(HasSubstr("packed.3tz"), HasSubstr("broken.hier")));
}

TEST_F(SiteTest, WhatPeopleSayOfModelsIsListed) {
  tests::write_text(folder_.models() / "gallery.json",
                    R"({"models": {"packed.3tz": {"title": "Packed", "tags": ["a", "b"]},
                                   "sub dir/zipped.hier": {"folder": "Other", "place": [7, 50]},
                                   "gone.hier": {}}})");
  site_->refresh();
  const json models = json::parse(get("/models.json").text)["models"];
  EXPECT_EQ(models[0]["title"], "Packed");
  EXPECT_EQ(models[0]["name"], "packed");
  EXPECT_EQ(models[0]["tags"], json({"a", "b"}));
  EXPECT_FALSE(models[1].contains("title"));
  EXPECT_EQ(models[2]["folder"], "Other");
  EXPECT_EQ(models[2]["place"], json({7.0, 50.0}));
  EXPECT_THAT(told_, testing::Contains(HasSubstr("gone.hier: there is no such model")));
  const json part = json::parse(get("/models.json?count=1&search=packed").text);
  EXPECT_EQ(part["found"], 1);
  EXPECT_EQ(part["models"][0]["path"], "models/packed.3tz/");
  const json one = json::parse(get("/models.json?count=1&path=models%2Fpacked.3tz%2F").text);
  EXPECT_EQ(one["models"], part["models"]);
  EXPECT_EQ(get("/models/gallery.json").status, 404);
  tests::write_text(folder_.models() / "gallery.json", "{");
  site_->refresh();
  EXPECT_FALSE(json::parse(get("/models.json").text)["models"][0].contains("title"));
  EXPECT_THAT(told_, testing::Contains(HasSubstr("gallery.json: line 1")));
}

TEST_F(SiteTest, PartsThatNameAListingAreOfIt) {
  const std::string state = json::parse(get("/models.json?count=1").text)["state"];
  fs::remove_all(folder_.models() / "plain.hier");
  EXPECT_EQ(json::parse(get("/models.json?count=9&state=" + state).text)["found"], 3);
  site_->refresh();
  const json now = json::parse(get("/models.json?count=9").text);
  EXPECT_EQ(now["found"], 2);
  EXPECT_NE(now["state"], state);
  EXPECT_EQ(json::parse(get("/models.json?count=9&state=" + state).text)["state"], now["state"]);
}

TEST(GalleryTest, TheDiskIsAskedOnceASecond) {
  const tests::ServedFolder folder;
  Hierarchies hierarchies(storage::open_folder(folder.models()), [](const std::string&) {});
  auto now = std::chrono::steady_clock::time_point();
  Gallery gallery(hierarchies, [&] { return now; });
  EXPECT_THAT(gallery.catalogue()->models(), SizeIs(3));
  fs::remove_all(folder.models() / "plain.hier");
  now += std::chrono::milliseconds(999);
  EXPECT_THAT(gallery.catalogue()->models(), SizeIs(3));
  now += std::chrono::milliseconds(1);
  EXPECT_THAT(gallery.catalogue()->models(), SizeIs(2));
  fs::remove_all(folder.models() / "packed.3tz");
  gallery.refresh();
  EXPECT_THAT(gallery.catalogue()->models(), SizeIs(1));
}

}  // namespace
}  // namespace meshhier::server
