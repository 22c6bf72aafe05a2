// Contents of files as streams, and what readers say of them.
#pragma once

#include "base/error.h"
#include "mesh_io/input_stream.h"
#include "support/memory_files.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace meshhier::mesh_io::tests {

/// A file "mesh" of that content, and a stream of it.
class Streamed {
 public:
  explicit Streamed(std::string_view content) {
    files_.put("mesh", content);
    file_ = files_.open("mesh");
    stream_ = open_stream({*file_, file_->size()}, {});
  }
  const storage::File& file() const { return *file_; }
  InputStream& stream() { return *stream_; }

  /// All of it, in pieces of `step` bytes.
  std::string read_all(std::size_t step = 1000) {
    std::string all;
    for (std::size_t count = step; count == step;) {
      std::string piece(step, '\0');
      count = stream_->read(std::as_writable_bytes(std::span(piece)));
      all += piece.substr(0, count);
    }
    return all;
  }

 private:
  meshhier::tests::MemoryFiles files_;
  std::unique_ptr<storage::File> file_;
  std::unique_ptr<InputStream> stream_;
};

/// The message of the Error(input) that `run` throws; empty if it throws none.
template <class Run>
std::string input_error_of(const Run& run) {
  try {
    run();
  } catch (const Error& error) {
    return error.code() == ErrorCode::input ? error.what() : "of another code";
  }
  return {};
}

}  // namespace meshhier::mesh_io::tests
