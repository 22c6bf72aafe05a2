// Options that several commands share, and texts that stand for values of the hierarchy.
#pragma once

#include "app/command.h"
#include "execution/progress.h"
#include "export/asked_region.h"
#include "export/cut_by_error.h"
#include "hierarchy/ids.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace meshhier::app {

/// A tree over less than 2^32 partitions is at most so deep. The tree itself knows its levels.
inline constexpr std::uint8_t kDeepestLevel = 32;

/// Adds --progress auto|bar|json|none.
void add_progress_option(CLI::App& command, execution::ProgressMode& mode);

/// Returns the fault of a name of a file or directory, for CLI::Option::check(): that it is empty.
std::string name_fault(const std::string& text);

/// Whether a command line has no meaning without an option.
enum class Given { always, not_always };

/// Adds -o FILE and --force, for commands that make one file.
void add_file_output_options(CLI::App& command, const std::string& help, std::string& output,
                             bool& replace, Given given = Given::always);

/// Adds -o PATH, for commands that make a hierarchy.
void add_made_hierarchy_option(CLI::App& command, std::string& output);

/// Returns the stream on which a command that writes `output` tells what it did: not standard
/// output if that is the output.
std::ostream& account_stream(const Environment& environment, const std::filesystem::path& output);

/// Throws Error(usage) if a mesh would be shown on a terminal.
void require_no_terminal(const Environment& environment, const std::filesystem::path& output);

/// --set takes all that follows it, so it swallows files that come last: items without "=" are
/// given back. Throws CLI::RequiredError if there is neither.
void give_back_files(std::vector<std::string>& settings, std::vector<std::string>& files);

/// Adds an option whose value is a size, not 0. `bytes` is its default, 0 if it has none.
CLI::Option* add_size_option(CLI::App& command, const std::string& name, const char* help,
                             std::uint64_t& bytes);
/// Adds --memory-budget SIZE. `bytes`, its default, is lowered to execution::most_budget().
void add_memory_budget_option(CLI::App& command, std::uint64_t& bytes);

/// An option whose value is an integer from `minimum` to `maximum`. Digits only: no sign, no
/// fraction.
struct IntegerOption {
  const char* name;  ///< "--cuts"
  const char* help;
  std::uint64_t minimum = 0;
  std::uint64_t maximum = 0;
};
CLI::Option* add_integer_option(CLI::App& command, const IntegerOption& option,
                                const std::function<void(std::uint64_t)>& store);

/// An option whose text `store` takes, or refuses by returning false.
struct TextOption {
  const char* name;
  const char* help;
  std::string type;      ///< "X,Y"
  std::string expected;  ///< "two numbers, X,Y"
};
CLI::Option* add_text_option(CLI::App& command, const TextOption& option,
                             const std::function<bool(const std::string&)>& store);

/// An option whose value is a name; an empty one is refused.
struct NameOption {
  std::string name;
  std::string help;
  const char* type = "FILE";
};
CLI::Option* add_name_option(CLI::App& command, const NameOption& option, std::string& value);

/// Adds --node L/I.
CLI::Option* add_node_option(CLI::App& command, const char* help, std::optional<NodeId>& node);

/// The options --level L and --node L/I, which exclude each other.
struct PlaceOptions {
  CLI::Option* level = nullptr;
  CLI::Option* node = nullptr;
};
PlaceOptions add_place_options(CLI::App& command, std::optional<Level>& level,
                               std::optional<NodeId>& node);

/// Adds a group of options to a command, without a --help of its own.
CLI::App* add_group(CLI::App& command, const char* name, const char* help);

/// Adds --error LENGTH, which asks for the coarsest tiles that are no farther from the original.
CLI::Option* add_error_option(CLI::App& command, const std::function<void(double)>& store);
/// Adds --level L and --error LENGTH to a group, of whose options at most one may be given then.
template <class Selection>
void add_detail_options(CLI::App& group, const char* level_help, Selection& selection) {
  add_integer_option(group, {"--level", level_help, 0, kDeepestLevel},
                     [&selection](std::uint64_t level) { selection = static_cast<Level>(level); });
  add_error_option(group,
                   [&selection](double error) { selection = exporting::LargestError{error}; });
  group.require_option(0, 1);
}
/// Adds --where CONDITION.
CLI::Option* add_where_option(CLI::App& command, std::string& where);
/// Adds --box X,Y,Z X,Y,Z, --polygon FILE, --crs CRS, --object NAME and --where, as a group.
CLI::App* add_region_options(CLI::App& command, exporting::RegionRequest& region);
/// Throws Error(usage) if there is neither a box nor a polygon, which `option` needs.
void require_region(const exporting::RegionRequest& region, const char* option);

/// Returns a result as text, for programs, as storage::told_json_text(): a file name on disk may
/// hold any bytes, JSON may not.
std::string pretty_json(const nlohmann::ordered_json& object);

/// Parses "3/17" as level 3, index 17; returns nothing if the text is anything else.
std::optional<NodeId> parse_node(std::string_view text);

}  // namespace meshhier::app
