// The arguments of `build`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::app {

struct BuildArguments {
  std::vector<std::string> named;  ///< a config, or meshes; with `each` any of both
  std::string output;
  std::vector<std::string> settings;
  std::string stats;       ///< file for the account; empty: none
  std::string input_note;  ///< file for the names of the files that were read; empty: none
  bool force = false;
  bool update = false;         ///< builds only what is not of this input, config and program
  bool restart = false;        ///< throws away what a stopped build left
  bool restart_other = false;  ///< does so if that is of another config or input
  bool verbose = false;        ///< also the account
  bool no_links = false;
  std::string within;  ///< the folder that holds all input; empty: anywhere
  bool each = false;   ///< each of `named` becomes a hierarchy of its own
  std::uint64_t jobs = 1;
  bool dry_run = false;
  bool json = false;         ///< the estimate as JSON
  std::string help_config;   ///< a form of key_references(), or empty
  std::string help_formats;  ///< a form of format_references(), or empty
};

}  // namespace meshhier::app
