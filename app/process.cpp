#include "app/process.h"

#include <csignal>
#include <cstddef>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace meshhier::app {

namespace {

/// A signal handler gets no argument of ours, so the token is global.
constinit execution::CancelToken token_to_cancel;

/// Uses only what POSIX allows in a handler: lock-free atomics and signal().
extern "C" void on_signal(int) {
  token_to_cancel.cancel();
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

void handle(int signal_number) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags =
      SA_RESTART;  // reads and writes under way go on; the loops around them look at the token
  sigemptyset(&action.sa_mask);
  sigaction(signal_number, &action, nullptr);
}

bool is_ignored(int signal_number) {
  struct sigaction current {};
  return sigaction(signal_number, nullptr, &current) == 0 && current.sa_handler == SIG_IGN;
}

/// Sets up the handlers. Only the C library is set up when it is called.
void handle_signals() {
  handle(SIGINT);
  handle(SIGTERM);
  if (!is_ignored(SIGHUP))
    handle(SIGHUP);
  std::signal(SIGXFSZ,
              SIG_IGN);  // so that a file size limit is a failed write, told and cleaned up
}

// The loader calls what is listed here before all else: OpenSSL reads its configuration before
// main().
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = handle_signals;

}  // namespace

void reserve_standard_descriptors() {
  for (int descriptor = ::open("/dev/null", O_RDONLY); descriptor >= 0;
       descriptor = ::open("/dev/null", O_RDONLY)) {
    if (descriptor > STDERR_FILENO) {
      ::close(descriptor);
      return;
    }
  }
}

const execution::CancelToken& signal_token() {
  return token_to_cancel;
}

execution::Terminal error_terminal() {
  const auto columns = [] {
    struct winsize size {};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? std::size_t{size.ws_col} : 0;
  };
  return {isatty(STDERR_FILENO) == 1, columns};
}

bool output_is_terminal() {
  return isatty(STDOUT_FILENO) == 1;
}

}  // namespace meshhier::app
