// No command replaces a file that it read: all commands, all arguments that name files, all names
// of these files.
#include "tests/app/program.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::app {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kRefused = 2;

/// As the manual tells it: "--cut FILE", "FROM".
struct Argument {
  std::string name, type;
  bool is_positional() const { return !name.starts_with('-'); }
};

/// Words that stand behind options, by whether they name a file that is read. A type that is in
/// neither list has to be put into one, and, if it is a file, into file_use_of().
const std::set<std::string> kReadTypes{"FILE", "DIR", "LINE|@FILE"};
const std::set<std::string> kOtherTypes{"",
                                        "SIZE",
                                        "CONDITION",
                                        "PROPERTY",
                                        "SOURCE",
                                        "N",
                                        "L",
                                        "L/I",
                                        "LENGTH",
                                        "X,Y",
                                        "X,Y,Z",
                                        "CRS",
                                        "KEY=VALUE",
                                        "FOLDER",
                                        "NAME",
                                        "NAME|AZ,EL",
                                        "FROM,TO",
                                        "ADDRESS",
                                        "COLOUR",
                                        "WIDTHxHEIGHT",
                                        "y|z",
                                        "csv|npy",
                                        "png|webp",
                                        "png|svg|dxf|geojson",
                                        "front|right|back|left",
                                        "NX,NY,NZ,D",
                                        "Z,...",
                                        "INTERVAL",
                                        "1:N",
                                        "mm|cm|m|km|in|ft|us_ft",
                                        "LINK",
                                        "viridis|cividis|turbo|coolwarm",
                                        "auto|bar|json|none"};
const std::set<std::string> kWritten{"--output", "--dsm", "--stats", "--input-note", "--work"};

std::string without_roff(std::string text) {
  for (const std::string mark : {"\\fB", "\\fR", "\\fI", "\\"}) {
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at))
      text.erase(at, mark.size());
  }
  return text;
}

/// The commands of the manual, which the parser prints.
std::map<std::string, std::vector<Argument>> arguments_of(const std::string& manual) {
  std::map<std::string, std::vector<Argument>> commands;
  std::istringstream lines(manual);
  std::string command;
  for (std::string line; std::getline(lines, line);) {
    const std::string head = ".SS \"meshhier ";
    if (line.starts_with(head)) {
      command = line.substr(head.size(), line.rfind('"') - head.size());
    } else if (line == ".TP" && !command.empty() && std::getline(lines, line)) {
      std::istringstream words(without_roff(line));
      Argument argument;
      words >> argument.name >> argument.type;
      argument.name.erase(0, argument.name.rfind(',') + 1);
      commands[command].push_back(argument);
    }
  }
  return commands;
}

bool is_read(const Argument& argument) {
  return argument.is_positional() ||
         (kReadTypes.contains(argument.type) && !kWritten.contains(argument.name));
}
bool is_written(const Argument& argument) {
  return kWritten.contains(argument.name) && !argument.type.empty();
}

constexpr const char* kIn = "<in>";

/// How to name a file by an argument: words, of which kIn stands for the file.
struct Case {
  Arguments words;
  std::string file;
};

/// By command and argument.
const std::map<std::string, Case> kCases{
    {"build FILE", {{"build", kIn}, "b.obj"}},
    {"build --drape", {{"build", "b.obj", "--drape", kIn}, "matrix.txt"}},
    {"build --object-table", {{"build", "b.obj", "--object-table", kIn}, "matrix.txt"}},
    {"plan FILE", {{"plan", kIn, "--tasks", "2"}, "b.obj"}},
    {"compare FROM", {{"compare", kIn, "b.hier"}, "a.hier"}},
    {"compare TO", {{"compare", "b.hier", kIn}, "a.3tz"}},
    {"compare --header", {{"compare", "a.hier", "b.hier", "--header", kIn}, "headers.txt"}},
    {"compare --transform", {{"compare", "a.hier", "b.hier", "--transform", kIn}, "matrix.txt"}},
    {"query HIERARCHY", {{"query", kIn, "--points", "offset.xyz"}, "a.3tz"}},
    {"query --header",
     {{"query", "a.hier", "--points", "offset.xyz", "--header", kIn}, "headers.txt"}},
    {"query --polygon",
     {{"query", "a.hier", "--points", "offset.xyz", "--polygon", kIn}, "p.geojson"}},
    {"query --points", {{"query", "a.hier", "--points", kIn}, "offset.xyz"}},
    {"query --rays", {{"query", "a.hier", "--rays", kIn}, "matrix.txt"}},
    {"export HIERARCHY", {{"export", kIn, "--level", "0"}, "a.3tz"}},
    {"export --header", {{"export", "a.hier", "--level", "0", "--header", kIn}, "headers.txt"}},
    {"export --cut", {{"export", "a.hier", "--cut", kIn}, "cut.txt"}},
    {"export --polygon", {{"export", "a.hier", "--level", "0", "--polygon", kIn}, "p.geojson"}},
    {"preview HIERARCHY", {{"preview", kIn, "--format", "png"}, "a.3tz"}},
    {"preview --header",
     {{"preview", "a.hier", "--format", "png", "--header", kIn}, "headers.txt"}},
    {"preview --cut", {{"preview", "a.hier", "--format", "png", "--cut", kIn}, "cut.txt"}},
    {"preview --polygon",
     {{"preview", "a.hier", "--format", "png", "--polygon", kIn}, "p.geojson"}},
    {"draw HIERARCHY", {{"draw", kIn, "--format", "png"}, "a.3tz"}},
    {"draw --header", {{"draw", "a.hier", "--format", "png", "--header", kIn}, "headers.txt"}},
    {"draw --polygon", {{"draw", "a.hier", "--format", "png", "--polygon", kIn}, "p.geojson"}},
    {"page HIERARCHY", {{"page", kIn, "--viewer", "viewer"}, "a.3tz"}},
    {"page --header", {{"page", "a.hier", "--viewer", "viewer", "--header", kIn}, "headers.txt"}},
    {"page --viewer", {{"page", "a.hier", "--viewer", kIn}, "viewer"}},
    {"progressive HIERARCHY", {{"progressive", kIn}, "h.hier"}},
    {"reconstruct STREAM", {{"reconstruct", kIn}, "h.prog"}},
};

