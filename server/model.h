// The facts on a hierarchy that the page lists.
#pragma once

#include "server/globe_place.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace meshhier::server {

struct Model {
  std::string path;      ///< relative to the folder that is served; "" if it is that folder
  std::string name{};    ///< for people
  std::string source{};  ///< the name of the mesh file
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t bytes = 0;              ///< all of its files
  std::uint64_t mesh_bytes = 0;         ///< the mesh file alone, without its pictures
  std::uint64_t mesh_checksum = 0;      ///< likewise
  std::uint64_t source_checksum = 0;    ///< as in the manifest
  bool has_preview = false;             ///< a picture of it is one of its files
  bool has_story = false;               ///< a story lies beside it
  std::int64_t modified = 0;            ///< when it was made: seconds since 1970; 0: not known
  std::string build{};                  ///< the build's name; "" for a stream
  std::vector<std::string> warnings{};  ///< its build's, if a watched folder made it
  std::optional<GlobePlace> place{};    ///< as people say, else by the manifest's transform
  std::string title{};                  ///< people say these three (server/descriptions.h)
  std::string folder{};
  std::vector<std::string> tags{};

  friend bool operator==(const Model&, const Model&) = default;
};

}  // namespace meshhier::server
