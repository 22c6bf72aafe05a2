// Inputs of a build: meshes, configs, settings, and files that they name.
#include "tests/app/command_line.h"
#include "tests/app/small_picture.h"
#include "tests/support/gzip.h"
#include "tests/support/zip_archive.h"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A triangle with a library and a picture (one red texel) of its own.
class WithCompanions : public CommandLine {
 protected:
  WithCompanions() {
    write_text(work() / "a.obj",
               "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
               "f 1/1 2/2 3/3\n");
    write_library("a.png");
    write_picture(work() / "a.png");
  }
  void write_library(const std::string& picture) const {
    write_text(work() / "a.mtl", "newmtl m\nmap_Kd " + picture + '\n');
  }
  std::uint64_t texels() const {
    const json manifest = json::parse(text_of(Path(hierarchy()) / "hierarchy.json"));
    return manifest["source"].contains("textures")
               ? manifest["source"]["textures"]["texels"].get<std::uint64_t>()
               : 0;
  }
  std::string obj() const { return (work() / "a.obj").string(); }
};

TEST_F(WithCompanions, WhatAMeshNamesIsNotReplacedByAnAccount) {
  const auto before = contents(work());
  for (const char* option : {"--stats", "--input-note"}) {
    for (const char* name : {"a.mtl", "a.png", "a.obj"}) {
      const Outcome outcome = run({"build", obj(), "--force", option, (work() / name).string()});
      EXPECT_EQ(outcome.code, kUsage) << outcome.messages;
      EXPECT_THAT(outcome.messages, HasSubstr("it would replace " + (work() / name).string()));
      EXPECT_EQ(contents(work()), before) << option << ' ' << name;
    }
  }
  std::filesystem::create_symlink("a.png", work() / "link");
  EXPECT_EQ(run({"build", obj(), "--force", "--stats", (work() / "link").string()}).code, kUsage);
  EXPECT_EQ(run({"build", obj(), "--stats", (work() / "s.json").string()}).code, 0);
  EXPECT_EQ(texels(), 1U);
}

TEST_F(WithCompanions, AnOutputThatHoldsWhatAMeshNamesIsNotReplaced) {
  ASSERT_EQ(run({"build", obj()}).code, 0);
  write_picture(Path(hierarchy()) / "tiles/a.png");
  write_library("a.hier/tiles/a.png");
  const Outcome outcome = run({"build", obj(), "--force"});
  EXPECT_NE(outcome.code, 0);
  EXPECT_TRUE(std::filesystem::exists(Path(hierarchy()) / "tiles/a.png"));
}

TEST_F(CommandLine, ALinkOnTheWayToAnInputIsNotFollowed) {
  std::filesystem::create_directory(work() / "secret");
  std::filesystem::create_directory_symlink("secret", work() / "house");
  write_text(work() / "secret/a.off", "OFF\nroot:x:secret");
  write_text(work() / "secret/shadow", "root:x:secret");
  for (const char* name : {"house/a.off", "house/shadow"}) {
    for (const Arguments& guard : {Arguments{"--no-links"}, {"--within", work().string()}}) {
      Arguments arguments{"build", (work() / name).string()};
      arguments.insert(arguments.end(), guard.begin(), guard.end());
      const Outcome outcome = run(arguments);
      EXPECT_EQ(outcome.code, kIo) << name;
      EXPECT_THAT(outcome.messages, AllOf(HasSubstr("house is a link"), Not(HasSubstr("root:"))));
    }
  }
  const Outcome outside =
      run({"build", (work() / "secret/a.off").string(), "--within", (work() / "house").string()});
  EXPECT_EQ(outside.code, kIo);
  EXPECT_THAT(outside.messages, AllOf(HasSubstr("does not lie in"), Not(HasSubstr("root:"))));
  EXPECT_EQ(run({"build", "a.ply", "--no-links", "--within", "."}).code, kUsage);
}

