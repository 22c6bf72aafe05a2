#include "import/osgb_import.h"

#include "base/plain_text.h"
#include "execution/parallel.h"
#include "mesh_io/input_error.h"
#include "mesh_io/osgb_tiles.h"
#include "mesh_io/part_of_file.h"

#include <cstring>
#include <exception>
#include <iterator>
#include <list>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

using Path = std::filesystem::path;

constexpr std::uint64_t kMostTilesShown = std::uint64_t{1} << 20;
constexpr std::size_t kDeepestTile = 100;  ///< there are about 20 levels of detail
constexpr std::size_t kLongestShownName = 255;

/// The files that lead to a file by their names, the nearest first.
struct OsgbAbove {
  Path path;
  std::shared_ptr<const OsgbAbove> above;
  std::size_t depth = 0;
};

/// A file as it was read. Its bytes are gone.
struct OsgbOutcome {
  std::unique_ptr<MeshApart> mesh{};  ///< none: it shows no triangles
  storage::FileIdentity identity{};
  mesh_io::OsgbTile counts{};  ///< without its GLB
  std::string first_missing{};
  std::vector<Path> missing_places{};
  std::vector<mesh_io::OsgbFinerFile> finer{};
  std::exception_ptr failure{};
};

/// A file in the line.
struct OsgbStep {
  std::size_t tile = 0;  ///< of the input, which leads to it
  Path path;
  mesh_io::GltfTransform place{};  ///< in the coordinates of that tile
  std::shared_ptr<const OsgbAbove> above{};
  std::optional<OsgbOutcome> outcome{};
};

/// Returns where a range of the GLB lies in the OSGB as it is, as pictures that are files do.
std::optional<std::uint64_t> find_in_file(const mesh_io::OsgbRead& read, std::uint64_t offset,
                                          std::uint64_t bytes) {
  if (read.file.is_packed() || bytes == 0)
    return std::nullopt;
  const std::span<const std::byte> all = read.file.bytes();
  // Linear, whatever the bytes are.
  const void* const found = ::memmem(all.data(), all.size(), read.tile.glb->data() + offset, bytes);
  if (found == nullptr)
    return std::nullopt;
  return static_cast<std::uint64_t>(static_cast<const std::byte*>(found) - all.data());
}

std::string shown_name(const std::string& name) {
  return plain_text(name, kLongestShownName);
}

void require_no_circle(const OsgbStep& step) {
  for (const OsgbAbove* one = step.above.get(); one != nullptr; one = one->above.get()) {
    if (one->path == step.path)
      mesh_io::fail_file(step.above->path,
                         fmt::format("names {}, which names it: files are in a circle",
                                     shown_name(step.path.string())));
  }
  if (step.above && step.above->depth >= kDeepestTile)
    mesh_io::fail_file(step.path, fmt::format("is named by files within each other, deeper than {}",
                                              kDeepestTile));
}

/// Collects what is to be told of a tile of the input.
class OsgbNotes {
 public:
  void add(const OsgbStep& step, const OsgbOutcome& read) {
    if (step.above)
      facts_.tiles.add({step.path, InputPart::tile, read.identity});
    missing_ += read.counts.missing;
    others_ += read.counts.others;
    unknown_ += read.counts.unknown;
    sought_.insert(sought_.end(), read.missing_places.begin(), read.missing_places.end());
    if (first_missing_.empty())
      first_missing_ = read.first_missing;
  }

  /// Returns what there is to tell, and begins anew.
  OsgbFacts take(const Path& tile) {
    facts_.tiles.await(sought_);
    add_count(facts_.counts, "missing_tiles", missing_);
    add_count(facts_.counts, kPointsAndLines, others_);
    add_count(facts_.counts, "unknown_parts", unknown_);
    if (missing_ > 0) {
      facts_.warnings.push_back(mesh_io::file_message(
          tile,
          fmt::format("{} that tiles name {} not there (the first is {}): coarser ones stand "
                      "in their place",
                      counted(missing_, "files"), missing_ == 1 ? "is" : "are", first_missing_)));
    }
    if (unknown_ > 0) {
      facts_.warnings.push_back(mesh_io::file_message(
          tile,
          counted(unknown_, "parts") + " of kinds that OpenSceneGraph does not know, left out"));
    }
    return std::move(std::exchange(*this, {}).facts_);
  }

 private:
  OsgbFacts facts_;
  std::uint64_t missing_ = 0, others_ = 0, unknown_ = 0;
  std::string first_missing_;
  std::vector<Path> sought_;
};

class OsgbLine {
 public:
  OsgbLine(std::span<const InputFileFacts> tiles, const OsgbRoom& room, const OsgbUse& use)
      : tiles_(tiles), room_(room), use_(use), reader_(room.room.files, most_bytes(room)) {
    for (std::size_t i = 0; i < tiles.size(); ++i)
      line_.push_back({.tile = i, .path = tiles[i].path});
  }

