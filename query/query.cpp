#include "query/query.h"

#include "base/error.h"
#include "compare/selected_surface.h"
#include "compare/surface_samples.h"
#include "export/drawn_cut.h"
#include "mesh_io/output_name.h"
#include "partition/external_sort.h"
#include "query/asker.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/object_table.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"
#include "storage/io/spool.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

namespace meshhier::querying {
namespace {

/// The memory beside caches and sorts, about: the program, a batch with its answers and the trees
/// that it is looked up in.
constexpr std::uint64_t kFixedBytes = std::uint64_t{88} << 20;
/// Rows that are looked up together at least: enough to make the trees of their surroundings worth
/// building.
constexpr std::uint64_t kLeastBatch = 65536;
/// Rows that are looked up together at most: their places in a batch have 32 bits.
constexpr std::uint64_t kMostBatch = std::uint64_t{1} << 31;
/// A row at work takes less than half of this, with its answer, and the tiles that it asks.
constexpr std::uint64_t kSpareBytesPerRow = 768;
/// Names of objects that are kept: neighbours in a file often have the same.
constexpr std::size_t kKeptNames = 16384;

template <std::size_t Columns>
struct Row {
  std::uint64_t place_on_curve = 0, number = 0;
  std::array<double, Columns> numbers{};
};
struct ByPlace {
  template <std::size_t Columns>
  std::pair<std::uint64_t, std::uint64_t> operator()(const Row<Columns>& row) const {
    return {row.place_on_curve, row.number};
  }
};
struct ByRow {
  std::uint64_t operator()(const Answer& answer) const { return answer.row; }
};

/// Returns the memory that caches and sorts may have.
std::uint64_t spare_bytes(const QueryOptions& options) {
  return options.memory_budget - std::min(options.memory_budget, kFixedBytes);
}

void take_distance(QuerySummary& summary, double distance) {
  if (!std::isfinite(distance))
    return;
  summary.least = std::min(summary.least.value_or(distance), distance);
  summary.largest = std::max(summary.largest.value_or(distance), distance);
}

/// Names of objects, read as they are asked for.
ObjectNames names_of(std::shared_ptr<const storage::ObjectTable> table) {
  auto kept = std::make_shared<std::unordered_map<std::int64_t, std::string>>();
  return [table = std::move(table), kept](std::int64_t object) {
    if (const auto found = kept->find(object); found != kept->end())
      return found->second;
    if (kept->size() >= kKeptNames)
      kept->clear();
    std::string name = object < table->size() ? table->row(static_cast<std::uint32_t>(object)).name
                                              : std::string();
    return kept->emplace(object, std::move(name)).first->second;
  };
}

/// The rows of a query on their way to answers.
template <std::size_t Columns>
class RowRun {
 public:
  RowRun(Asker& asker, const QueryOptions& options, storage::ScratchFile& scratch,
         const BoundsD& box, execution::Progress& progress, const execution::CancelToken& cancel)
      : asker_(asker),
        options_(options),
        box_(box),
        curve_(box),
        progress_(progress),
        cancel_(cancel),
        batch_(std::min(kLeastBatch + spare_bytes(options) / kSpareBytesPerRow, kMostBatch)),
        rows_(scratch, spare_bytes(options) / 8),
        answers_(scratch, spare_bytes(options) / 8) {}

  void read(storage::FileSystem& files, QuerySummary& summary) {
    progress_.stage("read", 0, "rows");
    summary.rows = read_rows(
        files, options_.rows, options_.kind,
        [&](std::span<const double> numbers) {
          for (; !numbers.empty(); numbers = numbers.subspan(Columns))
            add(numbers.first(Columns));
        },
        [&] { cancel_.check(); });
    summary.not_asked = summary.rows - rows_.size();
  }

  void look_up(QuerySummary& summary) {
    progress_.stage("query", rows_.size(), "rows");
    rows_.sort();
    std::vector<double> numbers;
    std::vector<std::uint64_t> batch;
    const auto ask = [&] {
      std::vector<Answer> answers(batch.size());
      asker_.ask(numbers, answers, cancel_);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        answers[i].row = batch[i];
        answers_.add(answers[i]);
        take_distance(summary, answers[i].distance);
        summary.hits += answers[i].triangle >= 0 ? 1 : 0;
        summary.unknown_sides += options_.has_sides && answers[i].side == 0 ? 1 : 0;
      }
      progress_.advance(batch.size());
      numbers.clear();
      batch.clear();
    };
    rows_.for_each_block([&](std::span<const Row<Columns>> block) {
      for (const Row<Columns>& row : block) {
        batch.push_back(row.number);
        numbers.insert(numbers.end(), row.numbers.begin(), row.numbers.end());
        if (batch.size() == batch_)
          ask();
      }
    });
    ask();
    summary.tiles_read = asker_.tiles_read();
  }

