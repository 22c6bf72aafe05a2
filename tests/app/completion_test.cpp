// Completion: what the program answers, and real shells on a terminal that ask it when Tab is
// pressed.
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

namespace meshhier::app {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;
using Path = std::filesystem::path;
using Lines = std::vector<std::string>;

/// Returns the output of a shell command.
std::string output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  char part[4096];
  for (std::size_t size; (size = std::fread(part, 1, sizeof part, pipe)) > 0;)
    text.append(part, size);
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return text;
}

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

/// "files" or "words", then the words that the program suggests.
Lines answer_to(const std::string& words) {
  Lines lines = lines_of(output_of(MESHHIER_BINARY " complete meshhier " + words));
  for (std::string& line : lines)
    line.resize(std::min(line.find('\t'), line.size()));
  return lines;
}

TEST(CompletionTest, ACommandIsCompleted) {
  EXPECT_THAT(answer_to("bui"), ElementsAre("words", "build"));
  EXPECT_THAT(answer_to("''"), IsSupersetOf({"build", "serve", "completion", "--help"}));
  EXPECT_THAT(answer_to("''"), Not(Contains("complete"))) << "that one is for the scripts";
}

TEST(CompletionTest, OptionsAreThoseOfTheHelp) {
  for (const std::string& command : answer_to("''")) {
    if (command == "words" || command.starts_with('-'))
      continue;
    const std::string help = output_of(MESHHIER_BINARY " " + command + " --help");
    const Lines options = answer_to(command + " --");
    for (const std::string& line : lines_of(help.substr(0, help.find("\nExamples")))) {
      const std::size_t begin = line.find("--");
      if (!line.starts_with("  -") || begin == std::string::npos)
        continue;
      const std::string name = line.substr(begin, line.find_first_of(" ,{", begin) - begin);
      EXPECT_THAT(options, Contains(name)) << command;
    }
  }
}

TEST(CompletionTest, ValuesOfOptionsAreCompleted) {
  EXPECT_THAT(answer_to("build --progress ''"),
              ElementsAre("words", "auto", "bar", "json", "none"));
  EXPECT_THAT(answer_to("build x.json --progress=j"), ElementsAre("words", "--progress=json"));
  EXPECT_THAT(answer_to("build --help-config=s"), ElementsAre("words", "--help-config=schema"));
  EXPECT_THAT(answer_to("verify --level ''"), ElementsAre("words", "all"));
  EXPECT_THAT(answer_to("completion z"), ElementsAre("words", "zsh"));
  EXPECT_THAT(answer_to("inspect --level ''"), ElementsAre("words")) << "a number is nothing known";
}

TEST(CompletionTest, KeysOfTheConfigAreCompleted) {
  EXPECT_THAT(answer_to("build --set weld=true partition.v"),
              ElementsAre("words", "partition.vertices="));
  EXPECT_THAT(answer_to("build --set simplify.method=c"),
              ElementsAre("words", "simplify.method=cluster"));
  EXPECT_THAT(answer_to("build --set weld="), ElementsAre("words", "weld=true", "weld=false"));
  EXPECT_THAT(answer_to("build --set output="), ElementsAre("files"));
}

TEST(CompletionTest, FilesAreAskedForWhereTheyStand) {
  for (const char* words :
       {"build ''", "build --stats ''", "inspect ''", "verify x.hier --input a.ply ''",
        "export x.hier -o ''", "serve ''", "serve models --watch ''", "clean ''"})
    EXPECT_EQ(answer_to(words).at(0), "files") << words;
}

TEST(CompletionTest, NonsenseIsNotCompleted) {
  for (const char* words : {"", "nothing ''", "nothing --h", "build --nothing=", "-- --", "'=' ''"})
    EXPECT_THAT(answer_to(words), Each(AllOf(Not(HasSubstr("=")), Not(StartsWith("b"))))) << words;
}

TEST(ManualTest, TellsOfEveryCommandAndMeansNothingToRoff) {
  const std::string manual = output_of(MESHHIER_BINARY " manual");
  for (const std::string& command : answer_to("''")) {
    if (command != "words" && !command.starts_with('-')) {
      EXPECT_THAT(manual, HasSubstr("\n.SS \"meshhier " + command + "\"\n"));
    }
  }
  EXPECT_THAT(manual, HasSubstr("\\fB\\-\\-progress\\fR \\fIauto|bar|json|none\\fR\n"));
  for (const std::string& line : lines_of(manual)) {
    if (line.starts_with('.')) {
      EXPECT_THAT((Lines{".TH", ".SH", ".SS", ".PP", ".nf", ".fi", ".TP"}),
                  Contains(line.substr(0, 3)));
    }
  }
}

TEST(ManualTest, TheDocumentHasTheTableOfCommandsAndAHeadingForEach) {
  std::ifstream file(MESHHIER_SOURCE_DIR "/docs/command_line.md");
  const std::string document{std::istreambuf_iterator<char>(file), {}};
  const std::string table = output_of(MESHHIER_BINARY " manual --commands");
  EXPECT_THAT(document,
              HasSubstr("<!-- commands: begin -->\n\n" + table + "\n<!-- commands: end -->"))
      << "scripts/references writes it anew";
  for (const std::string& command : answer_to("''"))
    if (command != "words" && !command.starts_with('-')) {
      EXPECT_THAT(table, HasSubstr("| [" + command + "](#" + command + ") |"));
      EXPECT_THAT(document, HasSubstr("\n## " + command + "\n"));
    }
}

