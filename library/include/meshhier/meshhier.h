// Reads hierarchies of meshhier, and makes them. This header is all that is public of the library.
//
//   find_package(meshhier 1 REQUIRED)
//   target_link_libraries(viewer PRIVATE meshhier::meshhier)
//
// It stays source- and binary-compatible within a major version (semantic versioning); no other
// header is installed. C++17. The library is under GPL-3.0-or-later.
//
// Coordinates and lengths are in the input's units. Objects may be used from one thread at a time,
// different ones from different threads; copies of a Hierarchy are different ones. Nothing is kept
// between calls but the objects. Every failure is an Error; a call that throws changes nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#define MESHHIER_API __attribute__((visibility("default")))

namespace meshhier::v1 {

/// Returns the version of the library: "1.0.0".
MESHHIER_API std::string version();

/// The kinds of failures, which have the numbers of the program's exit codes.
enum class Failure {
  usage = 2,         ///< the call, a setting or a config is wrong
  input = 3,         ///< the mesh is broken or not supported
  io = 4,            ///< a file could not be read or written
  exists = 5,        ///< the output is there already
  budget = 6,        ///< memory or disk do not suffice
  corrupt = 7,       ///< the hierarchy is damaged
  locked = 8,        ///< another build is at work on the output: try again later
  other_work = 9,    ///< a stopped build of other settings, or of another mesh, left its work
  internal = 70,     ///< a defect of the library: please report it
  interrupted = 130  ///< asked to stop; the same build goes on where it was
};

/// The exception that all functions here throw. The message names the file, and says what to do.
class MESHHIER_API Error : public std::runtime_error {
 public:
  Error(Failure failure, const std::string& message);
  Failure failure() const { return failure_; }

 private:
  Failure failure_;
};

using Point = std::array<double, 3>;

/// A node of the tree: its level from the root (0) down, and its number from left to right.
struct Node {
  std::uint32_t level = 0;
  std::uint32_t index = 0;

  friend bool operator==(Node a, Node b) { return a.level == b.level && a.index == b.index; }
  friend bool operator<(Node a, Node b) {
    return a.level != b.level ? a.level < b.level : a.index < b.index;
  }
};

/// The facts on a tile that are in the index.
struct TileFacts {
  Node node;
  double error = 0;     ///< estimated distance to the original surface; the finest tiles have 0, no
                        ///< tile has less than one below it
  double bound = 0;     ///< certain upper bound of the Hausdorff distance to it
  Point low{}, high{};  ///< the box of all its vertices, ghosts among them
  std::uint32_t vertices = 0, triangles = 0;
  std::uint64_t file_bytes = 0;
};

/// A number that vertices have besides normal, colour and texture coordinates.
struct AttributeFacts {
  std::string name;
  std::string type;       ///< "i8", "u8", "i16", "u16", "i32", "u32", "f32", "f64"
  bool is_label = false;  ///< it names something; else vertices of coarser tiles have means
};

/// The triangles that one tile of a cut draws. Vertices are those that its triangles use; where it
/// meets a tile that is shown coarser they lie where that tile has them. Lists that are not empty
/// have an element for each vertex, but for `values`, `triangles` and `image`.
struct Part {
  Node node;
  std::vector<Point> positions;
  /// The input's, or computed ones of length 1; empty if there are neither.
  std::vector<std::array<float, 3>> normals;
  /// Red, green, blue, alpha, 0 to 1, as a screen has them unless colours_are_linear(); empty if
  /// the mesh has none.
  std::vector<std::array<float, 4>> colours;
  /// Coordinates in the tile's picture, whose upper left corner is (0, 0); without pictures the
  /// input's; empty if there are neither.
  std::vector<std::array<float, 2>> texcoords;
  /// One list for each of attributes(), with an element for each vertex; NaN: no value.
  std::vector<std::vector<double>> values;
  /// Equal numbers, in all parts of a cut, are one place of the surface.
  std::vector<std::uint32_t> places;
  /// Indices of vertices of this part, each below positions.size().
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::byte> image;  ///< the picture's file; empty: there is none
  std::string image_type;        ///< "image/jpeg", "image/png", "image/webp", "image/ktx2"
};

class Cut;

/// The result of a build: many resolutions of one mesh, on disk. Copies share the facts that were
/// read, and cost nothing.
class MESHHIER_API Hierarchy {
 public:
  /// Opens a folder (scan.hier) or an archive (scan.3tz): reads manifest and index, O(tiles)
  /// memory. Throws Error(io) if it is missing or cannot be read, Error(corrupt) if it is damaged.
  explicit Hierarchy(const std::string& path);

