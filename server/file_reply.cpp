#include "server/file_reply.h"

#include "server/byte_range.h"
#include "server/conditions.h"

#include <array>
#include <cstddef>

#include <fmt/format.h>

namespace meshhier::server {
namespace {

/// A gzip member begins with this (RFC 1952), and no GLB does.
constexpr std::array kGzipMagic{std::byte{0x1f}, std::byte{0x8b}};

bool is_gzip(const storage::File& file) {
  std::array<std::byte, kGzipMagic.size()> first{};
  return file.read_at(0, first) == first.size() && first == kGzipMagic;
}

RangeAnswer range_of(const Request& request, const SentFile& sent, std::uint64_t bytes) {
  const bool is_current = !request.if_range || *request.if_range == sent.tag;
  if (!request.range || request.method != "GET" || !is_current)
    return {};
  return find_range(*request.range, bytes);
}

Reply not_acceptable(Reply reply) {
  reply.status = 406;
  reply.headers.emplace_back("Content-Type", "text/plain; charset=utf-8");
  reply.text = "This tile is stored as gzip: ask for it with \"Accept-Encoding: gzip\".\n";
  return reply;
}

Reply outside(Reply reply, std::uint64_t bytes) {
  reply.status = 416;
  reply.headers.emplace_back("Content-Range", fmt::format("bytes */{}", bytes));
  return reply;
}

}  // namespace

Reply file_reply(const Request& request, const SentFile& sent) {
  const bool gzip = sent.may_be_gzip && is_gzip(*sent.file);
  Reply reply;
  reply.headers = {{"ETag", sent.tag}, {"Cache-Control", std::string(sent.cache)}};
  if (gzip)
    reply.headers.emplace_back("Vary", "Accept-Encoding");
  if (gzip && request.accept_encoding && !allows_gzip(*request.accept_encoding))
    return not_acceptable(std::move(reply));
  if (const auto status = status_by_conditions(request, sent.tag)) {
    reply.status = *status;
    return reply;
  }
  const std::uint64_t bytes = sent.file->size();
  const RangeAnswer answer = range_of(request, sent, bytes);
  reply.headers.emplace_back("Accept-Ranges", "bytes");
  if (answer.kind == RangeAnswer::Kind::outside)
    return outside(std::move(reply), bytes);
  reply.headers.emplace_back("Content-Type", sent.type);
  if (gzip)
    reply.headers.emplace_back("Content-Encoding", "gzip");
  reply.file = FilePart{sent.file, 0, bytes};
  if (answer.kind == RangeAnswer::Kind::part) {
    reply.status = 206;
    reply.file = FilePart{sent.file, answer.range.offset, answer.range.bytes};
    reply.headers.emplace_back("Content-Range",
                               fmt::format("bytes {}-{}/{}", answer.range.offset,
                                           answer.range.offset + answer.range.bytes - 1, bytes));
  }
  return reply;
}

}  // namespace meshhier::server
