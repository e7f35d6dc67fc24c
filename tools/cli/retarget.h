// `sinew retarget`: clips of one character for another.
#pragma once

#include <string>
#include <vector>

#include "convert/convert.h"

namespace CLI {
class App;
}

namespace sinew::cli {

struct RetargetCommand {
  std::vector<std::string> clips;  ///< files: assets or sources
  std::string from;                ///< the character that they are for, where the files do not hold it
  std::string to, output, map_file, report_file, time = "keep";
  std::vector<std::string> names;  ///< of the clips wanted
  bool keep = false, no_plant = false, json = false;

  void add(CLI::App& app);
  convert::Error run() const;
};

}  // namespace sinew::cli
