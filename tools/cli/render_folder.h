// `sinew render` of a folder: a video or a picture of each, and all on one sheet.
#pragma once

#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::cli {

struct FolderRender {
  std::string input, output;  ///< folder, searched whole; directory, made where it is missing
  std::vector<std::vector<std::string>> options;  ///< that every rendering gets: name and values, each
  int jobs = 1;                                   ///< processes at once
  bool still = false;                             ///< a picture each (.png) instead of a video (.mp4)
  bool json = false;                              ///< the report on standard output
};

/// Renders every asset and source file by a process of its own, with the folder's structure, and
/// contact_sheet.png (see write_contact_sheets). `failed`: how many could not be rendered; all others are,
/// and the sheet says why. An error is of the whole.
convert::Error render_folder(const FolderRender& what, int& failed);

}  // namespace sinew::cli
