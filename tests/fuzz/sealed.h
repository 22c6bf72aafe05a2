// Files of a hierarchy with the checksums they ought to have: a damage that nobody tries to hide
// never gets beyond the first check.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::tests::fuzz {

/// The text of a hierarchy.json with the right digits where its checksum should be.
std::string sealed_manifest(std::string_view text);

/// A tiles.bin with the right checksum in its header.
std::vector<std::byte> sealed_index(std::span<const std::byte> bytes);

}  // namespace meshhier::tests::fuzz
