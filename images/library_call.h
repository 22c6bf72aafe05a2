// Calls into C libraries whose error handlers must not return.
//
// An error leaves the library by longjmp() to where the call began, so no exception passes through
// its frames; there it becomes an exception.
#pragma once

#include "base/error.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

namespace meshhier::images {

class LibraryCall {
 public:
  /// Failures become Error(code) "subject: message".
  LibraryCall(ErrorCode code, std::string subject) : code_(code), subject_(std::move(subject)) {}
  LibraryCall(const LibraryCall&) = delete;
  LibraryCall& operator=(const LibraryCall&) = delete;

  /// Runs `call`. While the library is at work, no frame above this one may hold anything that is
  /// to be destroyed. Throws the exception of a callback, or the failure that fail() was told.
  template <class Call>
  void run(const Call& call) {
    if (setjmp(way_back_) == 0) {
      call();
    } else {
      throw_failure();
    }
  }

  /// Runs `work`, which may throw, in a function that the library calls back.
  template <class Work>
  void callback(const Work& work) {
    try {
      work();
      return;
    } catch (...) {
      caught_ = std::current_exception();
    }
    std::longjmp(way_back_, 1);
  }

  /// Ends run() with a failure.
  [[noreturn]] void fail(std::string_view message) {
    length_ = std::min(message.size(), message_.size());
    std::copy_n(message.data(), length_, message_.data());
    std::longjmp(way_back_, 1);
  }

 private:
  [[noreturn]] void throw_failure() {
    if (caught_)
      std::rethrow_exception(std::exchange(caught_, nullptr));
    throw Error(code_, subject_ + ": " + std::string(message_.data(), length_));
  }

  ErrorCode code_;
  std::string subject_;
  std::jmp_buf way_back_{};
  std::array<char, 256> message_{};  ///< no string: nothing may be allocated on the way back
  std::size_t length_ = 0;
  std::exception_ptr caught_;
};

}  // namespace meshhier::images
