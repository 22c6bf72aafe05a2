// SPDX-License-Identifier: MIT
// Reads a hierarchy of meshhier and writes a cut of it without cracks as a PLY:
// docs/for_engines.md, as a program.
//
//   read_cut scan.hier 0.5 cut.ply      the coarsest tiles that are no farther than 0.5 from the
//   original
//
// Needs nothing but nlohmann-json. Reads hierarchies with "storage.compression": "none", on
// little-endian machines.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

using Json = nlohmann::json;
using Bytes = std::vector<char>;
using Node = std::pair<std::uint32_t, std::uint32_t>;  // level, index
using Point = std::array<float, 3>;

Bytes read_file(const std::string& name) {
  std::ifstream stream(name, std::ios::binary);
  if (!stream)
    throw std::runtime_error("cannot open " + name);
  return {std::istreambuf_iterator<char>(stream), {}};
}

template <class T>
std::vector<T> read(const Bytes& bytes, std::size_t at, std::size_t count) {
  if (at > bytes.size() || count > (bytes.size() - at) / sizeof(T))
    throw std::runtime_error("a file is cut off");
  std::vector<T> values(count);
  if (count > 0)
    std::memcpy(values.data(), bytes.data() + at, count * sizeof(T));
  return values;
}

struct Tree {
  std::uint32_t partitions, depth;

  struct Way {
    std::uint32_t first, end, path;
  };
  /// Goes down from the root: the partitions that are left, and which halves were taken, a bit
  /// each.
  template <class IsRight>
  Way walk(std::uint32_t levels, IsRight is_right) const {
    Way way{0, partitions, 0};
    for (std::uint32_t l = 0; l < levels; ++l) {
      const std::uint32_t middle = way.first + (way.end - way.first + 1) / 2;
      const bool right = is_right(l, middle);
      (right ? way.first : way.end) = middle;
      way.path = 2 * way.path + (right ? 1 : 0);
    }
    return way;
  }
  Node ancestor(Node node, std::uint32_t above) const {
    if (above == node.first || node.first < depth)
      return {above, node.second >> (node.first - above)};
    return {above, walk(above, [&](auto, auto middle) { return node.second >= middle; }).path};
  }
  /// An early node, of one partition above the last level, has no tile: its partition stands for
  /// it.
  std::vector<Node> children(Node node) const {
    const auto [level, index] = node;
    if (level == depth)
      return {};
    const std::uint32_t number = index, levels = level;
    const Way way = walk(level, [&](auto l, auto) { return number >> (levels - 1 - l) & 1; });
    const std::uint32_t middle = way.first + (way.end - way.first + 1) / 2;
    const auto child = [&](std::uint32_t first, std::uint32_t end, std::uint32_t k) {
      return end - first == 1 ? Node{depth, first} : Node{levels + 1, 2 * number + k};
    };
    return {child(way.first, middle, 0), child(middle, way.end, 1)};
  }
};

struct Neighbour {
  std::uint32_t index;
  std::vector<Node> nodes;   // it, and its ancestors below the common one
  std::size_t entry;         // its first ghost's, in the chains
  std::uint32_t first, end;  // its ghosts, as vertices
};

struct Tile {
  std::uint32_t own, ghosts;
  std::vector<Point> positions;       // relative to the origin
  std::vector<std::uint32_t> places;  // per vertex: the own vertex or ghost where it lies
  std::vector<std::uint16_t> chains;
  std::vector<std::uint32_t> interior, border;  // three vertices a triangle
  std::vector<Neighbour> neighbours;
  std::uint32_t base = 0;  // number of its first own vertex in the cut
};

std::string path_of(Node node) {
  char name[64];
  const std::uint32_t group = node.second / 10000 * 10000;
  if (group > 0)
    std::snprintf(name, sizeof name, "tiles/%02u/%06u/%06u.glb", node.first, group, node.second);
  else
    std::snprintf(name, sizeof name, "tiles/%02u/%06u.glb", node.first, node.second);
  return name;
}