  std::uint32_t levels() const;    ///< level 0 is one tile; levels() - 1 has the original triangles
  std::uint64_t vertices() const;  ///< the input's
  std::uint64_t triangles() const;
  Point low() const;  ///< the input's box
  Point high() const;
  Point origin() const;  ///< in the midst of the model, or 0: good to subtract before floats
  bool is_z_up() const;
  bool is_textured() const;
  bool colours_are_linear() const;
  const std::vector<AttributeFacts>& attributes() const;

  /// Returns the facts on all tiles, by level, then by index.
  const std::vector<TileFacts>& tiles() const;
  /// Returns the facts on a tile. O(log n). Throws Error(usage) if there is no such tile.
  const TileFacts& tile(Node node) const;
  /// Returns the two tiles below one; none below the finest. Throws Error(usage) if there is no
  /// such tile.
  std::vector<Node> children(Node node) const;

  /// Returns the tiles of a level, which make a cut. Throws Error(usage) if there is no such level.
  std::vector<Node> level(std::uint32_t level) const;
  /// Returns the coarsest tiles whose estimated `error` is at most this, the finest ones where no
  /// other is; they make a cut. `bound` tells how far they are at most.
  std::vector<Node> within(double error) const;
  /// Makes the cut of these tiles, which shows the model without a crack. Each finest tile must be
  /// one of them, or below exactly one; else throws Error(usage). Reads no tile. `cache_bytes`:
  /// memory for neighbours that are read.
  Cut cut(const std::vector<Node>& nodes,
          std::uint64_t cache_bytes = std::uint64_t{64} << 20) const;

 private:
  friend class Cut;
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// The parts of a cut: together all that it shows, each triangle once. It keeps the hierarchy's
/// facts, so that may go. Copies are one object: they share their cache.
class MESHHIER_API Cut {
 public:
  /// Returns the number of parts, one for each tile.
  std::size_t size() const;
  /// Returns the tile of a part. Requires position < size().
  Node node(std::size_t position) const;
  /// Reads a tile, and its neighbours that are shown coarser. Deterministic. Throws Error(usage) if
  /// position >= size(), Error(io) if a file is missing or another build has taken the hierarchy's
  /// place, Error(corrupt) if one is damaged.
  Part load(std::size_t position);

 private:
  friend class Hierarchy;
  struct Parts;
  explicit Cut(std::shared_ptr<Parts> parts) : parts_(std::move(parts)) {}
  std::shared_ptr<Parts> parts_;
};

/// The progress of a build.
struct Progress {
  std::string stage;         ///< "simplify"
  std::uint64_t done = 0;    ///< part of the stage, in `unit`s
  std::uint64_t total = 0;   ///< all of the stage; 0: unknown
  std::string unit;          ///< "tiles"
  double job_done = -1;      ///< part of the whole build, 0 to 1; -1: unknown
  double seconds_left = -1;  ///< until the end of the build; -1: unknown
};

struct BuildRequest {
  std::vector<std::string> meshes;              ///< mesh files, which are joined; or one config
  std::string output;                           ///< "scan.hier", or "scan.3tz" for one file
  std::map<std::string, std::string> settings;  ///< {"memory_budget", "2GiB"}; docs/config.md
  bool replace = false;                         ///< replaces an output that is there
  /// Is called at the start of each stage and then at most four times a second, on any thread, one
  /// call at a time. It stops the build by returning false; it must not throw. May be empty.
  std::function<bool(const Progress&)> progress;
  /// Hears a line for each thing to know, on the thread of the stage. May be empty.
  std::function<void(const std::string&)> warn;
};

/// Makes a hierarchy, which appears complete or not at all, and is the same bytes whatever threads,
/// memory and interruptions. Its memory is that of the budget, its threads those of "threads". A
/// build that was stopped, by Error(interrupted) or Error(io), goes on with the next call. If it
/// throws, the output is as it was.
MESHHIER_API void build(const BuildRequest& request);

}  // namespace meshhier::v1
