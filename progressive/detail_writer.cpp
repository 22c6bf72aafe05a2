#include "progressive/detail_writer.h"

#include "execution/parallel.h"
#include "execution/spool_cursor.h"
#include "hierarchy/detail.h"
#include "progressive/detail_file.h"
#include "progressive/residual.h"
#include "storage/io/hash.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

namespace meshhier::progressive {
namespace {

/// A run on its way to the file.
struct RunSlot {
  DetailRun run;
  std::uint64_t first = 0;  ///< least index it could begin with
  std::vector<std::byte> bytes;
};

/// Packs runs in parallel and writes them in order.
class RunWriter {
 public:
  RunWriter(storage::FileSystem& files, const std::filesystem::path& path, const DetailSpan& span,
            const DetailSource& source)
      : file_(files.create(path)),
        packing_(
            source.runs_in_flight,
            [layout = source.layout](RunSlot& slot) {
              slot.bytes = progressive::encode_run(slot.run, layout, slot.first);
            },
            [this](RunSlot& slot) { write(slot.bytes); }) {
    write(progressive::detail_head(span.step));
  }

  void put(DetailRun run, std::uint64_t first) {
    RunSlot& slot = packing_.next();
    slot.run = std::move(run);
    slot.first = first;
  }

  /// Ends the file; returns its size and checksum.
  progressive::ProgressiveFile finish() {
    packing_.finish();
    progressive::ProgressiveFile sealed;
    sealed.bytes = place_;
    sealed.checksum = checksum_.value();
    return sealed;
  }

 private:
  void write(std::span<const std::byte> bytes) {
    file_->write_at(place_, bytes);
    checksum_.add(bytes);
    place_ += bytes.size();
  }

  std::unique_ptr<storage::File> file_;
  std::uint64_t place_ = 0;
  storage::Checksum checksum_;
  execution::BatchedWork<RunSlot> packing_;
};

/// Gathers the entries of one list into runs.
template <class Run>
class ListWriter {
 public:
  ListWriter(RunWriter& writer, execution::Progress& progress)
      : writer_(writer), progress_(progress) {}

  bool begins_run() const { return run_.indices.empty(); }

  /// Adds an entry; `fill(run)` appends the rest of it.
  template <class Fill>
  void add(std::uint64_t index, const Fill& fill) {
    run_.indices.push_back(static_cast<typename decltype(run_.indices)::value_type>(index));
    fill(run_);
    if (run_.indices.size() == kRunEntries)
      end_run();
  }

  /// Ends the list; returns how many entries there were.
  std::uint64_t finish() {
    end_run();
    return count_;
  }

 private:
  void end_run() {
    if (run_.indices.empty())
      return;
    const std::uint64_t entries = run_.indices.size();
    const std::uint64_t behind = std::uint64_t{run_.indices.back()} + 1;
    writer_.put(std::exchange(run_, {}), std::exchange(first_, behind));
    count_ += entries;
    progress_.advance(entries);
  }

  RunWriter& writer_;
  execution::Progress& progress_;
  Run run_;
  std::uint64_t first_ = 0;
  std::uint64_t count_ = 0;
};

/// Merges ascending lists of several levels into one.
template <class Record>
class MergedLists {
 public:
  void add(const storage::RecordSpool<Record>& list, const execution::CancelToken& cancel) {
    lists_.push_back({execution::SpoolCursor<Record>(list, cancel), 0});
  }

  /// Returns the list whose next entry is the least by `key`; nothing at the end.
  template <class Key>
  std::optional<std::size_t> least(const Key& key) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < lists_.size(); ++i) {
      if (lists_[i].next < lists_[i].cursor.size() && (!found || key(peek(i)) < key(peek(*found))))
        found = i;
    }
    return found;
  }
  const Record& peek(std::size_t list) { return lists_[list].cursor.at(lists_[list].next); }
  std::uint64_t take(std::size_t list) { return lists_[list].next++; }

