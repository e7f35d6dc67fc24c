// Finished points of a study, kept on disk as they are made: a study that was stopped goes on where it was.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace sinew::study {

/// One line of JSON per result, beside the report. What another build made is forgotten.
class ResultStore {
 public:
  /// `file` empty: keeps nothing. `build`: whose results count, see running_build().
  ResultStore(const std::string& file, const std::string& build);
  /// nullptr where it has not been made yet.
  const nlohmann::json* find(const std::string& key) const;
  void keep(const std::string& key, const nlohmann::json& result);

 private:
  std::string file_, build_;
  std::map<std::string, nlohmann::json> results_;
};

/// Size and time of the running program: changes with every build.
std::string running_build();

}  // namespace sinew::study