/// A shell on a terminal of its own.
class Terminal {
 public:
  Terminal(const Lines& command, const Path& home) {
    process_ = ::forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (process_ != 0)
      return;
    std::vector<char*> words;
    for (const std::string& word : command)
      words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    ::setenv("HOME", home.c_str(), 1);
    ::setenv("TERM", "dumb", 1);
    ::setenv("LC_ALL", "C", 1);
    ::setenv("PATH", ((home / "bin").string() + ":/usr/local/bin:/usr/bin:/bin").c_str(), 1);
    ::unsetenv("XDG_CONFIG_HOME");
    ::unsetenv("XDG_DATA_HOME");
    if (::chdir(home.c_str()) == 0)
      ::execvp(words[0], words.data());
    ::_exit(127);
  }
  ~Terminal() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    ::close(terminal_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void type(std::string_view text) {
    ASSERT_EQ(::write(terminal_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  /// Reads until `text` has come, and forgets all up to its end. Fails if nothing comes any more.
  void wait_for(const std::string& text) {
    while (seen_.find(text) == std::string::npos) {
      pollfd ready{terminal_, POLLIN, 0};
      char part[4096];
      ssize_t size = -1;
      if (::poll(&ready, 1, kPatience) == 1)
        size = ::read(terminal_, part, sizeof part);
      if (size <= 0)
        throw std::runtime_error("the shell does not say \"" + text + "\" but: " + seen_);
      seen_.append(part, static_cast<std::size_t>(size));
    }
    seen_.erase(0, seen_.find(text) + text.size());
  }

 private:
  static constexpr int kPatience = 600'000;  // milliseconds; a shell that answers takes none of it
  pid_t process_ = -1;
  int terminal_ = -1;
  std::string seen_;
};

/// How a shell is started on a terminal, where it looks for completions, and what it reads first.
struct Shell {
  const char* name;
  Lines command;
  const char* setup_file;
  const char* setup;
};

class ShellTest : public ::testing::TestWithParam<Shell> {
 protected:
  ShellTest() {
    std::string name = (std::filesystem::temp_directory_path() / "meshhier-shell-XXXXXX").string();
    home_ = ::mkdtemp(name.data());
    write("bin/meshhier", "#!/bin/sh\n[ \"$1\" = complete ] && exec '" MESHHIER_BINARY
                          "' \"$@\"\necho \"$#:\" \"$@\" END\n");
    std::filesystem::permissions(home_ / "bin/meshhier", std::filesystem::perms::owner_all);
    write("a mesh.json", "");
    // Else fish makes them, of all manual pages, and goes on with that when the test has ended.
    std::filesystem::create_directories(home_ / ".local/share/fish/generated_completions");
  }
  ~ShellTest() override { std::filesystem::remove_all(home_); }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((home_ / name).parent_path());
    std::ofstream(home_ / name) << text;
  }
  static bool is_installed(const std::string& shell) {
    return std::filesystem::exists("/bin/" + shell) || std::filesystem::exists("/usr/bin/" + shell);
  }

  Path home_;
};

TEST_P(ShellTest, TabCompletes) {
  const Shell& shell = GetParam();
  if (!is_installed(shell.name))
    GTEST_SKIP() << shell.name << " is not installed";
  write("completions/script", output_of(MESHHIER_BINARY " completion " + std::string(shell.name)));
  write(shell.setup_file, shell.setup);
  Terminal terminal(shell.command, home_);
  terminal.wait_for("READY>");
  const auto run = [&](const std::string& typed, const std::string& words) {
    terminal.type(typed + "\r");
    terminal.wait_for(words + " END");
    terminal.wait_for("READY>");
  };
  run("meshhier bui\tx", "2: build x");
  run("meshhier build --prog\tno\tx", "4: build --progress none x");
  run("meshhier build --progress=js\tx", "3: build --progress=json x");
  run("meshhier build --set partition.ver\t8", "3: build --set partition.vertices=8");
  run("meshhier build --set simplify.method=clu\tx", "4: build --set simplify.method=cluster x");
  run("meshhier build a\tx", "3: build a mesh.json x");
  run("meshhier build --set input=a\tx", "4: build --set input=a mesh.json x");
}

INSTANTIATE_TEST_SUITE_P(
    Shells, ShellTest,
    ::testing::Values(
        Shell{"bash",
              {"bash", "--rcfile", ".setup", "-i"},
              ".setup",
              "PS1='READY''>'; bind 'set enable-bracketed-paste off'; . completions/script\n"},
        Shell{"zsh",
              {"zsh", "-i"},
              ".zshrc",
              "PS1='READY''>'; cp completions/script completions/_meshhier\n"
              "fpath=($HOME/completions $fpath); autoload -Uz compinit; compinit -u -D\n"},
        Shell{"fish",
              {"fish", "-i"},
              ".config/fish/config.fish",
              "function fish_prompt; echo -n READY; echo -n '>'; end; function fish_greeting; end\n"
              "set -g fish_autosuggestion_enabled 0; source completions/script\n"}),
    [](const auto& shell) { return std::string(shell.param.name); });

}  // namespace
}  // namespace meshhier::app
