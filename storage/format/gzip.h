// The gzip format (RFC 1952), for web hosts that send stored files with `Content-Encoding: gzip`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// The CRC-32 of gzip and zip, of `bytes` behind something whose CRC-32 is `before`.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// Which repetitions are looked for. Numbers that hardly repeat are smaller, and five times as
/// fast, without any but runs of one byte: matches by chance spoil the statistics of what is left
/// (docs/decisions/008-progressive-streams.md).
enum class Repetitions { all, runs };

/// One gzip member. Deterministic for one zlib: no name, no time, operating system "unknown".
std::vector<std::byte> gzip(std::span<const std::byte> bytes,
                            Repetitions repetitions = Repetitions::all);

/// What is in one gzip member, on bytes nobody vouches for: no more memory is taken than
/// `most_bytes`. Throws Error(corrupt) that starts with `name`, also if there is more in it.
std::vector<std::byte> gunzip(std::span<const std::byte> bytes, std::size_t most_bytes,
                              const std::string& name);

/// What is in the one gzip member of a GLB, on bytes nobody vouches for: no more memory is taken
/// than deflate can have made of so many bytes, nor than the GLB's header asks for. Throws
/// Error(corrupt) that starts with `name`.
std::vector<std::byte> gunzip_glb(std::span<const std::byte> bytes, const std::string& name);

}  // namespace meshhier::storage
