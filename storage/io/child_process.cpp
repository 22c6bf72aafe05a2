#include "storage/io/child_process.h"

#include "base/error.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

/// Both ends of a pipe.
struct Pipe {
  int reader = -1;
  int writer = -1;
};

[[noreturn]] void fail(const std::string& what, int error) {
  throw Error(ErrorCode::io, what + ": " + std::strerror(error));
}

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    fail("cannot make a pipe", errno);
  return {ends[0], ends[1]};
}

void close_end(int end) {
  if (end >= 0)
    ::close(end);
}

Pipe make_sockets() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    fail("cannot make a pair of sockets", errno);
  return {ends[0], ends[1]};
}

/// Forgets the handlers of the process that this one was forked from, as exec does: until then a
/// signal that asks the program to stop would be lost in them.
void forget_handlers() {
  for (const int number : {SIGHUP, SIGINT, SIGTERM}) {
    struct sigaction action {};
    if (::sigaction(number, nullptr, &action) == 0 && action.sa_handler != SIG_IGN)
      ::signal(number, SIG_DFL);
  }
}

/// Does what fork() does. A signal that is sent to the new process at once waits for it.
pid_t fork_without_handlers() {
  sigset_t all{}, before{};
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t process = ::fork();
  if (process == 0)
    forget_handlers();
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return process;
}

/// Turns the forked process into the program, or ends it. Between fork and exec only calls that are
/// safe in a signal handler are allowed: other threads may have held locks, of malloc for one.
/// `errors`: -1 if they are dropped; `socket`: -1 if it is not spoken with.
[[noreturn]] void become(char* const* words, int errors, int socket, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nothing = ::open("/dev/null", O_RDWR);
  const int said = errors < 0 ? nothing : errors;
  const int spoken = socket < 0 ? nothing : socket;
  // The parent may have died before prctl(): then nobody would kill this process.
  const bool is_ready = ::getppid() == parent && nothing >= 0 &&
                        ::dup2(spoken, STDIN_FILENO) >= 0 && ::dup2(spoken, STDOUT_FILENO) >= 0 &&
                        ::dup2(said, STDERR_FILENO) >= 0 &&
                        ::close_range(STDERR_FILENO + 1, ~0U, 0) == 0;
  if (is_ready)
    ::execv(words[0], words);
  ::_exit(127);
}

int exit_code(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, Errors errors, Speech speech) {
  std::vector<char*> arguments;
  for (const std::string& word : words)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const Pipe sockets = speech == Speech::socket ? make_sockets() : Pipe();
  const Pipe pipe = errors == Errors::heard ? make_pipe() : Pipe();
  const pid_t parent = ::getpid();
  process_ = fork_without_handlers();
  const int error = errno;
  if (process_ == 0)
    become(arguments.data(), pipe.writer, sockets.writer, parent);
  close_end(pipe.writer);
  close_end(sockets.writer);
  errors_ = pipe.reader;
  socket_ = sockets.reader;
  if (process_ < 0) {
    close_end(errors_);
    close_end(socket_);
    fail("cannot start " + words[0], error);
  }
}

ChildProcess::~ChildProcess() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    wait();
  }
  close_end(errors_);
  close_end(socket_);
}

bool ChildProcess::hear(std::string& text, std::chrono::milliseconds longest) {
  if (errors_ < 0)
    return false;
  pollfd ready{errors_, POLLIN, 0};
  const int count = ::poll(&ready, 1, static_cast<int>(longest.count()));
  if (count < 0 && errno != EINTR)
    fail("cannot wait for a child process", errno);
  if (count <= 0)
    return true;
  std::array<char, 4096> buffer;
  const ssize_t bytes = ::read(errors_, buffer.data(), buffer.size());
  if (bytes < 0 && errno != EINTR)
    fail("cannot read what a child process says", errno);
  if (bytes > 0)
    text.append(buffer.data(), static_cast<std::size_t>(bytes));
  return bytes != 0;
}

bool ChildProcess::send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR)
      continue;
    if (count < 0 && (errno == EPIPE || errno == ECONNRESET))
      return false;
    if (count < 0)
      fail("cannot speak with a child process", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

bool ChildProcess::receive(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
    if (count < 0 && errno == EINTR)
      continue;
    if (count == 0 || (count < 0 && errno == ECONNRESET))
      return false;
    if (count < 0)
      fail("cannot hear a child process", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

void ChildProcess::ask_to_stop() {
  if (process_ > 0)
    ::kill(process_, SIGTERM);
}

int ChildProcess::wait() {
  int status = 0;
  while (::waitpid(process_, &status, 0) == -1) {
    if (errno != EINTR)
      fail("cannot wait for a child process", errno);
  }
  process_ = -1;
  return exit_code(status);
}

std::optional<std::string> find_program(std::string_view name) {
  const char* const places = std::getenv("PATH");
  std::istringstream left(places == nullptr ? "" : places);
  for (std::string place; std::getline(left, place, ':');) {
    std::string path = std::filesystem::path(place) / name;
    std::error_code error;
    if (!place.empty() && std::filesystem::is_regular_file(path, error) &&
        ::access(path.c_str(), X_OK) == 0)
      return path;
  }
  return std::nullopt;
}

}  // namespace meshhier::storage
