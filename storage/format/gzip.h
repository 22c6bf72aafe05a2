// The gzip format (RFC 1952), for web hosts that send stored files with `Content-Encoding: gzip`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Returns the CRC-32 of gzip and zip of something whose CRC-32 is `before`, with `bytes` behind
/// it.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// The repetitions that are looked for: all, or only runs of one byte. Numbers that hardly repeat
/// are packed smaller, and five times as fast, by runs alone: matches by chance spoil the
/// statistics of the rest (docs/decisions/008-progressive-streams.md).
enum class Repetitions { all, runs };

/// Returns one gzip member. Deterministic for one zlib: no name, no time, operating system
/// "unknown". Requires less than 4 GiB. Thread-safe, as all functions here.
std::vector<std::byte> gzip(std::span<const std::byte> bytes,
                            Repetitions repetitions = Repetitions::all);

/// Unpacks one gzip member that nobody vouches for, without taking more memory than `most_bytes`.
/// Throws Error(corrupt) that starts with `name`, also if there is more in it.
std::vector<std::byte> gunzip(std::span<const std::byte> bytes, std::size_t most_bytes,
                              const std::string& name);

/// Unpacks the one gzip member of a GLB, which nobody vouches for: no more memory is taken than so
/// many bytes of deflate can stand for, nor than the GLB's header asks for. Throws Error(corrupt)
/// that starts with `name`.
std::vector<std::byte> gunzip_glb(std::span<const std::byte> bytes, const std::string& name);

}  // namespace meshhier::storage
