// A folder of hierarchies as a site for any host of plain files.
#pragma once

#include "storage/io/file.h"
#include "storage/io/folder.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace meshhier::server {

struct SiteJob {
  std::shared_ptr<const storage::Folder> models;  ///< the folder with the hierarchies
  const storage::Folder& viewer;                  ///< the page
  std::filesystem::path output;
  bool replace = false;  ///< a site that is there
};

struct SiteProgress {
  std::function<void()> check;                     ///< called before each block; may throw
  std::function<void(const std::string&)> tell;    ///< hears why a model is left out
  std::function<void(std::uint64_t files)> begin;  ///< hears how many will be copied, at the most
  std::function<void()> copied;                    ///< called after each file
};

/// Copies the page, the hierarchies and their archives, and lists them: a gallery at index.html.
/// The site appears complete or not at all. Returns a line for people. Throws Error(usage) if there
/// is no hierarchy, or the site would lie among them, Error(exists) if there is something that is
/// not to be replaced or no site, Error(io).
std::string write_site(storage::FileSystem& files, const SiteJob& job,
                       const SiteProgress& progress);

}  // namespace meshhier::server
