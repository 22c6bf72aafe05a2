// The body that a client sends behind a head.
#pragma once

#include "server/connection.h"
#include "server/http.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace meshhier::server {

/// The body of the request that `connection` is at, which must outlive this.
class ConnectionBody final : public Body {
 public:
  ConnectionBody(Connection& connection, std::uint64_t bytes)
      : connection_(connection), bytes_(bytes) {}

  std::uint64_t bytes() const override { return bytes_; }
  std::size_t read(std::span<std::byte> bytes) override {
    if (end_ != End::whole)
      return 0;
    const Connection::BodyPiece piece = connection_.take_body(bytes);
    end_ = piece.end;
    return piece.bytes;
  }
  End end() const override { return end_; }
  bool is_stopping() const override { return connection_.is_stopping(); }

 private:
  Connection& connection_;
  std::uint64_t bytes_;
  End end_ = End::whole;
};

}  // namespace meshhier::server
