#include "server/sources.h"

#include "base/error.h"
#include "storage/io/file_checksum.h"

#include <algorithm>
#include <utility>

namespace meshhier::server {

Sources::Sources(const Inbox& inbox, const InputNotes& notes, const execution::CancelToken& cancel,
                 Warn warn)
    : inbox_(inbox),
      notes_(notes),
      cancel_(cancel),
      warn_(std::move(warn)),
      files_(storage::make_posix_file_system({false, inbox.directory()})) {}

bool Sources::is_made_of(const std::string& mesh, const storage::FileVersion& version,
                         const Model& model, Unknown unknown) {
  storage::InputNote note = note_of(model);
  const storage::NotedFiles companions = companions_of(mesh);
  known_[mesh] = {note, companions.mark(note)};
  const storage::FileIdentity noted = note.files[0].identity;
  if (!is_noted(mesh, version, note.files[0], unknown))
    return false;
  const storage::NotedFiles::Comparison others =
      companions.compare(note,
                         {.from = 1,
                          .may_read = unknown == Unknown::is_read,
                          .gone = storage::NotedFiles::Gone::is_same},
                         [&] { cancel_.check(); });
  if (!others.other && (others.was_read || !is_untouched(noted, note.files[0].identity)))
    keep_note(model, note);
  return !others.other;
}

bool Sources::is_still(const std::string& mesh, const storage::FileVersion& version) const {
  try {
    return inbox_.open(mesh, version) != nullptr;
  } catch (const Error&) {
    return false;
  }
}

std::uint64_t Sources::mark(const std::string& mesh) const {
  const auto known = known_.find(mesh);
  return known == known_.end() ? 0 : companions_of(mesh).mark(known->second.note);
}

std::uint64_t Sources::mark_when_asked(const std::string& mesh) const {
  const auto known = known_.find(mesh);
  return known == known_.end() ? 0 : known->second.mark;
}

void Sources::keep_warnings(const std::string& mesh, const Model& model,
                            std::vector<std::string> warnings) {
  storage::InputNote& note = known_[mesh].note;
  note.warnings = std::move(warnings);
  keep_note(model, note);
}

void Sources::forget_all_but(const std::vector<InboxFile>& files) {
  std::erase_if(known_, [&](const auto& known) {
    return std::ranges::find(files, known.first, &InboxFile::name) == files.end();
  });
}

/// Returns the files that the hierarchy was made of, as far as anybody has noted them: only the
/// mesh is known of one that was built by hand.
storage::InputNote Sources::note_of(const Model& model) const {
  auto note = notes_.find(model.path);
  if (note && note->content == model.source_checksum)
    return *std::move(note);
  return {model.source_checksum,
          {{model.source, {.bytes = model.mesh_bytes}, model.mesh_checksum}},
          {}};
}

/// Returns the companions of a mesh, whose paths start at its folder.
storage::NotedFiles Sources::companions_of(const std::string& mesh) const {
  return {files_->input(), (inbox_.directory() / mesh).parent_path()};
}

/// Whether the mesh is the noted file; `noted` gets its times then.
bool Sources::is_noted(const std::string& mesh, const storage::FileVersion& version,
                       storage::NotedFile& noted, Unknown unknown) const {
  const storage::FileIdentity now{version.bytes, version.modified_ns, version.changed_ns};
  if (is_untouched(now, noted.identity))
    return true;
  if (unknown == Unknown::is_another || now.bytes != noted.identity.bytes ||
      read_checksum(mesh, version) != noted.checksum)
    return false;
  noted.identity = now;
  return true;
}

/// Reads the checksum of a mesh as builds compute it.
std::uint64_t Sources::read_checksum(const std::string& mesh,
                                     const storage::FileVersion& version) const {
  const auto file = inbox_.open(mesh, version);
  const std::uint64_t checksum =
      file ? storage::FileChecksum(version.bytes).complete(*file, [&] { cancel_.check(); }) : 0;
  if (!is_still(mesh, version))
    throw Error(ErrorCode::input, "it was changed while it was read; it is looked at again");
  return checksum;
}

void Sources::keep_note(const Model& model, const storage::InputNote& note) const {
  try {
    notes_.write(model.path, note);
  } catch (const Error& error) {
    warn_(error.what());
  }
}

}  // namespace meshhier::server
