#include "app/options.h"

#include "app/process.h"
#include "base/error.h"
#include "base/number_text.h"
#include "execution/memory_budget.h"
#include "execution/size_text.h"
#include "storage/io/output_file.h"
#include "storage/io/told_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <ostream>
#include <string_view>

#include <fmt/format.h>

namespace meshhier::app {

namespace {

std::optional<std::uint64_t> parse_integer(std::string_view text, std::uint64_t maximum) {
  const auto value = parse_number<std::uint64_t>(text);
  return value && *value <= maximum ? value : std::nullopt;
}

[[noreturn]] void refuse(const std::string& option, std::string_view expected,
                         const std::string& found) {
  throw CLI::ValidationError(option, fmt::format("expected {}, found \"{}\"", expected, found));
}

Vec3d parse_corner(const std::string& text) {
  std::array<double, 3> numbers{};
  std::string_view left = text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t comma = i + 1 < numbers.size() ? left.find(',') : left.size();
    const auto number = parse_number<double>(left.substr(0, comma));
    if (!number || !std::isfinite(*number))
      refuse("--box", "two corners X,Y,Z", text);
    numbers[i] = *number;
    left.remove_prefix(
        std::min(comma == std::string_view::npos ? left.size() : comma + 1, left.size()));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

CLI::Option* add_error_option(CLI::App& command, const std::function<void(double)>& store) {
  const auto take = [store](const std::string& text) {
    const auto error = parse_number<double>(text);
    if (!error || !(*error >= 0))
      refuse("--error", "a number of 0 or more, in the units of the input", text);
    store(*error);
  };
  return command
      .add_option_function<std::string>(
          "--error", take, "The coarsest tiles that are no farther than this from the original")
      ->type_name("LENGTH");
}

CLI::App* add_group(CLI::App& command, const char* name, const char* help) {
  CLI::App* group = command.add_option_group(name, help);
  group->set_help_flag();
  return group;
}

CLI::Option* add_where_option(CLI::App& command, std::string& where) {
  return command
      .add_option("--where", where,
                  "Objects that meet a condition, as SQL has them: \"storey = 3 and area > 20\"; "
                  "inspect lists their properties")
      ->type_name("CONDITION")
      ->check([](const std::string& text) {
        return text.empty() ? "expected a condition, found nothing" : "";
      });
}

CLI::App* add_region_options(CLI::App& command, exporting::RegionRequest& region) {
  const auto take = [&region](const std::vector<std::string>& corners) {
    region.box = BoundsD{parse_corner(corners[0]), parse_corner(corners[1])};
  };
  CLI::App* group = add_group(command, "Where", "A piece; else all");
  CLI::Option* box = group->add_option_function<std::vector<std::string>>(
      "--box", take, "What lies between these two corners, in the input's coordinates");
  box->type_name("X,Y,Z")->expected(2);
  CLI::Option* polygon = group->add_option_function<std::string>(
      "--polygon", [&region](const std::string& file) { region.polygon = file; },
      "What lies in these polygons (GeoJSON), seen from above");
  polygon->type_name("FILE")->check(name_fault);
  group
      ->add_option("--crs", region.crs,
                   "The map that x and y of these are of (\"EPSG:4326\": degrees); heights stay "
                   "the input's")
      ->type_name("CRS");
  group
      ->add_option("--object", region.objects.names,
                   "The object of this name; repeated: all of these. A name that ends in / stands "
                   "for all that begin with it")
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_where_option(*group, region.objects.where);
  return group;
}

void require_region(const exporting::RegionRequest& region, const char* option) {
  if (!region.has_border())
    throw Error(ErrorCode::usage, std::string(option) + " needs --box or --polygon");
}

std::string pretty_json(const nlohmann::ordered_json& object) {
  return storage::told_json_text(object, {.indent = 2}) + '\n';
}

std::optional<NodeId> parse_node(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos)
    return std::nullopt;
  const auto level = parse_integer(text.substr(0, slash), kDeepestLevel);
  const auto index =
      parse_integer(text.substr(slash + 1), std::numeric_limits<std::uint32_t>::max());
  if (!level || !index)
    return std::nullopt;
  return NodeId{static_cast<Level>(*level), static_cast<std::uint32_t>(*index)};
}

void add_progress_option(CLI::App& command, execution::ProgressMode& mode) {
  using execution::ProgressMode;
  const std::map<std::string, ProgressMode> modes{{"auto", ProgressMode::automatic},
                                                  {"bar", ProgressMode::bar},
                                                  {"json", ProgressMode::json},
                                                  {"none", ProgressMode::none}};
  const auto store = [&mode, modes](const std::string& text) {
    const auto found = modes.find(text);
    if (found == modes.end())
      refuse("--progress", "auto, bar, json or none", text);
    mode = found->second;
  };
  command
      .add_option_function<std::string>(
          "--progress", store,
          "How far the work is, on standard error: a bar, JSON lines, or nothing; auto: "
          "a bar if standard error is a terminal [auto]")
      ->type_name("auto|bar|json|none");
}

std::string name_fault(const std::string& text) {
  return text.empty() ? "expected a name, found nothing" : "";
}

CLI::Option* add_name_option(CLI::App& command, const NameOption& option, std::string& value) {
  return command.add_option(option.name, value, option.help)
      ->type_name(option.type)
      ->check(name_fault);
}

void add_file_output_options(CLI::App& command, const std::string& help, std::string& output,
                             bool& replace, Given given) {
  add_name_option(command, {"-o,--output", help + "; \"-\" is standard output"}, output)
      ->required(given == Given::always);
  command.add_flag("--force", replace, "Replace an existing file");
}

void add_made_hierarchy_option(CLI::App& command, std::string& output) {
  add_name_option(
      command,
      {"-o,--output", "The hierarchy to make: a directory, or one file if it ends in .3tz", "PATH"},
      output);
}

std::ostream& account_stream(const Environment& environment, const std::filesystem::path& output) {
  return storage::is_standard_output(environment.files, output) ? environment.messages
                                                                : environment.out;
}

void require_no_terminal(const Environment& environment, const std::filesystem::path& output) {
  if (storage::is_standard_output(environment.files, output) && output_is_terminal()) {
    throw Error(ErrorCode::usage,
                "a terminal cannot show this; send standard output to a file or a program");
  }
}

CLI::Option* add_size_option(CLI::App& command, const std::string& name, const char* help,
                             std::uint64_t& bytes) {
  const auto store = [name, &bytes](const std::string& text) {
    const std::optional<std::uint64_t> parsed = execution::parse_size(text);
    if (!parsed || *parsed == 0)
      refuse(name.c_str(), execution::kSizeSyntax, text);
    bytes = *parsed;
  };
  const std::string text =
      bytes > 0 ? fmt::format("{} [{}]", help, execution::exact_size_text(bytes)) : help;
  return command.add_option_function<std::string>(name, store, text)->type_name("SIZE");
}

void give_back_files(std::vector<std::string>& settings, std::vector<std::string>& files) {
  const auto given = std::stable_partition(
      settings.begin(), settings.end(),
      [](const std::string& item) { return item.find('=') != std::string::npos; });
  files.insert(files.end(), given, settings.end());
  settings.erase(given, settings.end());
  if (files.empty() && settings.empty())
    throw CLI::RequiredError("A mesh or a config");
}

void add_memory_budget_option(CLI::App& command, std::uint64_t& bytes) {
  add_size_option(command, "--memory-budget", "Memory it may use", bytes);
  bytes = std::min(bytes, execution::most_budget());
}

CLI::Option* add_integer_option(CLI::App& command, const IntegerOption& option,
                                const std::function<void(std::uint64_t)>& store) {
  const auto checked = [option, store](const std::string& text) {
    const std::optional<std::uint64_t> value = parse_integer(text, option.maximum);
    if (!value || *value < option.minimum) {
      refuse(option.name, fmt::format("an integer from {} to {}", option.minimum, option.maximum),
             text);
    }
    store(*value);
  };
  return command.add_option_function<std::string>(option.name, checked, option.help)
      ->type_name("N");
}

CLI::Option* add_text_option(CLI::App& command, const TextOption& option,
                             const std::function<bool(const std::string&)>& store) {
  return command
      .add_option_function<std::string>(
          option.name,
          [option, store](const std::string& text) {
            if (!store(text)) {
              throw CLI::ValidationError(
                  option.name, fmt::format("expected {}, found \"{}\"", option.expected, text));
            }
          },
          option.help)
      ->type_name(option.type);
}

CLI::Option* add_node_option(CLI::App& command, const char* help, std::optional<NodeId>& node) {
  const auto store = [&node](const std::string& text) {
    node = parse_node(text);
    if (!node)
      refuse("--node", "a node as LEVEL/INDEX, for example 3/5", text);
  };
  return command.add_option_function<std::string>("--node", store, help)->type_name("L/I");
}

PlaceOptions add_place_options(CLI::App& command, std::optional<Level>& level,
                               std::optional<NodeId>& node) {
  PlaceOptions options;
  options.level =
      add_integer_option(command, {"--level", "One level; 0 is the whole model", 0, kDeepestLevel},
                         [&level](std::uint64_t value) { level = static_cast<Level>(value); });
  options.level->type_name("L");
  options.node = add_node_option(command, "One node: its level and index", node);
  options.node->excludes(options.level);
  return options;
}

}  // namespace meshhier::app