Tile read_tile(const Bytes& bytes, Node node, const Tree& tree, const Json& lattice) {
  const auto json_bytes = read<std::uint32_t>(bytes, 12, 1)[0];
  const auto text = read<char>(bytes, 20, json_bytes);
  const Json gltf = Json::parse(text.begin(), text.end());
  for (const Json& name : gltf.value("extensionsRequired", Json::array()))
    if (name == "EXT_meshopt_compression")
      throw std::runtime_error("this program reads tiles without meshopt");
  const std::size_t bin = 28 + std::size_t{json_bytes};
  const Json& facts = gltf.at("extensions").at("MESHHIER_tile");
  const auto section = [&](const char* name, bool narrow) {
    const int number = facts.value(name, -1);
    if (number < 0)
      return std::vector<std::uint32_t>();
    const Json& view = gltf.at("bufferViews").at(number);
    const std::size_t at = bin + view.value("byteOffset", 0), size = view.at("byteLength");
    const auto wide =
        narrow ? std::vector<std::uint32_t>() : read<std::uint32_t>(bytes, at, size / 4);
    const auto few =
        narrow ? read<std::uint16_t>(bytes, at, size / 2) : std::vector<std::uint16_t>();
    return narrow ? std::vector<std::uint32_t>(few.begin(), few.end()) : wide;
  };
  const Json& primitives = gltf.at("meshes").at(0).at("primitives");
  const auto triangles = [&](const char* name) {
    const int number = facts.at(name);
    if (number < 0)
      return std::vector<std::uint32_t>();
    const Json& accessor =
        gltf.at("accessors").at(primitives.at(number).at("indices").get<std::size_t>());
    const std::size_t at = bin + gltf.at("bufferViews")
                                     .at(accessor.at("bufferView").get<std::size_t>())
                                     .value("byteOffset", 0);
    const std::size_t count = accessor.at("count");
    if (accessor.at("componentType") == 5125)
      return read<std::uint32_t>(bytes, at, count);
    const auto narrow = read<std::uint16_t>(bytes, at, count);
    return std::vector<std::uint32_t>(narrow.begin(), narrow.end());
  };
  Tile tile{facts.at("ownCount"),           facts.at("ghostCount"),       {}, {}, {},
            triangles("interiorPrimitive"), triangles("borderPrimitive"), {}};
  const std::uint32_t copies = facts.at("copyCount"), splits = facts.value("splitCount", 0);
  const std::uint32_t places = tile.own + tile.ghosts, unsplit = places + copies;
  const Json& accessor =
      gltf.at("accessors").at(primitives.at(0).at("attributes").at("POSITION").get<std::size_t>());
  const std::size_t at = bin + gltf.at("bufferViews")
                                   .at(accessor.at("bufferView").get<std::size_t>())
                                   .value("byteOffset", 0);
  if (accessor.at("componentType") == 5126) {
    tile.positions = read<Point>(bytes, at, unsplit + splits);
  } else {  // quantized: 3 u16 and two bytes of nothing each
    const double step = lattice.at("step");
    for (const auto& n : read<std::array<std::uint16_t, 4>>(bytes, at, unsplit + splits)) {
      Point p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = static_cast<float>(n[k] * step + lattice.at("corner")[k].get<double>());
      tile.positions.push_back(p);
    }
  }
  for (std::uint32_t v = 0; v < places; ++v)
    tile.places.push_back(v);
  for (const std::uint32_t vertex : section("copyOf", places <= 65535))
    tile.places.push_back(tile.places.at(vertex));
  for (const std::uint32_t vertex : section("splitOf", unsplit <= 65535))
    tile.places.push_back(tile.places.at(vertex));
  const auto chains = section("ghostChains", true);
  tile.chains.assign(chains.begin(), chains.end());
  const auto starts = section("ghostStarts", false);
  std::size_t entry = 0;
  for (const std::uint32_t index : section("neighbours", false)) {
    const std::size_t i = tile.neighbours.size();
    Neighbour neighbour{index, {}, entry, tile.own + starts.at(i), tile.own + starts.at(i + 1)};
    const Node other{node.first, index};
    for (std::uint32_t l = node.first; tree.ancestor(other, l) != tree.ancestor(node, l); --l)
      neighbour.nodes.push_back(tree.ancestor(other, l));
    entry += neighbour.nodes.size() * (neighbour.end - neighbour.first);
    tile.neighbours.push_back(std::move(neighbour));
  }
  return tile;
}

using Cut = std::map<Node, Tile>;

