#include "support/gzip.h"

#include <stdexcept>

#include <zlib.h>

namespace meshhier::tests {

std::string gzip(std::string_view content) {
  z_stream state{};
  if (deflateInit2(&state, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib cannot be used");
  std::string packed(deflateBound(&state, content.size()), '\0');
  state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  state.avail_in = static_cast<uInt>(content.size());
  state.next_out = reinterpret_cast<Bytef*>(packed.data());
  state.avail_out = static_cast<uInt>(packed.size());
  if (deflate(&state, Z_FINISH) != Z_STREAM_END)
    throw std::runtime_error("deflate failed");
  packed.resize(packed.size() - state.avail_out);
  deflateEnd(&state);
  return packed;
}

std::string gunzip(const std::string& packed) {
  z_stream stream{};
  constexpr int kGzip = 16;
  if (inflateInit2(&stream, MAX_WBITS + kGzip) != Z_OK)
    throw std::runtime_error("zlib");
  std::string content;
  std::string source = packed;
  stream.next_in = reinterpret_cast<Bytef*>(source.data());
  stream.avail_in = static_cast<uInt>(source.size());
  for (int status = Z_OK; status == Z_OK;) {
    char block[65536];
    stream.next_out = reinterpret_cast<Bytef*>(block);
    stream.avail_out = sizeof(block);
    status = inflate(&stream, Z_NO_FLUSH);
    content.append(block, sizeof(block) - stream.avail_out);
    if (status != Z_OK && status != Z_STREAM_END)
      throw std::runtime_error("no gzip");
  }
  inflateEnd(&stream);
  return content;
}

}  // namespace meshhier::tests
