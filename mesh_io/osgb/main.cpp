// meshhier_osgb: makes GLBs of OSGB files for meshhier, by OpenSceneGraph.
//
// The library is not trusted with bytes of others. So it works in this process, which meshhier
// starts: it gets a file's bytes through a socket, opens nothing, and has memory and time by the
// file's size. If it ends, meshhier names the file.
#include "mesh_io/osgb/coded_picture.h"
#include "mesh_io/osgb/finest_parts.h"
#include "mesh_io/osgb/kept_scene.h"
#include "mesh_io/osgb/protocol.h"
#include "mesh_io/osgb/scene_glb.h"
#include "storage/io/confinement.h"
#include "storage/io/little_endian.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <new>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::mesh_io::osgb {
namespace {

using Bytes = std::vector<std::byte>;

/// Memory and time for a file. Packed ones become several times as large, and so do pictures that
/// are decoded.
constexpr std::uint64_t kLeastMemory = std::uint64_t{96} << 20, kMemoryOfByte = 32;
constexpr std::uint64_t kLeastSeconds = 2, kBytesOfSecond = std::uint64_t{1} << 20;

bool read_all(std::span<std::byte> bytes) {
  return std::fread(bytes.data(), 1, bytes.size(), stdin) == bytes.size();
}

void write_all(std::span<const std::byte> bytes) {
  std::fwrite(bytes.data(), 1, bytes.size(), stdout);
}

void write_word(std::uint32_t word) {
  std::array<std::byte, 4> bytes{};
  storage::store_little(word, bytes.data());
  write_all(bytes);
}

void append_word(Bytes& to, std::size_t word) {
  storage::append_little(to, static_cast<std::uint32_t>(word));
}

void append_text(Bytes& to, std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// The scene of the file that was asked for last: it is asked for its names, then for its tile.
class LastScene {
 public:
  const KeptScene& of(std::span<const std::byte> file) {
    if (!scene_.root || !std::ranges::equal(file, file_)) {
      scene_ = {};
      scene_ = read_scene(file);
      file_.assign(file.begin(), file.end());
    }
    return scene_;
  }

 private:
  Bytes file_;
  KeptScene scene_;
};

Bytes names_answer(const KeptScene& scene) {
  const std::set<std::string> names = names_in(*scene.root);
  Bytes answer;
  append_word(answer, names.size());
  for (const std::string& name : names) {
    append_word(answer, name.size());
    append_text(answer, name);
  }
  return answer;
}

/// The finest parts of a scene, and their GLB. `choice`: a byte a name, 1 if that file is there.
struct Tile {
  Tile(const KeptScene& scene, std::span<const std::byte> choice)
      : found(finest_parts(*scene.root, present(scene, choice))), glb(scene_glb(found.parts)) {}

  static std::map<std::string, std::size_t> present(const KeptScene& scene,
                                                    std::span<const std::byte> choice) {
    std::map<std::string, std::size_t> present;
    std::size_t number = 0;
    for (const std::string& name : names_in(*scene.root)) {
      if (number < choice.size() && choice[number] != std::byte{0})
        present.emplace(name, number);
      ++number;
    }
    return present;
  }

  FinestParts found;
  SceneGlb glb;
};

Bytes tile_answer(const KeptScene& scene, std::span<const std::byte> choice) {
  const Tile tile(scene, choice);
  Bytes answer;
  append_word(answer, tile.found.finer.size());
  append_word(answer, tile.found.missing);
  append_word(answer, tile.found.others + tile.glb.without);
  append_word(answer, scene.unknown);
  append_word(answer, tile.glb.triangles);
  for (const FinerFile& finer : tile.found.finer) {
    append_word(answer, finer.name);
    for (std::size_t i = 0; i < 16; ++i)
      storage::append_little(answer, finer.place.ptr()[i]);
  }
  append_text(answer, tile.glb.bytes);
  return answer;
}

Bytes picture_answer(const KeptScene& scene, std::span<const std::byte> choice) {
  constexpr std::size_t kWord = 4;
  if (choice.size() < kWord)
    throw std::runtime_error("no picture is asked for");
  const Tile tile(scene, choice.subspan(kWord));
  const auto picture = tile.glb.pictures.find(storage::load_little<std::uint32_t>(choice.data()));
  if (picture == tile.glb.pictures.end())
    throw std::runtime_error("it has no such picture");
  Bytes answer;
  append_text(answer, coded_picture(*picture->second));
  return answer;
}

Bytes answer_to(std::uint32_t kind, const KeptScene& scene, std::span<const std::byte> choice) {
  return kind == kNames  ? names_answer(scene)
         : kind == kTile ? tile_answer(scene, choice)
                         : picture_answer(scene, choice);
}

/// Answers a question. Returns false if there is none any more, or none is to come.
bool answer_next(LastScene& last) {
  std::array<std::byte, 12> head{};
  if (!read_all(head))
    return false;
  const auto word = [&](std::size_t i) {
    return storage::load_little<std::uint32_t>(head.data() + 4 * i);
  };
  const std::uint64_t bytes = word(2);
  storage::limit_work(kLeastMemory + kMemoryOfByte * bytes, kLeastSeconds + bytes / kBytesOfSecond);
  Bytes answer;
  std::uint32_t status = 0;
  try {
    Bytes question(bytes);
    if (!read_all(question) || word(1) > bytes)
      return false;
    const std::span all(question);
    const KeptScene& scene = last.of(all.subspan(word(1)));
    answer = answer_to(word(0), scene, all.first(word(1)));
  } catch (const std::bad_alloc&) {
    status = 1;
    append_text(answer, "it takes more memory than a file of its size may");
  } catch (const std::exception& error) {
    status = 1;
    append_text(answer, error.what());
  }
  write_word(status);
  write_word(static_cast<std::uint32_t>(answer.size()));
  write_all(answer);
  std::fflush(stdout);
  return status == 0;
}

int serve() try {
  prepare_reading();
  storage::confine_process();
  write_word(kProtocol);
  std::fflush(stdout);
  LastScene last;
  while (answer_next(last)) {
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "meshhier_osgb: %s\n", error.what());
  return 1;
}

}  // namespace
}  // namespace meshhier::mesh_io::osgb

int main() {
  return meshhier::mesh_io::osgb::serve();
}
