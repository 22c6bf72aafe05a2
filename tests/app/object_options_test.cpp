// Objects on the command line: --object, --where, and what exports keep of them.
#include "storage/format/layout.h"
#include "support/named_boxes.h"
#include "tests/app/command_line.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::app {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kStreets = 8, kHouses = 25;

/// Boxes in rows, ten triangles each; every fifth house has no owner.
class ObjectOptions : public CommandLine {
 protected:
  static std::string name_of(int street, int house) {
    return fmt::format("street {}/house {:02}", street, house);
  }
  static int height_of(int street, int house) { return 3 + (street * 7 + house * 5) % 20; }

  /// `moved`: the name of a house that stands 3 lower and `renamed` of one with another name.
  static std::string obj_of_city(const std::string& moved = "", const std::string& renamed = "") {
    std::string obj;
    for (int street = 0; street < kStreets; ++street) {
      for (int house = 0; house < kHouses; ++house) {
        const std::string name = name_of(street, house);
        obj += "o " + name + (name == renamed ? " new\n" : "\n");
        const int low = name == moved ? -3 : 0;
        for (int corner = 0; corner < 8; ++corner) {
          const int up = corner / 4, along = (corner + 1) / 2 % 2, across = corner / 2 % 2;
          obj += fmt::format("v {} {} {}\n", 10 * house + 6 * along,
                             low + up * height_of(street, house), 20 * street + 8 * across);
        }
        obj += "f -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\nf -4 -3 -2 -1\n";
      }
    }
    return obj;
  }

  void build_city(const std::string& more = "") const {
    std::string csv = "name,height,listed,built,owner\n";
    for (int street = 0; street < kStreets; ++street) {
      for (int house = 0; house < kHouses; ++house) {
        const std::string name = name_of(street, house);
        csv += fmt::format("{},{},{},19{:02}-01-02,{}\n", name, height_of(street, house),
                           house % 2 == 0, house,
                           house % 5 == 0 ? "" : fmt::format("owner {}", house % 3));
      }
    }
    write_text(work() / "city.obj", obj_of_city());
    write_text(work() / "city.csv", csv);
    Arguments arguments{"build",
                        (work() / "city.obj").string(),
                        "--object-table",
                        (work() / "city.csv").string(),
                        "-o",
                        city(),
                        "--set",
                        "partition.vertices=100",
                        "simplify.vertices=100",
                        "preview=false"};
    if (!more.empty())
      arguments.push_back(more);
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
  }

  std::string city() const { return (work() / "city.hier").string(); }
  std::string file(const std::string& name) const { return (work() / name).string(); }