 private:
  struct List {
    execution::SpoolCursor<Record> cursor;
    std::uint64_t next = 0;
  };
  std::vector<List> lists_;
};

/// Reads the values of entries that are asked for in their order.
class ValueCursor {
 public:
  ValueCursor(const storage::RecordSpool<float>& values, std::size_t width,
              const execution::CancelToken& cancel)
      : cursor_(values, cancel), entry_(width) {}

  /// Returns the values of an entry, valid until the next call.
  std::span<const float> at(std::uint64_t entry) {
    for (std::size_t i = 0; i < entry_.size(); ++i)
      entry_[i] = cursor_.at(entry * entry_.size() + i);
    return entry_;
  }

 private:
  execution::SpoolCursor<float> cursor_;
  std::vector<float> entry_;
};

/// Finds the vertices that stand for corners on a level, asked for in ascending order.
class StandInCursor {
 public:
  StandInCursor(const LevelLists& level, std::size_t width, const execution::CancelToken& cancel)
      : entries_(level.stand_ins, cancel), values_(level.stand_in_values, width, cancel) {}

  /// Returns the rank of the vertex that stands for the corner; nothing if none does.
  std::optional<std::uint32_t> find(std::uint32_t rank) {
    while (next_ < entries_.size() && entries_.at(next_).rank < rank)
      ++next_;
    if (next_ == entries_.size() || entries_.at(next_).rank != rank)
      return std::nullopt;
    return entries_.at(next_).stands;
  }
  /// Returns the values of the vertex that was found last.
  std::span<const float> values() { return values_.at(next_); }

 private:
  execution::SpoolCursor<StandIn> entries_;
  ValueCursor values_;
  std::uint64_t next_ = 0;
};

class DetailWriter {
 public:
  DetailWriter(const DetailSpan& span, const DetailSource& source, RunWriter& writer,
               execution::Progress& progress, const execution::CancelToken& cancel)
      : span_(span),
        source_(source),
        width_(static_cast<std::size_t>(vertex_values(source.layout))),
        writer_(writer),
        progress_(progress),
        cancel_(cancel) {}

  /// Writes list 1: the vertices that the levels of the span lost; then the foreign corners that
  /// have moved.
  std::uint64_t write_vertices() {
    ListWriter<VertexRun> list(writer_, progress_);
    before_.assign(width_, 0);
    MergedLists<std::uint32_t> lost;
    std::vector<ValueCursor> values;
    for (std::size_t level = first_level(); level <= raw(span_.fine); ++level) {
      lost.add(source_.lists[level].lost_ranks, cancel_);
      values.emplace_back(source_.lists[level].lost_values, width_, cancel_);
    }
    std::optional<StandInCursor> known = known_before();
    while (const auto level = lost.least(std::identity{})) {
      const std::uint32_t rank = lost.peek(*level);
      const bool is_known = known && known->find(rank);
      add_vertex(list, index_of(rank), values[*level].at(lost.take(*level)),
                 is_known ? known->values() : std::span<const float>());
    }
    write_foreign(list);
    return list.finish();
  }

  std::uint64_t write_triangles() {
    ListWriter<TriangleRun> list(writer_, progress_);
    MergedLists<LostTriangle> lost;
    for (std::size_t level = first_level(); level <= raw(span_.fine); ++level)
      lost.add(source_.lists[level].lost_triangles, cancel_);
    while (const auto level = lost.least([](const LostTriangle& t) { return t.index(); })) {
      const LostTriangle triangle = lost.peek(*level);
      lost.take(*level);
      list.add(triangle.index(), [&](TriangleRun& run) {
        run.corners.push_back({index_of(triangle.corners[0]), index_of(triangle.corners[1]),
                               index_of(triangle.corners[2])});
      });
    }
    return list.finish();
  }

