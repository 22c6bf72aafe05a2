// A library that is loaded while the program runs, by those who need it only.
#pragma once

#include <memory>
#include <string>

namespace meshhier::storage {

/// A library is loaded while its object lives, and its names are seen by nobody else. Thread-safe.
class SharedLibrary {
 public:
  /// Loads `file`, a name in the folders of the system, "libproj.so.25". `remedy`: what to do if it
  /// cannot be used: "install the package libproj25". Throws Error(io) with both.
  SharedLibrary(std::string file, std::string remedy);

  /// Returns the function of that name. `Function`: a pointer of its type, which is not checked.
  /// Throws Error(io) if the library has none.
  template <class Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(address(name));
  }

 private:
  struct Close {
    void operator()(void* library) const;
  };

  void* address(const char* name) const;

  std::string file_;
  std::string remedy_;
  std::unique_ptr<void, Close> library_;
};

}  // namespace meshhier::storage
