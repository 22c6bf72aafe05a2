#include "app/build_help.h"

#include "config/config_reference.h"
#include "mesh_io/formats.h"
#include "mesh_io/input_folder.h"

namespace meshhier::app {

const References& key_references() {
  static const References all = {{"text", config::keys_text},
                                 {"schema", config::schema_text},
                                 {"markdown", config::keys_markdown}};
  return all;
}

const References& format_references() {
  static const References all = {{"text", config::formats_text},
                                 {"json", config::formats_json},
                                 {"markdown", config::formats_markdown}};
  return all;
}

std::string build_footer() {
  return "FILE is a mesh: a " + mesh_io::format_names() +
         R"(, perhaps in gzip, a tileset.json or .3tz, or a folder with
)" + mesh_io::folder_names() +
         R"(. The hierarchy of scan.ply is made beside it, as scan.hier,
unless -o names another. Several meshes are joined. --set changes the keys of a config;
`meshhier build --help-config` says what they mean.

FILE may be a config instead, for jobs to be repeated: JSON with // comments. It needs "input" (a
mesh, or a list of meshes) and "output", both relative to the config. With all defaults:

)" + config::defaults_text() +
         R"(
Examples:
  meshhier build david.ply
  meshhier build david.ply -o models/david.hier --force
  meshhier build david.ply --dry-run
  meshhier build david.obj.gz -o david.3tz --set memory_budget=256MiB
  meshhier build left.obj.gz right.obj.gz -o both.hier --set weld=true
  meshhier build david.ply --set storage.compression=meshopt_zlib storage.positions.bits=16
  meshhier build project/ -o project.hier
  meshhier build david.json
  meshhier build david.json --set partition.count=128 -o coarse.hier --stats coarse.json
  meshhier build --each scans/*.ply -o models/ --jobs 2 --update
)";
}

}  // namespace meshhier::app
