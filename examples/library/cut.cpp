// SPDX-License-Identifier: MIT
// Makes a hierarchy of a mesh, tells what is in it, and writes a cut of it as a PLY.
//
//   cut scan.ply scan.hier 0.5 cut.ply      the coarsest tiles that are no farther than 0.5 from
//   the original
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <meshhier/meshhier.h>

namespace mh = meshhier::v1;

namespace {

bool tell(const mh::Progress& progress) {
  std::fprintf(stderr, "\r%-10s %3.0f %%", progress.stage.c_str(), 100 * progress.job_done);
  return true;  // false would stop the build; the next one goes on
}

void list(const mh::Hierarchy& hierarchy) {
  std::cout << hierarchy.triangles() << " triangles in " << hierarchy.levels() << " levels\n";
  for (std::uint32_t level = 0; level < hierarchy.levels(); ++level) {
    double error = 0;
    std::uint64_t bytes = 0;
    const std::vector<mh::Node> nodes = hierarchy.level(level);
    for (const mh::Node& node : nodes) {
      error = std::max(error, hierarchy.tile(node).error);
      bytes += hierarchy.tile(node).file_bytes;
    }
    std::cout << "level " << level << ": " << nodes.size() << " tiles, " << bytes
              << " bytes, error " << error << '\n';
  }
}

/// One mesh of all parts: vertices are the places of the surface.
void write(mh::Cut cut, const std::string& name) {
  std::map<std::uint32_t, std::uint32_t> numbers;  // new numbers of places
  std::vector<mh::Point> positions;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const mh::Part part = cut.load(i);
    for (std::size_t v = 0; v < part.positions.size(); ++v) {
      if (numbers.emplace(part.places[v], static_cast<std::uint32_t>(positions.size())).second)
        positions.push_back(part.positions[v]);
    }
    for (const auto& triangle : part.triangles) {
      for (const std::uint32_t vertex : triangle)
        corners.push_back(numbers.at(part.places[vertex]));
    }
  }
  std::ofstream out(name, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << positions.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
      << corners.size() / 3 << "\nproperty list uchar int vertex_indices\nend_header\n";
  out.write(reinterpret_cast<const char*>(positions.data()),
            static_cast<std::streamsize>(sizeof(mh::Point) * positions.size()));
  for (std::size_t t = 0; t < corners.size(); t += 3)
    out.put(3).write(reinterpret_cast<const char*>(&corners[t]), 3 * sizeof(std::uint32_t));
  std::cout << name << ": " << cut.size() << " tiles, " << positions.size() << " vertices, "
            << corners.size() / 3 << " triangles\n";
}

}  // namespace

int main(int count, char** words) {
  if (count != 5) {
    std::cerr << "usage: cut MESH HIERARCHY ERROR OUT.ply\n";
    return 2;
  }
  try {
    mh::BuildRequest request;
    request.meshes = {words[1]};
    request.output = words[2];
    request.settings = {{"memory_budget", "256MiB"}};
    request.replace = true;
    request.progress = tell;
    mh::build(request);
    std::cerr << '\n';
    const mh::Hierarchy hierarchy(words[2]);
    list(hierarchy);
    write(hierarchy.cut(hierarchy.within(std::stod(words[3]))), words[4]);
  } catch (const mh::Error& error) {
    std::cerr << "cut: " << error.what() << '\n';
    return static_cast<int>(error.failure());
  }
}
