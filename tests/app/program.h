// The real program as a process, for tests.
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace meshhier::app {

using Path = std::filesystem::path;
using Arguments = std::vector<std::string>;

inline std::string text_of(const Path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline void write_text(const Path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  ASSERT_TRUE(stream.flush()) << path;
}

/// Throws if it does not start: a signal to "process -1" would reach every process there is.
inline pid_t spawn(const Arguments& arguments, posix_spawn_file_actions_t& actions,
                   const char* program = MESHHIER_BINARY) {
  std::vector<char*> words{const_cast<char*>(program)};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  pid_t process = -1;
  if (posix_spawn(&process, program, &actions, nullptr, words.data(), environ) != 0)
    throw std::runtime_error(std::string("cannot start ") + program);
  return process;
}

/// The exit code; 1000 + n after death by signal n.
inline int wait_for(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) == -1 && errno == EINTR) {
  }
  return WIFSIGNALED(status) ? 1000 + WTERMSIG(status) : WEXITSTATUS(status);
}

struct Outcome {
  int code = -1;
  std::string out;
  std::string messages;
};

/// Runs the program. Its output is kept in `folder`, or that on standard output in the file `out`.
inline Outcome run_program(const Arguments& arguments, const Path& folder,
                           const std::string& out = "", const char* program = MESHHIER_BINARY) {
  const std::string out_path = out.empty() ? (folder / "out").string() : out;
  const std::string message_path = (folder / "messages").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_path.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, message_path.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int code = wait_for(spawn(arguments, actions, program));
  posix_spawn_file_actions_destroy(&actions);
  return {code, out.empty() ? text_of(out_path) : "", text_of(message_path)};
}

}  // namespace meshhier::app