TEST_F(WithCompanions, WhatLiesElsewhereIsMissing) {
  std::filesystem::create_directory(work() / "in");
  for (const char* name : {"a.obj", "a.mtl"})
    std::filesystem::rename(work() / name, work() / "in" / name);
  const auto built = [&](const std::string& picture, const Arguments& guard) {
    write_text(work() / "in/a.mtl", "newmtl m\nmap_Kd " + picture + '\n');
    Arguments arguments{"build", (work() / "in/a.obj").string(), "-o", hierarchy(), "--force",
                        "--set", "missing_images=ignore"};
    arguments.insert(arguments.end(), guard.begin(), guard.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    return texels();
  };
  const Arguments within{"--within", (work() / "in").string()};
  EXPECT_EQ(built("../a.png", {}), 1U);
  EXPECT_EQ(built("../a.png", {"--no-links"}), 1U);
  EXPECT_EQ(built("../a.png", within), 0U);
  EXPECT_EQ(built((work() / "a.png").string(), within), 0U);
  std::filesystem::create_directory_symlink("..", work() / "in/up");
  EXPECT_EQ(built("up/a.png", {}), 1U);
  EXPECT_EQ(built("up/a.png", {"--no-links"}), 0U);
  EXPECT_EQ(built("up/a.png", within), 0U);
  std::filesystem::rename(work() / "a.png", work() / "in/a.png");
  EXPECT_EQ(built("a.png", within), 1U);
}

TEST_F(CommandLine, ABuildThatFailsLeavesNoAccount) {
  write_mesh("a.ply", 2500);  // no such vertex
  const Outcome outcome =
      run({"build", write_config(), "--stats", (work() / "stats.json").string()});
  EXPECT_EQ(outcome.code, kInput);
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(CommandLine, SetTakesSeveralSettingsInAnyPlace) {
  write_mesh("a.ply");
  const std::string config = write_config();
  const std::string output = "output=" + (work() / "b.hier").string();
  const std::vector<Arguments> forms{
      {"build", config, "--set", "partition.count=3", output},
      {"build", config, "--set", "partition.count=3", "--set", output},
      {"build", "--set", "partition.count=3", output, config},
      {"build", "--set", "partition.count=3", "--set", output, "--force", config}};
  for (const Arguments& arguments : forms) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    const Outcome inspected = run({"inspect", (work() / "b.hier").string(), "--json"});
    EXPECT_EQ(json::parse(inspected.out).at("partitions").at("count"), 3);
    std::filesystem::remove_all(work() / "b.hier");
  }
}

TEST_F(CommandLine, AMeshIsEnough) {
  const std::string mesh = write_mesh("a.ply").string();
  const Outcome made = run({"build", mesh, "--set", "partition.vertices=500"});
  ASSERT_EQ(made.code, 0) << made.messages;
  EXPECT_EQ(names(), (std::set<std::string>{"a.hier", "a.ply"}));
  const auto by_mesh = contents(hierarchy());
  EXPECT_EQ(run({"build", mesh}).code, kExists);
  EXPECT_EQ(run({"build", write_config(), "--force", "--set", "preview=true"}).code, 0);
  EXPECT_EQ(contents(hierarchy()), by_mesh);
  EXPECT_EQ(run({"build", "--set", "partition.vertices=500", "--force", mesh}).code, 0);
  EXPECT_EQ(run({"build", "--force", "--set", "partition.vertices=500", mesh}).code, 0);
  EXPECT_EQ(contents(hierarchy()), by_mesh);
}

TEST_F(CommandLine, AMeshIsKnownByItsContent) {
  const Path mesh = write_mesh("b.dat");
  ASSERT_EQ(run({"build", mesh.string()}).code, 0);
  std::filesystem::rename(mesh, work() / "mesh.obj.gz");
  ASSERT_EQ(run({"build", (work() / "mesh.obj.gz").string()}).code, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"b.dat.hier", "mesh.hier", "mesh.obj.gz"}));
}

TEST_F(CommandLine, TheOutputIsNamedByO) {
  const std::string mesh = write_mesh("a.ply").string();
  ASSERT_EQ(run({"build", mesh, "-o", (work() / "new" / "x.hier").string()}).code, 0);
  EXPECT_TRUE(std::filesystem::is_directory(work() / "new" / "x.hier"));
  const std::string archive = (work() / "x.3tz").string();
  ASSERT_EQ(run({"build", mesh, "--output", archive}).code, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(archive));
  ASSERT_EQ(run({"build", mesh, "--set", "storage.container=3tz"}).code, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(work() / "a.3tz"));
  ASSERT_EQ(run({"build", write_config(), "-o", (work() / "y.3tz").string()}).code, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(work() / "y.3tz"));
  EXPECT_FALSE(std::filesystem::exists(hierarchy()));
}

