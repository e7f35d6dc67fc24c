#include "cli/completion.h"

#include <algorithm>
#include <functional>

namespace sinew::cli {
namespace {

using nlohmann::json;

bool is_flag(const json& option) {
  return option["value"].get<std::string>().empty();
}

bool is_positional(const json& option) {
  return option["names"][0].get<std::string>()[0] != '-';
}

std::string words(const json& list, const char* between = " ") {
  std::string out;
  for (const json& word : list) out += (out.empty() ? "" : between) + word.get<std::string>();
  return out;
}

/// Every command, by what has to be typed for it ("", "convert", "graph check").
void each_command(const json& command, const std::string& path,
                  const std::function<void(const std::string&, const json&)>& visit) {
  visit(path, command);
  for (const json& below : command["commands"])
    each_command(below, (path.empty() ? "" : path + " ") + below["name"].get<std::string>(), visit);
}

/// In single quotes, as shells want it. Fish reads \' within them, others do not.
std::string quoted(const std::string& text, const char* quote = "'\\''") {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string(quote) : std::string(1, c);
  return out + "'";
}

std::string for_bash(const json& program) {
  std::string commands, values, lists;
  each_command(program, "", [&](const std::string& path, const json& command) {
    std::string list;
    for (const json& below : command["commands"]) {
      const std::string name = below["name"];
      const std::string full = (path.empty() ? "" : path + " ") + name;
      commands += "      \"" + path + "|" + name + "\") command=\"" + full + "\" ;;\n";
      list += name + " ";
    }
    std::string options;
    for (const json& option : command["options"]) {
      if (!is_positional(option)) options += words(option["names"]) + " ";
      if (is_flag(option)) continue;
      std::string what = "compopt -o default";
      if (!option["choices"].empty()) what = "_sinew_words \"" + words(option["choices"]) + "\"";
      if (option["value"] == "DIR")
        what = "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- \"$current\")";
      if (is_positional(option)) {
        if (!option["choices"].empty()) list += words(option["choices"]) + " ";
        continue;
      }
      std::string cases;
      for (const json& name : option["names"])
        cases += (cases.empty() ? "" : " | ") + ("\"" + path + "|" + name.get<std::string>() + "\"");
      values += "    " + cases + ") " + what + "; return ;;\n";
    }
    lists += "    \"" + path + "\") options=\"" + options + "\" words=\"" + list + "\" ;;\n";
  });
  return "# Completion of sinew in bash. Made by `sinew completion bash`.\n"
         "_sinew_words() {\n  mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"$current\")\n}\n"
         "_sinew() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command=\"\" "
         "options words i\n"
         "  COMPREPLY=()\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    case \"$command|${COMP_WORDS[i]}\" in\n" +
         commands +
         "    esac\n  done\n"
         "  case \"$command|$previous\" in\n" +
         values +
         "  esac\n"
         "  case \"$command\" in\n" +
         lists +
         "  esac\n"
         "  if [[ $current == -* ]]; then\n    _sinew_words \"$options\"\n"
         "  elif [[ -n $words ]]; then\n    _sinew_words \"$words\"\n"
         "  else\n    compopt -o default\n  fi\n"
         "}\n"
         "complete -F _sinew sinew\n";
}

/// A text within the brackets of zsh's _arguments.
std::string in_brackets(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string zsh_action(const json& option) {
  if (!option["choices"].empty()) return "(" + words(option["choices"]) + ")";
  if (option["value"] == "DIR") return "_files -/";
  return option["value"] == "FILE" || is_positional(option) ? "_files" : " ";
}

/// What _arguments is told of an option, once for each of its names.
std::string zsh_arguments(const json& option) {
  const std::string value =
      is_flag(option) ? "" : ":" + in_brackets(option["value"]) + ":" + zsh_action(option);
  const std::string often = option["repeats"] == true ? "*" : "";
  constexpr const char* kNext = " \\\n    ";
  if (is_positional(option)) return kNext + quoted(often + value);
  std::string out;
  for (const json& name : option["names"])
    out += kNext + quoted(often + name.get<std::string>() + "[" + in_brackets(option["help"]) + "]" + value);
  return out;
}

std::string zsh_function(const std::string& path) {
  std::string name = "_sinew";
  if (!path.empty()) name += "_" + path;
  for (char& c : name)
    if (c == ' ') c = '_';
  return name;
}

std::string for_zsh(const json& program) {
  std::string out = "#compdef sinew\n# Completion of sinew in zsh. Made by `sinew completion zsh`.\n";
  each_command(program, "", [&](const std::string& path, const json& command) {
    out += zsh_function(path) +
           "() {\n  local context state state_descr line\n  typeset -A opt_args\n  _arguments -C";
    for (const json& option : command["options"]) out += zsh_arguments(option);
    if (command["commands"].empty()) {
      out += "\n}\n";
      return;
    }
    out +=
        " \\\n    '1:command:->command' \\\n    '*::argument:->argument'\n  case $state in\n    command)\n   "
        "   local -a commands\n"
        "      commands=(";
    for (const json& below : command["commands"])
      out +=
          "\n        " + quoted(below["name"].get<std::string>() + ":" + in_brackets(below["description"]));
    out += ")\n      _describe command commands ;;\n    argument)\n      case $words[1] in\n";
    for (const json& below : command["commands"]) {
      const std::string name = below["name"];
      out += "        " + name + ") " + zsh_function((path.empty() ? "" : path + " ") + name) + " ;;\n";
    }
    out += "      esac ;;\n  esac\n}\n";
  });
  return out + "if [[ $funcstack[1] == _sinew ]]; then\n  _sinew \"$@\"\nelse\n  compdef _sinew sinew\nfi\n";
}

std::string fish_condition(const std::string& path) {
  if (path.empty()) return "__fish_use_subcommand";
  std::string out;
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find(' ', begin), path.size());
    out += (out.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + path.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

std::string for_fish(const json& program) {
  std::string out = "# Completion of sinew in fish. Made by `sinew completion fish`.\n";
  each_command(program, "", [&](const std::string& path, const json& command) {
    const std::string begin = "complete -c sinew -n " + quoted(fish_condition(path));
    std::string names;
    for (const json& below : command["commands"]) names += " " + below["name"].get<std::string>();
    for (const json& below : command["commands"]) {
      const std::string not_yet =
          path.empty() ? fish_condition(path)
                       : fish_condition(path) + "; and not __fish_seen_subcommand_from" + names;
      out += "complete -c sinew -f -n " + quoted(not_yet) + " -a " + below["name"].get<std::string>() +
             " -d " + quoted(below["description"], "\\'") + "\n";
    }
    for (const json& option : command["options"]) {
      if (is_positional(option)) {
        if (!option["choices"].empty()) out += begin + " -f -a " + quoted(words(option["choices"])) + "\n";
        continue;
      }
      out += begin;
      for (const json& name : option["names"]) {
        const std::string text = name;
        out += text[1] == '-' ? " -l " + text.substr(2) : " -s " + text.substr(1);
      }
      if (!option["choices"].empty())
        out += " -x -a " + quoted(words(option["choices"]));
      else if (option["value"] == "DIR")
        out += " -x -a " + quoted("(__fish_complete_directories)");
      else if (!is_flag(option))
        out += option["value"] == "FILE" ? " -r" : " -x";
      out += " -d " + quoted(option["help"], "\\'") + "\n";
    }
  });
  return out;
}

}  // namespace

std::string completion(const std::string& shell, const json& description) {
  return shell == "bash"  ? for_bash(description)
         : shell == "zsh" ? for_zsh(description)
                          : for_fish(description);
}

}  // namespace sinew::cli