class KeptInputs : public ::testing::Test {
 protected:
  KeptInputs() {
    std::string name = (fs::temp_directory_path() / "meshhier-kept-XXXXXX").string();
    top_ = ::mkdtemp(name.data());
    fs::create_directories(work() / "viewer");
    before_ = fs::current_path();
    fs::current_path(work());
    write_inputs();
  }
  ~KeptInputs() override {
    fs::current_path(before_);
    fs::remove_all(top_);
  }

  Path work() const { return top_ / "work"; }
  Outcome run(const Arguments& arguments) const { return run_program(arguments, top_); }
  void make(const Arguments& arguments) const {
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
  }

  void write_inputs() {
    write_text("a.ply", mesh(0));
    write_text("a.json", R"({"input": "a.ply", "output": "new.hier", "preview": false})");
    write_text("b.obj", "mtllib b.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_text("b.mtl", "newmtl m\nKd 1 0 0\n");
    write_text("cut.txt", "0/0\n");
    write_text("matrix.txt", "1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 1\n");
    write_text("headers.txt", "X-Who: me\n");
    write_text("p.geojson",
               R"({"type": "Polygon", "coordinates": [[[-1, -9], [9, -9], [9, 9], [-1, 9]]]})");
    write_text("offset.xyz", "0 0 0\n");
    write_text("viewer/index.html", "<html></html>");
    write_text("viewer/single.html",
               "<html><head><title>x</title></head><body><!-- model --></body></html>");
    make({"build", "a.ply", "-o", "a.hier", "--set", "preview=false"});
    make({"build", "b.obj", "-o", "b.hier", "--set", "preview=false"});
    make({"build", "a.ply", "-o", "a.3tz", "--set", "preview=false"});
    make({"build", "a.ply", "-o", "h.hier", "--set", "preview=false", "simplify.method=half_edge"});
    make({"progressive", "h.hier", "-o", "h.prog"});
  }
  static std::string mesh(double z) {
    std::ostringstream ply;
    ply << "ply\nformat ascii 1.0\nelement vertex 16\nproperty float x\nproperty float y\n"
           "property float z\nelement face 18\nproperty list uchar int vertex_indices\n"
           "end_header\n";
    for (int v = 0; v < 16; ++v)
      ply << v % 4 << ' ' << v / 4 << ' ' << z + v * 7 % 5 * 0.1 << '\n';
    for (int cell = 0; cell < 9; ++cell) {
      const int v = cell / 3 * 4 + cell % 3;
      ply << "3 " << v << ' ' << v + 1 << ' ' << v + 4 << "\n3 " << v + 1 << ' ' << v + 5 << ' '
          << v + 4 << '\n';
    }
    return ply.str();
  }

  /// Links as where they lead to, so that one that was replaced is seen.
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(work())) {
      const std::string name = entry.path().lexically_relative(work());
      if (entry.is_symlink())
        files[name] = "-> " + fs::read_symlink(entry.path()).string();
      else if (entry.is_regular_file())
        files[name] = text_of(entry.path());
    }
    return files;
  }

  /// All names of one file or folder.
  std::vector<std::string> names_of(const std::string& file) const {
    fs::remove("link");
    fs::remove("hard");
    fs::create_symlink(file, "link");
    std::vector<std::string> names{file, "./viewer/../" + file, (work() / file).string(), "link"};
    if (fs::is_directory(file)) {
      names.push_back(file + "/");
      names.push_back(file + "/within.x");
    } else {
      fs::create_hard_link(file, "hard");
      names.emplace_back("hard");
    }
    return names;
  }

  void expect_kept(const Arguments& words, const std::string& shown) {
    const auto before = contents();
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, kRefused) << shown << ": " << outcome.messages;
    EXPECT_EQ(contents(), before) << shown;
  }

  /// With that file in the place of kIn; options that are required and not tried are given.
  Arguments words_of(const std::string& key, const std::string& file, const Argument& output,
                     const std::string& written) const {
    Arguments words = kCases.at(key).words;
    const std::string given = key.ends_with("--header") ? "@" + file : file;
    std::ranges::replace(words, std::string(kIn), given);
    words.insert(words.end(), {output.name, written, "--force"});
    const bool is_plan = words.front() == "plan";
    if (is_plan && output.name != "--work")
      words.insert(words.end(), {"--work", "new.work"});
    return words;
  }

  Path top_, before_;
};