TEST_F(CommandLine, SeveralMeshesAreJoinedUnderAName) {
  const std::string mesh = write_mesh("a.ply").string();
  const std::string other = write_mesh("b.ply").string();
  const Outcome nameless = run({"build", mesh, other});
  EXPECT_EQ(nameless.code, kUsage);
  EXPECT_THAT(nameless.messages, HasSubstr("name it by -o"));
  ASSERT_EQ(run({"build", mesh, other, "-o", hierarchy()}).code, 0);
  EXPECT_EQ(run({"verify", hierarchy(), "--input", mesh, "--input", other}).code, 0);
  const std::string output = "output=" + hierarchy();
  EXPECT_EQ(run({"build", mesh, "--force", "--set", "weld=true", output, other}).code, 0);
  EXPECT_EQ(run({"verify", hierarchy(), "--input", mesh, "--input", other}).code, 0);
}

TEST_F(CommandLine, AKeyIsGivenOnce) {
  const std::string mesh = write_mesh("a.ply").string();
  const std::vector<Arguments> twice{
      {"build", mesh, "-o", "x.hier", "--set", "output=y.hier"},
      {"build", mesh, "--set", "input=" + mesh},
      {"build", mesh, write_config(), "-o", "x.hier"},
  };
  for (const Arguments& arguments : twice)
    EXPECT_EQ(run(arguments).code, kUsage) << ::testing::PrintToString(arguments);
  EXPECT_THAT(run(twice[0]).messages, HasSubstr("-o: \"output\" is given by --set as well"));
  EXPECT_EQ(names(), (std::set<std::string>{"a.json", "a.ply"}));
}

TEST_F(CommandLine, WhatIsNeitherAMeshNorAConfigIsToldSo) {
  write_text(work() / "a.txt", "Dear Sir,");
  const Outcome letter = run({"build", (work() / "a.txt").string()});
  EXPECT_EQ(letter.code, kUsage);
  EXPECT_THAT(letter.messages,
              HasSubstr("expected a mesh (PLY, OBJ, glTF, STL, OFF, OSGB, GeoTIFF, "
                        "SRTM or ESRI ASCII, perhaps in gzip) "
                        "or a config (JSON), found 'Dear Sir,'"));
  write_text(work() / "a.ply", "Dear Sir,");
  const Outcome ply = run({"build", (work() / "a.ply").string()});
  EXPECT_EQ(ply.code, kInput);
  EXPECT_THAT(ply.messages, HasSubstr("expected a mesh"));
  const Outcome folder = run({"build", work().string()});
  EXPECT_EQ(folder.code, kIo);
  EXPECT_THAT(folder.messages, AllOf(HasSubstr("is a folder; name the mesh in it"),
                                     HasSubstr("odm_texturing/odm_textured_model_geo.obj (an ODM "
                                               "project) or tileset.json (3D Tiles)")));
  write_text(work() / "a.json", "{");
  EXPECT_THAT(run({"build", (work() / "a.json").string()}).messages,
              AllOf(HasSubstr("line 1, column"), Not(HasSubstr("json.exception"))));
}

class OdmProject : public WithCompanions {
 protected:
  OdmProject() {
    for (const char* folder : {"odm/odm_texturing", "odm/odm_georeferencing"})
      std::filesystem::create_directories(work() / folder);
    for (const char* name : {"a.mtl", "a.png"})
      std::filesystem::rename(work() / name, work() / "odm/odm_texturing" / name);
    std::filesystem::rename(obj(), model());
  }
  Path model() const { return work() / "odm/odm_texturing/odm_textured_model_geo.obj"; }
  void write_map(const std::string& name, const std::string& text) const {
    write_text(work() / "odm/odm_georeferencing" / name, text);
  }
  /// Builds a folder; returns the account.
  std::string built(const std::string& folder = "odm/") const {
    const Outcome outcome =
        run({"build", (work() / folder).string(), "-o", hierarchy(), "--force"});
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    return outcome.out;
  }
};