  /// Writes list 3: corners that another vertex stands for than before, or that were no corners
  /// before.
  std::uint64_t write_merges() {
    ListWriter<MergeRun> list(writer_, progress_);
    execution::SpoolCursor<StandIn> now(source_.lists[raw(span_.fine)].stand_ins, cancel_);
    std::optional<StandInCursor> known = known_before();
    for (std::uint64_t i = 0; i < now.size(); ++i) {
      const StandIn entry = now.at(i);
      if (known && known->find(entry.rank) == entry.stands)
        continue;
      list.add(index_of(entry.rank),
               [&](MergeRun& run) { run.targets.push_back(index_of(entry.stands)); });
    }
    return list.finish();
  }

 private:
  std::size_t first_level() const {
    return span_.coarse ? raw(*span_.coarse) + std::size_t{1} : raw(span_.fine);
  }

  /// Returns the stand-ins of the corners with the files before this one; nothing for the base.
  std::optional<StandInCursor> known_before() const {
    if (!span_.coarse)
      return std::nullopt;
    return std::optional<StandInCursor>(std::in_place, source_.lists[raw(*span_.coarse)], width_,
                                        cancel_);
  }

  /// Returns a vertex's index in the stream: own vertices by rank, then foreign ones.
  std::uint32_t index_of(std::uint32_t rank) const {
    const progressive::Sector& sector = source_.sector;
    const auto first = static_cast<std::uint32_t>(sector.ranks.begin);
    if (sector.has_rank(rank))
      return rank - first;
    return static_cast<std::uint32_t>(sector.ranks.size() + source_.all_foreign.find(rank));
  }

  /// Adds a vertex. `known`: the values that the client has in its slot; empty: none.
  void add_vertex(ListWriter<VertexRun>& list, std::uint32_t index, std::span<const float> values,
                  std::span<const float> known) {
    if (list.begins_run())
      std::ranges::fill(before_, 0.0F);
    const std::span<const float> predicted =
        known.empty() ? std::span<const float>(before_) : known;
    list.add(index, [&](VertexRun& run) {
      run.residuals.resize(run.residuals.size() + width_);
      progressive::find_residuals(source_.layout, values, predicted,
                                  std::span(run.residuals).last(width_));
    });
    before_.assign(values.begin(), values.end());
  }

  void write_foreign(ListWriter<VertexRun>& list) {
    const ForeignCorners& now = source_.fine_foreign;
    const ForeignCorners& before = source_.coarse_foreign;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const std::size_t known = before.find(now.rank(i));
      const auto place = known < before.size() ? before.values(known) : std::span<const float>();
      if (!same_bits(place, now.values(i)))
        add_vertex(list, index_of(now.rank(i)), now.values(i), place);
    }
  }

  static bool same_bits(std::span<const float> a, std::span<const float> b) {
    return std::ranges::equal(std::as_bytes(a), std::as_bytes(b));
  }

  const DetailSpan& span_;
  const DetailSource& source_;
  std::size_t width_;
  RunWriter& writer_;
  execution::Progress& progress_;
  const execution::CancelToken& cancel_;
  std::vector<float> before_;  ///< values of the last vertex of the run
};

}  // namespace

progressive::ProgressiveFile write_detail(storage::FileSystem& files,
                                          const std::filesystem::path& path, const DetailSpan& span,
                                          const DetailSource& source, execution::Progress& progress,
                                          const execution::CancelToken& cancel) {
  RunWriter runs(files, path, span, source);
  DetailWriter writer(span, source, runs, progress, cancel);
  const std::uint64_t vertices = writer.write_vertices();
  const std::uint64_t triangles = writer.write_triangles();
  const std::uint64_t merges = writer.write_merges();
  progressive::ProgressiveFile file = runs.finish();
  file.level = span.fine;
  file.vertices = vertices;
  file.triangles = triangles;
  file.merges = merges;
  return file;
}

}  // namespace meshhier::progressive
