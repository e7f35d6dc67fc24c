#include "cli/definitions.h"

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "cli/files.h"
#include "cli/terminal.h"

namespace sinew::cli {
namespace {

using nlohmann::json;

std::string path_of(const std::string& parent, const CLI::App& app) {
  return parent.empty() ? app.get_name() : parent + " " + app.get_name();
}

std::vector<CLI::App*> commands_of(CLI::App& app) {
  return app.get_subcommands([](CLI::App*) { return true; });
}

std::string joined(const std::vector<ExitCode>& codes) {
  std::string text = "Exit codes:";
  for (const ExitCode& code : codes)
    text += (&code == codes.data() ? " " : ", ") + std::to_string(code.code) + " " + code.meaning;
  return text;
}

/// "TEXT:{dark,light}": what CLI11 makes of a type and its checks.
void describe_value(const std::string& type, json& out) {
  const std::size_t colon = type.find(':');
  out["value"] = type.substr(0, colon);
  out["choices"] = json::array();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) {
    if (colon != std::string::npos) out["range"] = type.substr(colon + 1);
    return;
  }
  for (std::size_t begin = open + 1; begin < close;) {
    const std::size_t end = std::min(type.find(',', begin), close);
    out["choices"].push_back(type.substr(begin, end - begin));
    begin = end + 1;
  }
}

json describe_option(const CLI::Option& option) {
  json out = {{"names", json::array()},
              {"default", option.get_default_str()},
              {"help", option.get_description()},
              {"required", option.get_required()},
              {"repeats", option.get_items_expected_max() > 1}};
  if (option.nonpositional()) {
    for (const std::string& name : option.get_snames()) out["names"].push_back("-" + name);
    for (const std::string& name : option.get_lnames()) out["names"].push_back("--" + name);
  } else {
    out["names"].push_back(option.get_name(true));
  }
  describe_value(option.get_items_expected_max() == 0 ? "" : option.get_type_name(), out);
  return out;
}

}  // namespace

std::vector<ExitCode> exit_codes(const std::string& command) {
  std::vector<ExitCode> codes = {{0, "done"}, {1, "bad input"}, {2, "usage"}};
  if (command == "study accuracy")
    codes.push_back({3, "the machine was busy: the report is there, presets are not"});
  if (command.rfind("batch", 0) == 0) codes.push_back({4, "not finished: worth running again"});
  return codes;
}

void complete_definitions(CLI::App& app, const std::string& path) {
  for (CLI::App* command : commands_of(app)) {
    const std::string below = path_of(path, *command);
    if (commands_of(*command).empty() && below != "completion" && below != "man" && below != "study")
      command->add_flag_callback("-q,--quiet", set_quiet, "no report and no progress; errors stay");
    const std::string own = command->get_footer();
    command->footer((own.empty() ? "" : own + "\n") + joined(exit_codes(below)));
    complete_definitions(*command, below);
  }
}

json describe(const CLI::App& app, const std::string& path) {
  std::string words = app.get_description(), example;
  if (const std::size_t end = words.find("\nExample"); end != std::string::npos) {
    example = words.substr(words.find(": ", end) + 2);
    words.resize(end);
  }
  json out = {{"name", app.get_name()},     {"description", words},     {"example", example},
              {"footer", app.get_footer()}, {"options", json::array()}, {"commands", json::array()},
              {"exit_codes", json::array()}};
  for (const ExitCode& code : exit_codes(path)) out["exit_codes"].push_back({code.code, code.meaning});
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) out["options"].push_back(describe_option(*option));
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty()) out["commands"].push_back(describe(*command, path_of(path, *command)));
  return out;
}

std::optional<int> parse_or_describe(CLI::App& app, int argc, char** argv) try {
  complete_definitions(app);
  if (argc == 2 && std::string_view(argv[1]) == "--describe") {
    std::puts(json_text(describe(app)).c_str());
    return 0;
  }
  app.parse(argc, argv);
  return {};
} catch (const CLI::ParseError& error) {
  return app.exit(error) == 0 ? 0 : 2;
}

void merge(json& description, const json& other) {
  const auto find = [](json& list, const char* key, const json& value) {
    return std::find_if(list.begin(), list.end(), [&](const json& item) { return item[key] == value; });
  };
  for (const json& option : other["options"])
    if (find(description["options"], "names", option["names"]) == description["options"].end() &&
        option["names"][0].get<std::string>()[0] == '-')
      description["options"].push_back(option);
  for (const json& command : other["commands"]) {
    const auto same = find(description["commands"], "name", command["name"]);
    if (same == description["commands"].end())
      description["commands"].push_back(command);
    else
      merge(*same, command);
  }
}

}  // namespace sinew::cli