  Outcome export_to(const std::string& name, const Arguments& more) const {
    Arguments arguments{"export", city(), "-o", file(name), "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  std::map<std::string, json> listed(const std::string& hierarchy, Arguments more = {}) const {
    Arguments arguments{"inspect", hierarchy, "--objects", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.messages;
    std::map<std::string, json> rows;
    std::istringstream lines(outcome.out);
    for (std::string line; std::getline(lines, line);) {
      json row = json::parse(line);
      std::string name = row.at("name");
      rows.emplace(std::move(name), std::move(row));
    }
    return rows;
  }
};

TEST_F(ObjectOptions, NamesAreFoundByTheirWords) {
  tests::write_named_boxes(work() / "boxes.obj", 300);
  const std::string made = file("boxes.hier");
  ASSERT_EQ(run({"build", file("boxes.obj"), "-o", made}).code, 0);
  const auto words = storage::object_words_path(made);
  ASSERT_TRUE(std::filesystem::exists(words));
  EXPECT_THAT(run({"inspect", made, "--find", "BOX 299"}).out, HasSubstr("/box 299  10 triangles"));
  EXPECT_EQ(run({"inspect", made, "--find", "box 999"}).out, "");
  EXPECT_EQ(run({"inspect", made, "--find", "box 299", "--where", "height > 100"}).out, "");
  EXPECT_EQ(run({"inspect", made, "--find", " - "}).code, kUsage);
  EXPECT_EQ(run({"inspect", made, "--where", "height > 1"}).code, kUsage);
  EXPECT_THAT(run({"verify", made}).out, HasSubstr("object words: "));
  std::fstream(words, std::ios::in | std::ios::out | std::ios::binary).seekp(100).put('~');
  const Outcome damaged = run({"verify", made});
  EXPECT_EQ(damaged.code, kCorrupt);
  EXPECT_THAT(damaged.out, HasSubstr("object_words.bin"));
}

TEST_F(ObjectOptions, ExportTakesObjectsByName) {
  build_city();
  const auto said = [&](const Arguments& more) { return export_to("x.ply", more).out; };
  const Arguments finest{"--error", "0"};
  const auto with = [&](Arguments more) {
    more.insert(more.begin(), finest.begin(), finest.end());
    return more;
  };
  EXPECT_THAT(said(with({"--object", name_of(2, 3)})), HasSubstr("10 triangles"));
  EXPECT_THAT(said(with({"--object", "street 2/"})), HasSubstr("250 triangles"));
  EXPECT_THAT(
      said(with({"--object", "street 2/", "--object", name_of(2, 3), "--object", "street 4/"})),
      HasSubstr("500 triangles"));
  EXPECT_THAT(said(with({"--object", "street 2/", "--where", "height > 12"})),
              Not(HasSubstr("250 triangles")));
  EXPECT_THAT(said(with({"--object", "street 2/", "--box", "0,0,0", "27,99,999"})),
              HasSubstr("30 triangles"))
      << "three houses of a street touch the box";
  EXPECT_THAT(said(with({"--object", name_of(2, 3)})), Not(HasSubstr("16 of 16")))
      << "tiles elsewhere are not read";

  const Outcome unknown = export_to("y.ply", with({"--object", "street 2/house 99"}));
  EXPECT_EQ(unknown.code, kUsage);
  EXPECT_THAT(unknown.messages, HasSubstr("no object \"street 2/house 99\"; did you mean"));
  EXPECT_THAT(export_to("y.ply", with({"--object", "street 2"})).messages,
              HasSubstr("with a \"/\" behind it, it is a branch"));
  EXPECT_EQ(export_to("y.ply", with({"--object", "street 9/"})).code, kUsage);
  EXPECT_EQ(export_to("y.ply", {"--outline", "--object", "street 2/"}).code, kUsage);
  EXPECT_FALSE(std::filesystem::exists(file("y.ply")));
}

TEST_F(ObjectOptions, ExportTakesObjectsByConditions) {
  build_city();
  int high = 0;
  for (int street = 0; street < kStreets; ++street) {
    for (int house = 0; house < kHouses; ++house)
      high += height_of(street, house) > 12 && house % 5 != 0 ? 1 : 0;
  }
  const std::string where = "height > 12 and owner is not null";
  EXPECT_EQ(listed(city(), {"--where", where}).size(), static_cast<std::size_t>(high));
  EXPECT_THAT(export_to("x.ply", {"--error", "0", "--where", where}).out,
              HasSubstr(fmt::format("{} triangles", 10 * high)));
  for (const char* name : {"x.obj", "x.glb"}) {
    EXPECT_THAT(export_to(name, {"--error", "0", "--where", where}).out,
                HasSubstr(fmt::format("{} triangles", 10 * high)));
  }
  EXPECT_THAT(export_to("x.ply", {"--node", "0/0", "--where", where}).out,
              HasSubstr("tile 0/0, objects"));
  const Outcome none = export_to("none.ply", {"--error", "0", "--where", "height > 100"});
  EXPECT_EQ(none.code, kUsage);
  EXPECT_THAT(none.messages, HasSubstr("no object meets the condition"));
  const Outcome wrong = export_to("none.ply", {"--error", "0", "--where", "hieght > 100"});
  EXPECT_EQ(wrong.code, kUsage);
  EXPECT_THAT(wrong.messages, HasSubstr("--where: at character 1: objects have no \"hieght\" (did "
                                        "you mean \"height\"?)"));
  EXPECT_FALSE(std::filesystem::exists(file("none.ply")));
  EXPECT_TRUE(listed(city(), {"--where", "height > 100"}).empty());
  EXPECT_EQ(run({"inspect", city(), "--where", "height > 1"}).code, kUsage) << "needs --objects";
}

TEST_F(ObjectOptions, MeshesWithoutObjectsHaveNoneToAskFor) {
  build();
  const Outcome outcome =
      run({"export", hierarchy(), "--level", "0", "-o", file("x.ply"), "--object", "house"});
  EXPECT_EQ(outcome.code, kUsage);
  EXPECT_THAT(outcome.messages, HasSubstr("has no objects"));
}

TEST_F(ObjectOptions, PicturesShowAskedObjects) {
  build_city();
  const auto draw = [&](const std::string& name, Arguments more) {
    Arguments arguments{"preview", city(), "-o", file(name), "--size", "64x64", "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  EXPECT_EQ(draw("a.png", {}).code, 0);
  const Outcome one = draw("b.png", {"--object", name_of(2, 3), "--error", "0"});
  EXPECT_EQ(one.code, 0) << one.messages;
  EXPECT_THAT(one.out, HasSubstr(" of 16 tiles"));
  EXPECT_NE(text_of(file("a.png")), text_of(file("b.png")));
  EXPECT_EQ(draw("c.png", {"--where", "height > 99"}).code, kUsage);
  const Outcome raster = run({"export", city(), "--dsm", file("d.tif"), "--gsd", "1", "--object",
                              name_of(2, 3), "--error", "0"});
  EXPECT_EQ(raster.code, 0) << raster.messages;
  EXPECT_THAT(raster.out, HasSubstr("d.tif: 6 x 8 pixels of 1, 100.0 % of them covered"));
}

json without_numbers(std::map<std::string, json> rows) {
  json plain;
  for (auto& [name, row] : rows) {
    row.erase("object");
    plain[name] = row;
  }
  return plain;
}

TEST_F(ObjectOptions, ExportedObjHasNamedObjects) {
  build_city();
  ASSERT_EQ(export_to("out.obj", {"--error", "0"}).code, 0);
  std::map<std::string, int> faces;
  std::string now;
  std::istringstream lines(text_of(file("out.obj")));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("o ")) {
      now = line.substr(2);
      EXPECT_FALSE(faces.contains(now)) << "each name stands once";
    }
    EXPECT_FALSE(line.starts_with("g ")) << "tiles are no groups then";
    faces[now] += line.starts_with("f ") ? 1 : 0;
  }
  EXPECT_EQ(faces.size(), static_cast<std::size_t>(kStreets * kHouses + 1));
  EXPECT_EQ(faces[""], 0);
  EXPECT_EQ(faces[name_of(7, 24)], 10);
  ASSERT_EQ(
      run({"build", file("out.obj"), "-o", file("again.hier"), "--object-table", file("city.csv")})
          .code,
      0);
  EXPECT_EQ(without_numbers(listed(file("again.hier"))), without_numbers(listed(city())))
      << "names, values, areas and boxes come back";
}

TEST_F(ObjectOptions, HierarchiesOfPiecesKeepObjects) {
  build_city();
  for (const char* name : {"piece.hier", "piece.3tz"}) {
    const Outcome outcome = export_to(name, {"--error", "0", "--object", "street 2/"});
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
    auto wanted = listed(city());
    std::erase_if(wanted, [](const auto& row) { return !row.first.starts_with("street 2/"); });
    EXPECT_EQ(without_numbers(listed(file(name))), without_numbers(wanted));
    const auto attributes_of = [&](const std::string& hierarchy) {
      return json::parse(run({"inspect", hierarchy, "--json"}).out).at("source").at("attributes");
    };
    EXPECT_EQ(attributes_of(file(name)), attributes_of(city()))
        << "the numbers that objects had are no value of their own";
    EXPECT_EQ(run({"verify", file(name)}).code, 0);
  }
  const Outcome again = run({"export", file("piece.3tz"), "--level", "0", "-o", file("small.hier"),
                             "--where", "height > 12"});
  EXPECT_EQ(again.code, 0) << again.messages;
  for (const auto& [name, row] : listed(file("small.hier")))
    EXPECT_GT(row.at("properties").at("height"), 12) << name;
}

TEST_F(ObjectOptions, TablesOfOtherBuildsAreRefused) {
  build_city();
  ASSERT_EQ(run({"build", file("city.obj"), "-o", file("bare.hier")}).code, 0);
  std::filesystem::copy_file(file("bare.hier/objects.bin"), file("city.hier/objects.bin"),
                             std::filesystem::copy_options::overwrite_existing);
  for (const char* name : {"piece.hier", "piece.obj", "piece.glb"})
    EXPECT_EQ(export_to(name, {"--error", "0"}).code, kCorrupt) << name;
}

TEST_F(ObjectOptions, ExportedPlyTakesNamesFromTheTable) {
  build_city();
  ASSERT_EQ(export_to("piece.ply", {"--object", "street 2/"}).code, 0);  // of the original
  const auto build_with = [&](const std::string& from) {
    return run({"build", file("piece.ply"), "-o", file("b.hier"), "--force", "--objects", from,
                "--object-table", city() + "/objects.bin"});
  };
  const Outcome built = build_with("label:object");
  ASSERT_EQ(built.code, 0) << built.messages;
  EXPECT_EQ(listed(file("b.hier")).size(), static_cast<std::size_t>(kHouses));
  EXPECT_EQ(
      run({"verify", file("b.hier"), "--input", file("piece.ply"), city() + "/objects.bin"}).code,
      0);
  EXPECT_EQ(build_with("file").code, kInput) << "a file's name is no number of a row";
}

TEST_F(ObjectOptions, ExportedGlbHasATableOfObjects) {
  build_city();
  ASSERT_EQ(export_to("out.glb", {"--error", "0", "--object", "street 2/"}).code, 0);
  const std::string glb = text_of(file("out.glb"));
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, glb.data() + 12, sizeof bytes);
  const json document = json::parse(glb.substr(20, bytes));
  const json& metadata = document.at("extensions").at("EXT_structural_metadata");
  const json& table = metadata.at("propertyTables").at(0);
  EXPECT_EQ(table.at("count"), kHouses);
  EXPECT_THAT(document.at("extensionsUsed"),
              ElementsAre("EXT_mesh_features", "EXT_structural_metadata"));
  EXPECT_EQ(metadata.at("schema").at("classes").at("object").at("properties").size(), 6u);
  const json& names = document.at("bufferViews")
                          .at(table.at("properties").at("name").at("values").get<std::size_t>());
  const std::string bin = glb.substr(28 + bytes);
  EXPECT_EQ(bin.substr(names.at("byteOffset"), name_of(2, 0).size()), name_of(2, 0));
  EXPECT_EQ(names.at("byteLength"), kHouses * name_of(2, 0).size());
  for (const json& primitive : document.at("meshes").at(0).at("primitives")) {
    EXPECT_TRUE(primitive.at("attributes").contains("_FEATURE_ID_0"));
    EXPECT_EQ(primitive.at("extensions")
                  .at("EXT_mesh_features")
                  .at("featureIds")
                  .at(0)
                  .at("propertyTable"),
              0);
  }
  ASSERT_EQ(run({"build", file("out.glb"), "-o", file("again.hier")}).code, 0);
  const auto again = listed(file("again.hier"));
  EXPECT_EQ(again.size(), static_cast<std::size_t>(kHouses));
  EXPECT_EQ(again.at(name_of(2, 3)).at("properties").at("height"), height_of(2, 3));
}

TEST_F(ObjectOptions, PicturesAreColouredByProperties) {
  build_city();
  const auto draw = [&](Arguments more) {
    more.insert(more.begin(),
                {"preview", city(), "-o", file("a.png"), "--size", "64x64", "--force"});
    return run(more);
  };
  EXPECT_THAT(draw({"--colour-by", "height"}).out, HasSubstr("\nheight: from 3 (#440154) to 22 ("));
  const Outcome owners = draw({"--colour-by", "owner"});
  EXPECT_THAT(owners.out, HasSubstr("owner 0 ("));
  EXPECT_THAT(owners.out, HasSubstr("grey     no value (40 objects)"));
  EXPECT_EQ(draw({"--colour-by", "area", "--ramp", "turbo", "--range", "0,500"}).code, 0);
  EXPECT_EQ(draw({"--colour-by", "owner", "--ramp", "turbo"}).code, kUsage);
  EXPECT_EQ(draw({"--colour-by", "height", "--attribute", "object"}).code, kUsage);
  EXPECT_THAT(draw({"--colour-by", "heigth"}).messages,
              HasSubstr("objects have no \"heigth\" (did you mean \"height\"?)"));
}

TEST_F(ObjectOptions, CompareTellsWhichObjectMoved) {
  build_city("objects.from=object");
  write_text(work() / "later.obj", obj_of_city(name_of(3, 4), name_of(5, 6)));
  const Outcome outcome = run({"compare", city(), file("later.obj"), "--json", "--objects", "5"});
  ASSERT_EQ(outcome.code, 0) << outcome.messages;
  const json objects = json::parse(outcome.out).at("objects");
  EXPECT_EQ(objects.at("compared"), kStreets * kHouses);
  EXPECT_EQ(objects.at("farthest").size(), 5u);
  const json& moved = objects.at("farthest").at(0);
  EXPECT_EQ(moved.at("name"), name_of(3, 4));
  EXPECT_DOUBLE_EQ(moved.at("moved"), 3);
  EXPECT_DOUBLE_EQ(moved.at("farthest"), 3);
  EXPECT_EQ(objects.at("farthest").at(1).at("farthest"), 0);
  EXPECT_NEAR(moved.at("area").get<double>(), 48 + 28 * height_of(3, 4), 1e-9);
  EXPECT_EQ(moved.at("area"), moved.at("other_area"));
  EXPECT_THAT(objects.at("from").at("lone_names"), ElementsAre(name_of(5, 6)));
  EXPECT_THAT(objects.at("to").at("lone_names"), ElementsAre(name_of(5, 6) + " new"));
  EXPECT_THAT(run({"compare", city(), file("later.obj")}).out, HasSubstr(name_of(3, 4) + "\n"));
  EXPECT_FALSE(
      json::parse(run({"compare", city(), file("later.obj"), "--json", "--objects", "0"}).out)
          .contains("objects"));
  EXPECT_EQ(run({"compare", city(), file("later.obj"), "-o", file("moved.hier")}).code, 0);
}

}  // namespace
}  // namespace meshhier::app
