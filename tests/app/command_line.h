// The fixture of tests of the real program as a process: exit codes, messages, and what it leaves
// on disk.
#pragma once

#include "tests/app/program.h"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::app {

inline constexpr int kUsage = 2;
inline constexpr int kInput = 3;
inline constexpr int kIo = 4;
inline constexpr int kExists = 5;
inline constexpr int kBudget = 6;
inline constexpr int kCorrupt = 7;
inline constexpr int kLocked = 8;
inline constexpr int kOtherWork = 9;
inline constexpr int kInterrupted = 130;

class CommandLine : public ::testing::Test {
 protected:
  CommandLine() {
    std::string name = (std::filesystem::temp_directory_path() / "meshhier-cli-XXXXXX").string();
    directory_ = ::mkdtemp(name.data());
    std::filesystem::create_directory(work());
  }
  ~CommandLine() override { std::filesystem::remove_all(directory_); }

  /// Where the tests' files are; what the program prints is kept elsewhere.
  Path work() const { return directory_ / "work"; }

  Outcome run(const Arguments& arguments, const std::string& out = "") const {
    return run_program(arguments, directory_, out);
  }

  /// A bumpy square of 50 x 50 vertices. The last face's last corner is `last_corner`.
  Path write_mesh(const std::string& name, std::size_t last_corner = 2499,
                  double bump = 0.25) const {
    constexpr std::size_t kSide = 50;
    std::ostringstream ply;
    ply << "ply\nformat ascii 1.0\nelement vertex " << kSide * kSide
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
        << 2 * (kSide - 1) * (kSide - 1)
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t v = 0; v < kSide * kSide; ++v) {
      ply << v % kSide << ' ' << v / kSide << ' ' << bump * static_cast<double>(v * 7919 % 64)
          << '\n';
    }
    for (std::size_t y = 0; y + 1 < kSide; ++y) {
      for (std::size_t x = 0; x + 1 < kSide; ++x) {
        const std::size_t v = y * kSide + x;
        const bool last = v + kSide + 2 == kSide * kSide;
        ply << "3 " << v << ' ' << v + 1 << ' ' << v + kSide << '\n';
        ply << "3 " << v + 1 << ' ' << v + kSide << ' ' << (last ? last_corner : v + kSide + 1)
            << '\n';
      }
    }
    write_text(work() / name, ply.str());
    return work() / name;
  }

  /// A config for five partitions of 500 vertices, without a preview, which takes most of so small
  /// a build; `more` adds keys.
  std::string write_config(const std::string& more = "") const {
    write_text(work() / "a.json",
               "// a comment\n{\"input\": \"a.ply\", \"output\": \"a.hier\",\n"
               " \"partition\": {\"vertices\": 500}, \"preview\": false" +
                   more + "}\n");
    return (work() / "a.json").string();
  }

  std::string hierarchy() const { return (work() / "a.hier").string(); }

  /// Meshes and hierarchies are made once more by every test that needs one: each is small.
  void build() const {
    write_mesh("a.ply");
    const Outcome outcome = run({"build", write_config()});
    ASSERT_EQ(outcome.code, 0) << outcome.messages;
  }

  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(work()))
      found.insert(entry.path().filename());
    return found;
  }

  std::map<std::string, std::string> contents(const Path& directory) const {
    std::map<std::string, std::string> files;
    if (!std::filesystem::exists(directory))
      return files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
      if (entry.is_regular_file())
        files[entry.path().lexically_relative(directory)] = text_of(entry.path());
    }
    return files;
  }

 private:
  Path directory_;
};

}  // namespace meshhier::app