  void run() {
    // A file of the usual size, its mesh's spools.
    constexpr std::uint64_t kUsualBytes = std::uint64_t{1} << 18;
    const std::size_t in_flight =
        execution::useful_blocks(room_.room.memory_bytes, mesh_io::osgb_reading_bytes(kUsualBytes));
    while (!line_.empty()) {
      const auto batch = unread(in_flight);
      execution::ordered_for(
          batch.size(), in_flight, room_.cancel, [&](std::size_t i) { return read(*batch[i]); },
          [&](std::size_t i, OsgbOutcome outcome) { place(batch[i], std::move(outcome)); });
      tell();
    }
    finish();
  }

 private:
  using Place = std::list<OsgbStep>::iterator;

  /// A file, as a question once more, and the answer.
  static std::uint64_t most_bytes(const OsgbRoom& room) { return room.room.memory_bytes / 3; }

  /// Returns the first files that nobody has read.
  std::vector<Place> unread(std::size_t most) {
    std::vector<Place> first;
    for (auto at = line_.begin(); at != line_.end() && first.size() < most; ++at) {
      if (!at->outcome)
        first.push_back(at);
    }
    return first;
  }

  OsgbOutcome read(const OsgbStep& step) {
    try {
      require_no_circle(step);
      return read_file(step);
    } catch (...) {
      room_.cancel.check();
      return {.failure = std::current_exception()};
    }
  }

  OsgbOutcome read_file(const OsgbStep& step) {
    const storage::FileIdentity identity = room_.room.files.identity(step.path);
    const auto held = room_.gate.enter(mesh_io::osgb_reading_bytes(identity.bytes));
    mesh_io::OsgbRead read = reader_.read(step.path);
    OsgbOutcome outcome{.identity = identity, .counts = read.tile, .finer = finer_files(read)};
    if (read.tile.missing > 0)
      note_missing(step.path, read, outcome);
    if (read.tile.triangles > 0)
      outcome.mesh = mesh_of(step, read);
    outcome.counts.glb.reset();
    return outcome;
  }

  static void note_missing(const Path& path, const mesh_io::OsgbRead& read, OsgbOutcome& outcome) {
    outcome.missing_places = missing_places(path, read);
    for (std::size_t i = 0; i < read.names.size() && outcome.first_missing.empty(); ++i) {
      if (read.found[i].empty())
        outcome.first_missing =
            fmt::format("{} in {}", shown_name(read.names[i]), shown_name(path.string()));
    }
  }

  std::unique_ptr<MeshApart> mesh_of(const OsgbStep& step, const mesh_io::OsgbRead& read) const {
    mesh_io::GltfRoom own = room_.room;
    own.content = mesh_io::GltfContent::packed;
    own.stored_in = step.path;
    own.find_plain = [&](std::uint64_t offset, std::uint64_t bytes) {
      return find_in_file(read, offset, bytes);
    };
    mesh_io::GltfFile file(mesh_io::file_of_bytes(step.path, read.tile.glb),
                           step.path.parent_path(), std::move(own));
    return use_.read(file, step.place);
  }

  /// Notes what was read, and puts the files that it names behind it.
  void place(Place at, OsgbOutcome outcome) {
    const auto above = std::make_shared<const OsgbAbove>(
        OsgbAbove{at->path, at->above, at->above ? at->above->depth + 1 : 1});
    const Place behind = std::next(at);
    for (mesh_io::OsgbFinerFile& finer : outcome.finer)
      line_.insert(behind, OsgbStep{.tile = at->tile,
                                    .path = std::move(finer.path),
                                    .place = at->place * finer.place,
                                    .above = above});
    at->outcome = std::move(outcome);
  }

  /// Tells of those that were read and have nothing unread before them.
  void tell() {
    for (; !line_.empty() && line_.front().outcome; line_.pop_front()) {
      OsgbStep& step = line_.front();
      while (told_ < step.tile)
        finish();
      OsgbOutcome& outcome = *step.outcome;
      if (outcome.failure)
        std::rethrow_exception(outcome.failure);
      if (++shown_ > kMostTilesShown)
        mesh_io::fail_file(step.path,
                           fmt::format("with it more than {} tiles are shown", kMostTilesShown));
      if (outcome.mesh)
        use_.add(std::move(outcome.mesh));
      notes_.add(step, outcome);
      use_.advance(outcome.identity.bytes);
    }
  }

  void finish() {
    use_.told(told_, notes_.take(tiles_[told_].path));
    ++told_;
  }

  std::span<const InputFileFacts> tiles_;
  const OsgbRoom& room_;
  const OsgbUse& use_;
  mesh_io::OsgbTiles reader_;
  std::list<OsgbStep> line_;
  std::size_t told_ = 0;  ///< tiles of the input of which all is told
  std::uint64_t shown_ = 0;
  OsgbNotes notes_;
};

}  // namespace

void import_osgb(std::span<const InputFileFacts> tiles, const OsgbRoom& room, const OsgbUse& use) {
  OsgbLine(tiles, room, use).run();
  mesh_io::end_osgb_readers();
}

}  // namespace meshhier::importing