TEST_F(KeptInputs, ByAllCommandsAndAllTheirArguments) {
  const auto commands = arguments_of(run({"manual"}).out);
  EXPECT_GE(commands.size(), 14U);
  std::set<std::string> tried;
  for (const auto& [command, arguments] : commands) {
    for (const Argument& output : arguments) {
      if (!is_written(output))
        continue;
      for (const Argument& argument : arguments) {
        const std::string key = command + ' ' + argument.name;
        EXPECT_TRUE(is_read(argument) || is_written(argument) ||
                    kOtherTypes.contains(argument.type))
            << key << ": is " << argument.type << " a file?";
        if (!is_read(argument))
          continue;
        ASSERT_TRUE(kCases.contains(key)) << key << ": say how to try it";
        tried.insert(key);
        const std::string& file = kCases.at(key).file;
        for (const std::string& name : names_of(file))
          expect_kept(words_of(key, file, output, name), key + ", " + output.name + " " + name);
        expect_kept(words_of(key, "link", output, file), key + " by a link, " + output.name);
      }
    }
  }
  EXPECT_EQ(tried.size(), kCases.size()) << "a case of an argument that is no more";
}

TEST_F(KeptInputs, WhatFilesNameToo) {
  write_text("placed.json", R"({"input": "a.ply", "output": "new.hier",
                               "placement": {"crs": "EPSG:32632", "metadata": "offset.xyz"}})");
  fs::create_directories("site/models");
  write_text("site/models.json", "{}");
  write_text("site/index.html", "<html></html>");
  fs::copy("a.hier", "site/models/a.hier", fs::copy_options::recursive);
  write_text("a.hier.story.json", R"({"type": "AnnotationPage", "items": []})");
  const std::vector<Arguments> calls{
      {"compare", "b.obj", "a.hier", "-o", "b.mtl", "--force"},
      {"compare", "a.hier", "b.obj", "-o", "b.mtl", "--force"},
      {"compare", "a.json", "a.hier", "-o", "a.ply", "--force"},
      {"build", "placed.json", "--stats", "offset.xyz", "--force"},
      {"build", "placed.json", "--input-note", "offset.xyz", "--force"},
      {"build", "placed.json", "--stats", "placed.json", "--force"},
      {"build", "a.json", "--stats", "a.ply", "--force"},
      {"build", "b.obj", "--stats", "b.mtl", "--force"},
      {"build", "--set", "input=a.ply", "output=new.hier", "--stats", "a.ply", "--force"},
      {"page", "a.hier", "--viewer", "viewer", "-o", "a.hier.story.json", "--force"},
      {"page", "site/models", "--viewer", "viewer", "-o", "site", "--force"},
      {"page", "site/models", "--viewer", "viewer", "-o", "site/models/new", "--force"},
  };
  for (const Arguments& call : calls) {
    std::string shown;
    for (const std::string& word : call)
      shown += word + ' ';
    expect_kept(call, shown);
  }
}

TEST_F(KeptInputs, NamesOfWorkAreNoOutputsEither) {
  fs::rename("cut.txt", ".new.ply.meshhier-part");
  expect_kept({"export", "a.hier", "--cut", ".new.ply.meshhier-part", "-o", "new.ply"}, "part");
  fs::create_directory(".new.hier.meshhier-work");
  fs::rename("a.ply", ".new.hier.meshhier-work/a.ply");
  expect_kept({"build", ".new.hier.meshhier-work/a.ply", "-o", "new.hier", "--restart"}, "work");
}

TEST_F(KeptInputs, AnythingElseIsWritten) {
  make({"compare", "a.hier", "b.obj", "-o", "new.ply"});
  make({"compare", "a.hier", "b.obj", "-o", "new.ply", "--force"});
  make({"export", "a.hier", "--cut", "cut.txt", "-o", "new.ply", "--force"});
  make({"export", "a.3tz", "--level", "0", "-o", "new.3tz"});
  EXPECT_THAT(run({"inspect", "new.3tz"}).out, HasSubstr("16 vertices"));
}

}  // namespace
}  // namespace meshhier::app
