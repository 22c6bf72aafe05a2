// Starts a program of the portable archive with the loader and the libraries that came with it.
//
//   bin/NAME                        this, linked statically: it runs where there is no loader
//   lib/meshhier/NAME               the program
//   lib/meshhier/ld-linux-*.so.*, *.so.*      MESHHIER_LOADER is the loader's name
//   share/meshhier/proj             what PROJ knows of maps
//
// The program finds itself by MESHHIER_PROGRAM: what runs is the loader.
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <sys/auxv.h>
#include <unistd.h>

namespace {

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "meshhier: %s\n", what.c_str());
  std::exit(1);
}

/// This file's path, without links. Where there is no /proc, the system still tells by which path
/// it was started.
std::string own_path() {
  std::vector<char> path(PATH_MAX + 1);
  const ssize_t length = ::readlink("/proc/self/exe", path.data(), PATH_MAX);
  if (length > 0 && length < PATH_MAX)
    return {path.data(), static_cast<std::size_t>(length)};
  const auto* const started = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  if (started == nullptr || ::realpath(started, path.data()) == nullptr)
    fail(
        "cannot find out where the program lies: there is no /proc, and the path that it was "
        "started by leads nowhere; start it by its whole path");
  return path.data();
}

std::string directory_of(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

/// The certificates that HTTPS trusts, where the libraries, Debian's, do not look for them.
void name_authorities() {
  for (const char* file : {"/etc/ssl/certs/ca-certificates.crt", "/etc/pki/tls/certs/ca-bundle.crt",
                           "/etc/ssl/ca-bundle.pem", "/etc/ssl/cert.pem"}) {
    if (::access(file, R_OK) == 0) {
      ::setenv("SSL_CERT_FILE", file, 0);
      return;
    }
  }
}

}  // namespace

int main(int count, char** words) {
  const std::string own = own_path();
  const std::string root = directory_of(directory_of(own));
  const std::string libraries = root + "/lib/meshhier";
  if (libraries.find_first_of(":;") != std::string::npos)
    fail(root + ": unpack it into a folder without ':' and ';' in its path");
  const std::string loader = libraries + "/" MESHHIER_LOADER;
  const std::string program = libraries + own.substr(own.rfind('/'));
  const std::string name = count > 0 ? words[0] : own;
  ::setenv("MESHHIER_PROGRAM", own.c_str(), 1);
  ::setenv("PROJ_DATA", (root + "/share/meshhier/proj").c_str(), 0);
  name_authorities();
  std::vector<const char*> command{loader.c_str(),    "--inhibit-cache", "--library-path",
                                   libraries.c_str(), "--argv0",         name.c_str(),
                                   program.c_str()};
  command.insert(command.end(), words + (count > 0 ? 1 : 0), words + count);
  command.push_back(nullptr);
  ::execv(loader.c_str(), const_cast<char**>(command.data()));
  fail("cannot start " + loader + ": " + std::strerror(errno) + "; unpack the whole archive");
}
