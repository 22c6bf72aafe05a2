#include "storage/io/stream.h"

#include "base/error.h"
#include "storage/io/system_failure.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <limits.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meshhier::storage {
namespace {

/// The longest wait before looking whether the job is cancelled.
constexpr int kPatienceMilliseconds = 50;

/// Waits until a descriptor is ready for `events`, or has failed.
void wait_for(int descriptor, short events, const std::function<void()>& check) {
  pollfd waiting{descriptor, events, 0};
  do {
    check();
  } while (::poll(&waiting, 1, kPatienceMilliseconds) <= 0);
}

class PosixStream final : public File {
 public:
  PosixStream(std::filesystem::path path, int descriptor, std::shared_ptr<IoCounters> counters,
              std::function<void()> check)
      : File(std::move(path)),
        descriptor_(descriptor),
        counters_(std::move(counters)),
        check_(std::move(check)) {}
  ~PosixStream() override { ::close(descriptor_); }

  std::uint64_t size() const override { return written_; }
  void sync() override {}
  using File::sync;

 protected:
  std::size_t read_some(std::uint64_t, std::span<std::byte>) const override {
    fail_system("read", path(), ESPIPE);
  }

  std::size_t write_some(std::uint64_t offset, std::span<const std::byte> bytes) override {
    if (offset != written_)
      fail_system("write", path(), ESPIPE);
    // A pipe that is ready takes so many bytes at once, so the call cannot block, whether or not
    // its descriptor may.
    const std::size_t most = std::min<std::size_t>(bytes.size(), PIPE_BUF);
    for (;;) {
      wait_until_ready();
      const ssize_t count = ::write(descriptor_, bytes.data(), most);
      if (count >= 0) {
        written_ += static_cast<std::uint64_t>(count);
        counters_->bytes_written += static_cast<std::uint64_t>(count);
        return static_cast<std::size_t>(count);
      }
      if (errno != EINTR && errno != EAGAIN)
        fail_system("write", path(), errno);
    }
  }

 private:
  void wait_until_ready() const { wait_for(descriptor_, POLLOUT, check_); }

  int descriptor_;
  std::shared_ptr<IoCounters> counters_;
  std::function<void()> check_;
  std::uint64_t written_ = 0;
};

/// Without O_NONBLOCK the call would not come back until somebody reads a FIFO.
int open_named(const std::filesystem::path& path, const std::function<void()>& check) {
  for (;;) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor >= 0)
      return descriptor;
    if (errno != ENXIO)
      fail_system("open", path, errno);
    check();
    ::poll(nullptr, 0, kPatienceMilliseconds);
  }
}

bool is_stream(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && (S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode));
}

}  // namespace

std::unique_ptr<File> open_posix_stream(const std::filesystem::path& path,
                                        std::shared_ptr<IoCounters> counters,
                                        const std::function<void()>& check) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is then a failed write
  const bool is_own = path == "/dev/stdout" || is_own_output(path);
  const int descriptor =
      is_own ? ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0) : open_named(path, check);
  if (descriptor < 0)
    fail_system("open", path, errno);
  auto stream = std::make_unique<PosixStream>(path, descriptor, std::move(counters), check);
  if (!is_own && !is_stream(descriptor))
    throw Error(ErrorCode::io, fmt::format("cannot open {}: it has been replaced", path.string()));
  return stream;
}

std::size_t read_standard_input(std::span<std::byte> to, const std::function<void()>& check) {
  for (;;) {
    wait_for(STDIN_FILENO, POLLIN, check);
    const ssize_t count = ::read(STDIN_FILENO, to.data(), to.size());
    if (count >= 0)
      return static_cast<std::size_t>(count);
    if (errno != EINTR && errno != EAGAIN)
      fail_system("read", "standard input", errno);
  }
}

bool is_own_output(const std::filesystem::path& path) {
  struct stat own {};
  struct stat named {};
  return ::fstat(STDOUT_FILENO, &own) == 0 && ::stat(path.c_str(), &named) == 0 &&
         own.st_dev == named.st_dev && own.st_ino == named.st_ino;
}

}  // namespace meshhier::storage
