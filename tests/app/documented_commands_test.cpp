// The commands that documents and --help show are such that the program understands them.
#include "tests/app/command_line.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::app {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Lines = std::vector<std::string>;

std::vector<Path> documents_with_commands() {
  const Path root = MESHHIER_SOURCE_DIR;
  std::vector<Path> found{root / "README.md", root / "viewer/README.md", root / "python/README.md"};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "docs"))
    if (entry.path().extension() == ".md")
      found.push_back(entry.path());
  return found;
}

/// The lines of blocks of code.
Lines code_of(const Path& document) {
  Lines lines;
  std::istringstream text(text_of(document));
  bool is_code = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```"))
      is_code = !is_code;
    else if (is_code)
      lines.push_back(line);
  }
  return lines;
}

/// Whether a line calls the program, and can be tried: it is no usage, asks no address, and serves
/// nothing that is there.
bool is_call(const std::string& line) {
  static const std::regex usage(R"(\[|\(|\.\.\.|\bOPTIONS\b|\bPIECE\b|\bCOMMAND\b)");
  static const std::regex not_here(R"(\w https?://|serve \.)");
  return line.starts_with("meshhier ") && !std::regex_search(line, usage) &&
         !std::regex_search(line, not_here);
}

/// The keys of the config that a call sets.
Lines keys_in(const std::string& line) {
  static const std::regex setting(R"( ([a-z_]+(\.[a-z_0-9]+)*)=)");
  Lines keys;
  if (line.find(" --set ") != std::string::npos) {
    for (std::sregex_iterator match(line.begin(), line.end(), setting), end; match != end; ++match)
      keys.push_back((*match)[1]);
  }
  return keys;
}

class DocumentedCommands : public CommandLine {
 protected:
  /// What the program says to a line of a shell, in a folder without any file.
  std::string answer_to(const std::string& call) const {
    const std::string place = "'" + (work() / "empty").string() + "'";
    const std::string line = "rm -rf " + place + "; mkdir " + place + "; cd " + place +
                             "; HOME=$PWD; meshhier() { timeout 60 '" MESHHIER_BINARY
                             "' \"$@\"; }; { " +
                             call + "\n} 2>&1 </dev/null";
    std::FILE* pipe = ::popen(line.c_str(), "r");
    std::string text;
    std::array<char, 4096> part;
    for (std::size_t size; (size = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
      text.append(part.data(), size);
    ::pclose(pipe);
    return text;
  }

  /// What the program does not understand in the calls among the lines.
  Lines mistakes_in(const Lines& lines) const {
    Lines mistakes;
    for (const std::string& line : lines) {
      if (!is_call(line))
        continue;
      const std::string answer = answer_to(line);
      if (answer.find("Run with --help") != std::string::npos)
        mistakes.push_back(line + ": " + answer);
      for (const std::string& key : keys_in(line))
        if (keys_.find(' ' + key + ':') == std::string::npos)
          mistakes.push_back(line + ": there is no key " + key);
    }
    return mistakes;
  }

 private:
  std::string keys_ = run({"build", "--help-config"}).out;
};

TEST_F(DocumentedCommands, ThoseOfDocumentsAreUnderstood) {
  std::size_t count = 0;
  for (const Path& document : documents_with_commands()) {
    const Lines lines = code_of(document);
    EXPECT_THAT(mistakes_in(lines), IsEmpty()) << document;
    count += static_cast<std::size_t>(std::ranges::count_if(lines, is_call));
  }
  EXPECT_GT(count, 60U);
}

TEST_F(DocumentedCommands, ExamplesOfTheHelpAreUnderstood) {
  for (const char* command :
       {"build", "inspect", "verify", "compare", "query", "export", "preview", "draw", "view",
        "page", "progressive", "reconstruct", "serve", "plan", "task", "clean", "completion"}) {
    std::istringstream help(run({command, "--help"}).out);
    Lines examples;
    for (std::string line; std::getline(help, line);)
      if (line.starts_with("  meshhier "))
        examples.push_back(line.substr(2, line.find("  ", 2) - 2));
    EXPECT_THAT(mistakes_in(examples), IsEmpty()) << command;
  }
}

TEST_F(DocumentedCommands, AMistakeIsNoticed) {
  EXPECT_THAT(mistakes_in({"meshhier build scan.ply --colour red", "meshhier inspect a.hier",
                           "meshhier build scan.ply --set up=z colour=red", "nothing"}),
              ElementsAre(HasSubstr("--colour"), HasSubstr("there is no key colour")));
  EXPECT_FALSE(is_call("meshhier export HIERARCHY [PIECE]"));
}

}  // namespace
}  // namespace meshhier::app
