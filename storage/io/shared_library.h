// A library that is loaded while the program runs, by those who need it only.
#pragma once

#include <memory>
#include <string>

namespace meshhier::storage {

/// Loaded while the object lives; its names are no one else's. Thread-safe.
class SharedLibrary {
 public:
  /// `file`: its name in the folders of the system, "libproj.so.25". `remedy`: what to do if it
  /// cannot be used: "install the package libproj25". Throws Error(io) with both.
  SharedLibrary(std::string file, std::string remedy);

  /// `Function`: a pointer of its type. Throws Error(io) if the library has none of that name.
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
