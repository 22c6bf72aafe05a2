// The pictures that a story names: beside it, and on the web if they may be fetched.
#pragma once

#include "execution/cancel.h"
#include "export/page_story.h"

#include <filesystem>

namespace meshhier::app {

/// Where pictures of a story may lie.
struct PictureSources {
  std::filesystem::path beside;  ///< the folder of the story
  bool fetches = false;          ///< pictures of other hosts are fetched, else refused
};

/// Returns a function that opens pictures in the folder or below it, by relative addresses; no link
/// is followed, no hidden name is opened. A host gets 20 seconds for a picture, all hosts two
/// minutes. `cancel` must outlive the result.
exporting::OpenPicture open_story_pictures(const PictureSources& pictures,
                                           const execution::CancelToken& cancel);

}  // namespace meshhier::app
