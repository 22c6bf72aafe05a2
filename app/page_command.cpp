#include "app/command.h"
#include "app/hierarchy_place.h"
#include "app/options.h"
#include "app/story_pictures.h"
#include "app/viewer_place.h"
#include "app/written_file.h"
#include "base/error.h"
#include "export/page_file.h"
#include "server/static_site.h"
#include "storage/io/paths.h"
#include "storage/io/web_address.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace meshhier::app {
namespace {

namespace fs = std::filesystem;

struct PageArguments {
  std::string hierarchy;
  WebOptions web;
  std::string output;
  bool force = false;
  std::uint64_t size = exporting::PageOptions().size;
  CLI::Option* size_option = nullptr;
  std::string link;
  bool fetches_pictures = false;
  std::string viewer;
};

constexpr std::uint64_t kMostViewerBytes = std::uint64_t{64} << 20;

ViewerPlace viewer_of(Environment& environment, const PageArguments& arguments) {
  ViewerPlace viewer = find_viewer(environment.files, arguments.viewer);
  if (!viewer.folder)
    throw Error(ErrorCode::io, "page puts models into the viewer's page. " + viewer.missing);
  return viewer;
}

/// Returns the page that a hierarchy is put into.
std::string single_page(const ViewerPlace& viewer) {
  const auto file = viewer.folder->open("single.html");
  if (!file) {
    throw Error(ErrorCode::io,
                fmt::format("{} has no single.html: the viewer is of an older version; "
                            "build it again",
                            viewer.folder->path().string()));
  }
  const auto bytes = storage::read_file(*file, kMostViewerBytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Throws if an address holds a secret, as whoever gets the page reads it.
void require_link(const std::string& link) {
  if (link.empty())
    return;
  if (!storage::is_web_address(link))
    throw Error(ErrorCode::usage,
                "--link: expected the address of the whole hierarchy, https://...");
  const std::size_t host = link.find("://") + 3;
  if (link.substr(host, link.find_first_of("/?#\\", host) - host).find('@') != std::string::npos)
    throw Error(ErrorCode::usage,
                "--link: the address has a user or a password in it, which everybody would read "
                "in the page; give it without");
}

/// Returns "david" for "models/david.hier/".
std::string name_of(const fs::path& hierarchy) {
  return storage::without_last_slash(hierarchy).stem().string();
}

bool is_page_name(const std::string& output) {
  const std::string ending = storage::lower_extension(output);
  return ending == ".html" || ending == ".htm";
}

/// Throws Error(usage) for options that are only for one HTML file.
void require_folder(const PageArguments& arguments) {
  const std::array options{std::pair(!arguments.link.empty(), "--link"),
                           std::pair(arguments.fetches_pictures, "--fetch-pictures"),
                           std::pair(arguments.size_option->count() > 0, "--size"),
                           std::pair(is_page_name(arguments.output), "the name of an HTML file")};
  const auto given = std::ranges::find_if(options, &std::pair<bool, const char*>::first);
  if (given != options.end()) {
    throw Error(ErrorCode::usage, fmt::format("{} is for the page of one hierarchy; {} is a folder "
                                              "of them, and becomes a site, a folder",
                                              given->second, arguments.hierarchy));
  }
}

std::string make_page(const PageArguments& arguments, const HierarchyPlace& place,
                      execution::Progress& progress, Environment& environment) {
  require_link(arguments.link);
  const ViewerPlace viewer = viewer_of(environment, arguments);
  return exporting::write_page(
      place.files(), place.path(), single_page(viewer),
      {.output = arguments.output,
       .replace = arguments.force,
       .size = arguments.size,
       .link = arguments.link,
       .name = name_of(place.path()),
       .looks_for_story = !place.is_remote(),
       .open_picture = open_story_pictures(
           {storage::without_last_slash(place.path()).parent_path(), arguments.fetches_pictures},
           environment.cancel),
       .inputs = {viewer.folder->path()}},
      progress, environment.cancel);
}

std::string make_site(const PageArguments& arguments, execution::Progress& progress,
                      Environment& environment) {
  require_folder(arguments);
  const ViewerPlace viewer = viewer_of(environment, arguments);
  const server::SiteJob job{storage::open_folder(arguments.hierarchy), *viewer.folder,
                            arguments.output, arguments.force};
  return server::write_site(
      environment.files, job,
      {.check = [&] { environment.cancel.check(); },
       .tell = [&](const std::string& message) { progress.warn(message); },
       .begin = [&](std::uint64_t files) { progress.stage("site", files, "files"); },
       .copied = [&] { progress.advance(1); }});
}

/// Whether it is a folder of hierarchies.
bool is_folder(const HierarchyPlace& place, const Environment& environment) {
  return !place.is_remote() && environment.files.is_directory(place.path()) &&
         !environment.files.exists(place.path() / "hierarchy.json");
}

int run_page(const PageArguments& arguments, execution::ProgressMode mode,
             Environment& environment) {
  return write_file({arguments.hierarchy, arguments.web, {arguments.output}}, mode, environment,
                    [&](const HierarchyPlace& place, execution::Progress& progress) {
                      return is_folder(place, environment)
                                 ? make_site(arguments, progress, environment)
                                 : make_page(arguments, place, progress, environment);
                    });
}

constexpr const char* kPageFooter =
    R"(Of a hierarchy: one HTML file, with the viewer and as many tiles as fit, from the root down. It opens
by a double click, without a network. With --link it goes on from there when it is online.
Tiles are packed; where not all fit, positions are rounded to 16 bits if more is shown that way.
A story beside the hierarchy, NAME.hier.story.json, is told in it, with the pictures that lie there.

Of a folder: a site, with a gallery, to be copied to any host of plain files; 3tz archives among them
need one that sends parts of files (HTTP ranges).

Examples:
  meshhier page david.hier -o david.html
  meshhier page david.3tz --size 5MB --link https://example.org/david.3tz -o david.html
  meshhier page models -o site
)";

}  // namespace

void add_page_command(CLI::App& parser, Invocation& invocation) {
  const auto arguments = std::make_shared<PageArguments>();
  CLI::App* command = parser.add_subcommand(
      "page", "Make one HTML file of a hierarchy, or a site of a folder of them");
  add_hierarchy_options(*command, arguments->hierarchy, arguments->web,
                        "A directory, a 3tz archive, or the address of one of them; or a folder of "
                        "hierarchies, of which a site is made");
  add_file_output_options(*command, "The HTML file, or the folder of the site", arguments->output,
                          arguments->force);
  arguments->size_option =
      add_size_option(*command, "--size", "Of the HTML file: bytes, at the most", arguments->size);
  command->add_option("--link", arguments->link, "Of the HTML file: where all of the hierarchy is")
      ->type_name("ADDRESS");
  command->add_flag("--fetch-pictures", arguments->fetches_pictures,
                    "Of the HTML file: embed the pictures of a story that lie on other hosts, too");
  command->add_option("--viewer", arguments->viewer, "Where the page lies, if not as installed")
      ->type_name("DIR");
  add_progress_option(*command, invocation.progress);
  command->footer(kPageFooter);
  run_if_chosen(*command, invocation, arguments, run_page);
}

}  // namespace meshhier::app