  void write(AnswerWriter& writer) {
    progress_.stage("write", answers_.size(), "rows");
    answers_.sort();
    answers_.for_each_block([&](std::span<const Answer> block) {
      cancel_.check();
      writer.add(block);
      progress_.advance(block.size());
    });
    writer.finish();
  }

 private:
  void add(std::span<const double> numbers) {
    const std::uint64_t number = count_++;
    if (!asker_.can_ask(numbers)) {
      answers_.add(Answer{.row = number});
      return;
    }
    Row<Columns> row{curve_.place_of(asker_.start_of(numbers, box_)), number, {}};
    std::ranges::copy(numbers, row.numbers.begin());
    rows_.add(row);
  }

  Asker& asker_;
  const QueryOptions& options_;
  BoundsD box_;  ///< of the surface
  comparing::ZCurve curve_;
  execution::Progress& progress_;
  const execution::CancelToken& cancel_;
  std::size_t batch_;  ///< rows that are looked up together
  partition::ExternalSort<Row<Columns>, ByPlace> rows_;
  partition::ExternalSort<Answer, ByRow> answers_;
  std::uint64_t count_ = 0;
};

/// A hierarchy that is asked.
class Query {
 public:
  Query(storage::FileSystem& place, const std::filesystem::path& path, const QueryOptions& options,
        execution::Progress& progress, const execution::CancelToken& cancel)
      : options_(options),
        progress_(progress),
        cancel_(cancel),
        inside_(place, path),
        reader_(inside_.files(), path) {
    exporting::require_surface(reader_, "a query");
    if (const auto* level = std::get_if<Level>(&options.selection))
      require_level(reader_.tree(), *level);
    summary_.kind = options.kind;
    summary_.name = path.string();
    summary_.index_checksum = fmt::format("{:016x}", reader_.manifest().index_checksum);
  }

  QuerySummary run(storage::FileSystem& files, storage::OutputFile& output) {
    const std::uint64_t spare = spare_bytes(options_);
    const comparing::CutSurface surface =
        selected_surface(reader_, options_.selection, spare / 8, progress_, cancel_,
                         region_of(files, reader_, options_.piece, cancel_));
    if (options_.piece.is_any() && surface.total().triangles == 0)
      fail_empty(reader_, options_.piece);
    summary_.error_bound = comparing::error_bound(reader_, surface.cut());
    for (std::size_t i = 0; i < surface.size(); ++i)
      summary_.tiles += surface.facts(i).triangles > 0 ? 1 : 0;
    const auto asker = make_asker(
        surface, {options_.kind, options_.has_sides, reader_.manifest().origin, spare / 4});
    storage::MemoryPool pool(spare / 16);
    storage::ScratchFile scratch(files, output.scratch(), pool);
    const Bounds& box = surface.total().bounds;
    const BoundsD wide{to_double(box.min), to_double(box.max)};
    if (options_.kind == RowKind::points)
      run_rows<columns_of(RowKind::points)>(files, *asker, scratch, wide, *output.file());
    else
      run_rows<columns_of(RowKind::rays)>(files, *asker, scratch, wide, *output.file());
    output.publish();
    return summary_;
  }

 private:
  template <std::size_t Columns>
  void run_rows(storage::FileSystem& files, Asker& asker, storage::ScratchFile& scratch,
                const BoundsD& box, storage::File& file) {
    RowRun<Columns> run(asker, options_, scratch, box, progress_, cancel_);
    run.read(files, summary_);
    run.look_up(summary_);
    const bool has_objects = reader_.manifest().objects.has_value();
    const bool has_names = has_objects && options_.format == AnswerFormat::csv;
    AnswerWriter writer(file, options_.format, {options_.kind, has_objects, options_.has_sides},
                        summary_.rows,
                        has_names ? names_of(reader_.open_objects()) : ObjectNames());
    run.write(writer);
  }

  const QueryOptions& options_;
  execution::Progress& progress_;
  const execution::CancelToken& cancel_;
  storage::HierarchyFiles inside_;
  storage::HierarchyReader reader_;
  QuerySummary summary_;
};

}  // namespace

QuerySummary run_query(storage::FileSystem& place, const std::filesystem::path& path,
                       storage::FileSystem& files, const QueryOptions& options,
                       execution::Progress& progress, const execution::CancelToken& cancel) {
  Query query(place, path, options, progress, cancel);
  if (!storage::is_standard_output(files, options.output)) {
    storage::require_outside(files, options.output);
    mesh_io::require_true_ending(options.output.string(), {".csv", ".npy", ".txt"},
                                 "query writes .csv and .npy; choose one of these");
  }
  storage::OutputRequest request{options.output, options.replace, {path, options.piece.polygon}};
  if (options.rows != storage::kStandardOutput)
    request.inputs.push_back(options.rows);
  storage::OutputFile output(files, request, [&] { cancel.check(); });
  return query.run(files, output);
}

}  // namespace meshhier::querying