/// The triangles that a tile draws in a cut, by the numbers of its places there.
void draw(Node node, const Tile& tile, const Cut& cut,
          std::vector<std::array<std::uint32_t, 3>>& drawn) {
  // We draw triangles that touch these places.
  std::vector<bool> is_ours(tile.own + tile.ghosts, true);
  std::vector<std::uint32_t> at(tile.own + tile.ghosts);
  for (std::uint32_t v = 0; v < tile.own; ++v)
    at[v] = tile.base + v;
  for (const Neighbour& neighbour : tile.neighbours) {
    std::size_t up =
        0;  // 0: shown at our level; n: as its ancestor n levels up; all of them: finer
    while (up < neighbour.nodes.size() && cut.count(neighbour.nodes[up]) == 0)
      ++up;
    const bool is_finer = up == neighbour.nodes.size();
    for (std::uint32_t ghost = neighbour.first; ghost < neighbour.end; ++ghost) {
      is_ours.at(ghost) = !is_finer && (up > 0 || neighbour.index > node.second);
      if (!is_finer)
        at[ghost] = cut.at(neighbour.nodes[up]).base +
                    tile.chains.at(neighbour.entry +
                                   (ghost - neighbour.first) * neighbour.nodes.size() + up);
    }
  }
  const auto add = [&](const std::vector<std::uint32_t>& corners, bool is_border) {
    for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
      bool is_drawn = true;
      for (std::size_t k = 0; is_border && k < 3; ++k) {
        const std::uint32_t a = tile.places.at(corners[t + k]),
                            b = tile.places.at(corners[t + (k + 1) % 3]);
        is_drawn = is_drawn && is_ours[a] &&
                   (a == b || at[a] != at[b]);  // two places that are one here: it has vanished
      }
      if (is_drawn)
        drawn.push_back({at[tile.places.at(corners[t])], at[tile.places.at(corners[t + 1])],
                         at[tile.places.at(corners[t + 2])]});
    }
  };
  add(tile.interior, false);
  add(tile.border, true);
}

int main(int count, char** words) try {
  if (count != 4)
    throw std::runtime_error("usage: read_cut HIERARCHY ERROR OUT.ply");
  const std::string folder = std::string(words[1]) + '/';
  const double largest = std::stod(words[2]);
  const Bytes text = read_file(folder + "hierarchy.json"), index = read_file(folder + "tiles.bin");
  const Json manifest = Json::parse(text.begin(), text.end());
  Tree tree{manifest.at("partitions"), 0};
  while ((std::uint64_t{1} << tree.depth) < tree.partitions)
    ++tree.depth;
  std::map<Node, float> errors;
  for (std::size_t at = 32; at < index.size(); at += 120) {
    const auto node = read<std::uint32_t>(index, at, 2);
    errors[{node[0], node[1]}] = read<float>(index, at + 48, 1)[0];
  }
  Cut cut;
  std::vector<Node> pending{{0, 0}};
  while (!pending.empty()) {
    const Node node = pending.back();
    pending.pop_back();
    const std::vector<Node> children = tree.children(node);
    if (children.empty() || errors.at(node) <= largest)
      cut.emplace(node, read_tile(read_file(folder + path_of(node)), node, tree,
                                  manifest.at("storage").at("positions")));
    else
      pending.insert(pending.end(), children.begin(), children.end());
  }
  std::uint32_t vertices = 0;
  for (auto& [node, tile] : cut) {
    tile.base = vertices;
    vertices += tile.own;
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& [node, tile] : cut)
    draw(node, tile, cut, triangles);
  std::ofstream out(words[3], std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << vertices
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
      << triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& [node, tile] : cut) {
    for (std::uint32_t v = 0; v < tile.own; ++v) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = tile.positions.at(v)[k] + manifest.at("origin")[k].get<double>();
        out.write(reinterpret_cast<const char*>(&x), sizeof x);
      }
    }
  }
  for (const auto& triangle : triangles)
    out.put(3).write(reinterpret_cast<const char*>(triangle.data()), sizeof triangle);
  std::cout << cut.size() << " tiles, " << vertices << " vertices, " << triangles.size()
            << " triangles\n";
  return out.good() ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << "read_cut: " << error.what() << '\n';
  return 1;
}