TEST_F(OdmProject, StandsWhereItsCoordinatesSay) {
  write_map("coords.txt", "WGS84 UTM 32N\n512345 5401234\n1.5 2.5 3.5\n");
  EXPECT_THAT(built(), HasSubstr("placed by WGS 84 / UTM zone 32N at longitude 9.16"));
  EXPECT_EQ(texels(), 1U);
  EXPECT_EQ(json::parse(text_of(Path(hierarchy()) / "hierarchy.json"))["up"], "z");
  EXPECT_EQ(run({"verify", hierarchy(), "--input", (work() / "odm").string()}).code, 0);
  EXPECT_THAT(built("odm/odm_texturing"), HasSubstr("UTM zone 32N at longitude 9.16"));
  EXPECT_EQ(run({"build", (work() / "odm/").string()}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(work() / "odm.hier"));
}

TEST_F(OdmProject, TakesTheProjectionAndTheOffsetFromTwoFiles) {
  write_map("odm_georeferencing_model_geo.txt", "512345 5401234\n");
  EXPECT_THAT(run({"build", (work() / "odm").string(), "--dry-run"}).messages,
              HasSubstr("has an offset, but no CRS"));
  write_map("proj.txt", "+proj=utm +zone=32 +datum=WGS84 +units=m +no_defs\n");
  EXPECT_THAT(built(), HasSubstr("at longitude 9.16"));
}

TEST_F(OdmProject, WithoutCoordinatesIsNowhere) {
  EXPECT_THAT(built(), Not(HasSubstr("placed")));
  write_map("coords.txt", "WGS84 UTM 32N\n512345 5401234\n");
  std::filesystem::rename(model(), work() / "odm/odm_texturing/odm_textured_model.obj");
  EXPECT_THAT(built(), Not(HasSubstr("placed"))) << "its coordinates are of no map";
}

TEST_F(CommandLine, AFolderWithoutANameNeedsAnOutput) {
  for (const char* folder : {".", "./", "..", "/"})
    EXPECT_THAT(run({"build", folder}).messages, HasSubstr("name the output by -o")) << folder;
}

TEST_F(CommandLine, WhatStandsBehindTwoDashesIsAFileWhateverStandsBefore) {
  write_mesh("-a.ply");
  const Path before = std::filesystem::current_path();
  std::filesystem::current_path(work());
  EXPECT_EQ(run({"build", "-o", "a.hier", "--set", "preview=false", "--", "-a.ply"}).code, 0);
  EXPECT_EQ(run({"build", "-o", "a.hier", "--force", "--", "-a.ply"}).code, 0);
  std::filesystem::current_path(before);
}

TEST_F(CommandLine, ADamagedManifestIsToldWithoutTheParsersName) {
  build();
  write_text(work() / "a.hier" / "hierarchy.json", "{\"a\": ]");
  EXPECT_THAT(run({"inspect", hierarchy()}).messages,
              AllOf(HasSubstr("is not valid JSON: line 1"), Not(HasSubstr("json.exception"))));
}

/// Returns an archive of a tileset with one triangle of one glTF.
std::string town(const std::string& x) {
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,)"
      R"("translation":[)" +
      x +
      R"(,0,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":)"
      R"("data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  return tests::zip_of({{"tileset.json", R"({"asset":{"version":"1.0"},"geometricError":1,"root":)"
                                         R"({"geometricError":0,"content":{"uri":"a.gltf"},)"
                                         R"("boundingVolume":{"sphere":[0,0,0,9]}}})"},
                        {"a.gltf", gltf, 8}});
}

TEST_F(CommandLine, AnUpdateReadsATouchedArchiveAndBuildsAChangedOne) {
  const Path archive = work() / "a.3tz";
  write_text(archive, town("0"));
  const auto is_up_to_date = [&] {
    const Outcome outcome =
        run({"build", archive.string(), "-o", hierarchy(), "--update", "--set", "preview=false"});
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    return outcome.out.ends_with(" is up to date\n");
  };
  EXPECT_FALSE(is_up_to_date());
  write_text(archive, town("0"));
  EXPECT_TRUE(is_up_to_date()) << "written anew with what it held";
  EXPECT_TRUE(is_up_to_date());
  write_text(archive, town("5"));
  EXPECT_FALSE(is_up_to_date());
  EXPECT_TRUE(is_up_to_date());
}

TEST_F(CommandLine, SeveralArchivesAreJoinedAndAHierarchyIsTheOutput) {
  write_text(work() / "a.3tz", town("0"));
  write_text(work() / "b.3tz", town("5"));
  const std::string a = (work() / "a.3tz").string(), b = (work() / "b.3tz").string();
  ASSERT_EQ(run({"build", a, b, "-o", hierarchy()}).code, 0);
  EXPECT_EQ(run({"verify", hierarchy(), "--input", a, "--input", b}).code, 0);
  EXPECT_THAT(run({"inspect", hierarchy()}).out, HasSubstr("2 triangles"));
  const std::string made = (work() / "made.3tz").string();
  ASSERT_EQ(run({"build", a, "-o", made}).code, 0);
  for (const std::string& output : {made, (work() / "new.3tz").string()}) {
    const Outcome outcome = run({"build", a, output});
    EXPECT_EQ(outcome.code, kUsage);
    EXPECT_THAT(outcome.messages, HasSubstr("the output is named by -o"));
  }
}

}  // namespace
}  // namespace meshhier::app
