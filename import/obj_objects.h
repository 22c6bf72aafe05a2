// Objects of an OBJ file: its statements o, g or usemtl.
#pragma once

#include "import/obj_labels.h"
#include "import/object_names.h"

#include <cstdint>
#include <list>
#include <string>

namespace meshhier::importing {

/// Follows the statements of a file.
class ObjObjects {
 public:
  /// `objects`: of the mesh; null: nobody asks.
  ObjObjects(MeshObjects* objects, storage::ScratchFile& scratch);

  bool are_asked() const { return !candidates_.empty(); }
  /// Takes a statement behind so many triangles of the file.
  void begin(ObjLabel statement, const std::string& name, std::uint64_t triangles);
  /// Adds the objects of the file's triangles to the mesh's: where they are evident, those of
  /// statements o, or else g, with two names or more, or with one.
  void finish(std::uint64_t triangles);

 private:
  /// Objects that statements of a kind make.
  struct Candidate {
    Candidate(ObjLabel kind, storage::ScratchFile& scratch)
        : statement(kind), names(scratch), runs(scratch) {}

    ObjLabel statement;
    ObjectNames names;
    ObjectRuns runs;
    std::string now{};  ///< name of the triangles from here on
  };

  static void close(Candidate& candidate, std::uint64_t triangles);

  MeshObjects* objects_;
  std::list<Candidate> candidates_;
};

}  // namespace meshhier::importing
