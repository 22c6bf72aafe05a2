#include "import/obj_objects.h"

#include <algorithm>
#include <array>

namespace meshhier::importing {
namespace {

using mesh_io::ObjectSource;

/// A kind of statement. Those that are evident come in the order in which they are.
struct StatementRow {
  ObjLabel statement;
  ObjectSource source;
  bool is_evident;
};
constexpr std::array kStatements{StatementRow{ObjLabel::object, ObjectSource::object, true},
                                 StatementRow{ObjLabel::group, ObjectSource::group, true},
                                 StatementRow{ObjLabel::material, ObjectSource::material, false}};

}  // namespace

ObjObjects::ObjObjects(MeshObjects* objects, storage::ScratchFile& scratch) : objects_(objects) {
  if (objects_ == nullptr)
    return;
  for (const StatementRow& row : kStatements) {
    if (objects_->choice.from == row.source || (row.is_evident && objects_->choice.is_evident()))
      candidates_.emplace_back(row.statement, scratch);
  }
}

void ObjObjects::begin(ObjLabel statement, const std::string& name, std::uint64_t triangles) {
  for (Candidate& candidate : candidates_) {
    if (candidate.statement != statement)
      continue;
    close(candidate, triangles);
    candidate.now = name;
  }
}

void ObjObjects::close(Candidate& candidate, std::uint64_t triangles) {
  const std::uint64_t before = candidate.runs.triangles();
  if (triangles > before)
    candidate.runs.add(candidate.names.number(candidate.now), triangles - before);
}

void ObjObjects::finish(std::uint64_t triangles) {
  for (Candidate& candidate : candidates_)
    close(candidate, triangles);
  const auto has_several = [](const Candidate& one) { return one.names.are_different(); };
  const auto has_any = [](const Candidate& one) { return one.names.has_any(); };
  auto chosen = std::ranges::find_if(candidates_, has_several);
  if (chosen == candidates_.end())
    chosen = std::ranges::find_if(candidates_, has_any);
  if (chosen == candidates_.end())
    return;
  objects_->runs.append(chosen->runs, objects_->names.append(chosen->names));
}

}  // namespace meshhier::importing
