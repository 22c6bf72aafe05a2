#include "storage/io/shared_library.h"

#include "base/error.h"

#include <utility>

#include <dlfcn.h>

namespace meshhier::storage {

SharedLibrary::SharedLibrary(std::string file, std::string remedy)
    : file_(std::move(file)),
      remedy_(std::move(remedy)),
      library_(::dlopen(file_.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (!library_)
    throw Error(ErrorCode::io, std::string("cannot load ") + ::dlerror() + "; " + remedy_);
}

void* SharedLibrary::address(const char* name) const {
  void* const found = ::dlsym(library_.get(), name);
  if (found == nullptr)
    throw Error(ErrorCode::io, file_ + " has no function " + name + "; " + remedy_);
  return found;
}

void SharedLibrary::Close::operator()(void* library) const {
  ::dlclose(library);
}

}  // namespace meshhier::storage
