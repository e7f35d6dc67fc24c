// What every command has in common: help, defaults, completion, man pages, colours, silence, words for
// faults.
#include <cstdlib>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "cli/command.h"
#include "fixtures/paths.h"

namespace sinew::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kAsset = binary_dir() + "/sample.sinew";
/// Every command with its options, as the programs parse them.
struct Command {
  std::string path;
  json what;
};

void collect(const json& command, const std::string& path, std::vector<Command>& all) {
  all.push_back({path, command});
  for (const json& below : command["commands"])
    collect(below, path + (path.empty() ? "" : " ") + below["name"].get<std::string>(), all);
}

const std::vector<Command>& commands() {
  static const std::vector<Command> kAll = [] {
    std::vector<Command> all;
    collect(json::parse(sinew("--describe").out), "", all);
    return all;
  }();
  return kAll;
}

void each_option(const std::function<void(const Command&, const json&)>& visit) {
  for (const Command& command : commands())
    for (const json& option : command.what["options"]) visit(command, option);
}

bool is_installed(const std::string& program) {
  return run_program("command", "-v " + program).code == 0;
}

TEST(Manners, EveryOptionSaysWhatItDoesAndWhatHoldsWithoutIt) {
  ASSERT_GT(commands().size(), 18u);  // studies among them
  int counted = 0;
  each_option([&](const Command& command, const json& option) {
    ++counted;
    const std::string name = option["names"].back();
    EXPECT_GT(option["help"].get<std::string>().size(), 5u) << command.path << " " << name;
    const std::string value = option["value"];
    const bool may_be_absent =
        value.empty() || value == "FILE" || value == "DIR" || option["required"] == true;
    EXPECT_TRUE(may_be_absent || !option["default"].get<std::string>().empty())
        << command.path << " " << name << ": no default";
  });
  EXPECT_GT(counted, 150);
}

TEST(Manners, HelpHasAllOptionsAnExampleAndTheExitCodes) {
  // Some of the commands, of both programs: a start of the command takes longer than all that is looked at
  // here.
  std::map<std::string, std::string> helps;
  for (const std::string path : {"convert", "render", "graph check", "study accuracy", "simulate"}) {
    const Outcome help = sinew(path + " --help");
    EXPECT_EQ(help.code, 0) << path;
    EXPECT_NE(help.out.find("Exit codes: 0 done, 1 bad input, 2 usage"), std::string::npos) << path;
    helps[path] = help.out;
  }
  // Mechanisms have options of their own under the same command.
  helps["simulate"] += sinew("simulate " + source_dir() + "/assets/mechanisms/chain.json --help").out;
  each_option([&](const Command& command, const json& option) {
    for (const json& name : option["names"]) {
      const auto help = helps.find(command.path);
      if (help == helps.end()) continue;
      EXPECT_NE(help->second.find(name.get<std::string>()), std::string::npos) << command.path << " " << name;
    }
  });
}

TEST(Manners, EveryOptionIsInCompletionAndManPages) {
  const std::string directory = own_directory() + "man1";
  ASSERT_EQ(sinew("man -o " + directory).code, 0);
  std::map<std::string, std::string> pages;
  for (const auto& entry : fs::directory_iterator(directory))
    pages[entry.path().filename().string()] = bytes_of(entry.path().string());
  for (auto& [name, page] : pages)
    for (std::size_t at; (at = page.find("\\-")) != std::string::npos;) page.erase(at, 1);
  const std::string bash = sinew("completion bash").out, zsh = sinew("completion zsh").out,
                    fish = sinew("completion fish").out;
  each_option([&](const Command& command, const json& option) {
    const std::string top = command.path.substr(0, command.path.find(' '));
    const std::string& page = pages["sinew" + (top.empty() ? "" : "-" + top) + ".1"];
    for (const json& each : option["names"]) {
      const std::string name = each;
      if (name[0] != '-') continue;  // operands have no names that are typed
      EXPECT_NE(page.find("\\fB" + name + "\\fR"), std::string::npos) << command.path << " " << name;
      EXPECT_NE(bash.find(name), std::string::npos) << name;
      EXPECT_NE(zsh.find(name + "["), std::string::npos) << name;
      const bool is_long = name[1] == '-';
      EXPECT_NE(fish.find((is_long ? " -l " : " -s ") + name.substr(is_long ? 2 : 1) + " "),
                std::string::npos)
          << name;
    }
  });
  for (const Command& command : commands())
    if (!command.path.empty() && command.path.find(' ') == std::string::npos) {
      const std::string& page = pages["sinew-" + command.path + ".1"];
      EXPECT_NE(page.find(".SH EXIT STATUS"), std::string::npos) << command.path;
    }
}

TEST(Manners, ManPagesAreCleanAndRender) {
  if (!is_installed("mandoc")) GTEST_SKIP() << "mandoc is not installed";
  const std::string directory = own_directory() + "lint";
  ASSERT_EQ(sinew("man -o " + directory).code, 0);
  for (const auto& entry : fs::directory_iterator(directory)) {
    // A page without a date is the same bytes at every build.
    const Outcome lint = run_program(
        "mandoc", "-T lint -W style " + entry.path().string() + " | grep -v 'missing date' || true");
    EXPECT_EQ(lint.out, "");
  }
  const std::string page =
      std::regex_replace(run_program("mandoc", "-T ascii -O width=300 " + directory + "/sinew-render.1").out,
                         std::regex(".\x08"), "");  // struck twice: bold
  for (const char* words : {"--theme", "one of: dark, light", "(default: dark)", "EXIT STATUS"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
}

/// What bash offers for words typed after "sinew"; the last one is being typed.
std::string offered_by_bash(const std::string& completion, const std::string& typed) {
  const std::string script = written(
      "complete.bash", completion +
                           "compopt() { echo \"compopt $*\"; }\n"
                           "COMP_WORDS=(sinew \"$@\")\nCOMP_CWORD=$#\n_sinew\necho \"${COMPREPLY[*]}\"\n");
  return run_program("bash", script + " " + typed).out;
}

TEST(Manners, BashCompletesCommandsOptionsChoicesAndFiles) {
  const std::string script = sinew("completion bash").out;
  EXPECT_EQ(offered_by_bash(script, "conv"), "convert\n");
  EXPECT_EQ(offered_by_bash(script, "render x.sinew --theme ''"), "dark light\n");
  EXPECT_EQ(offered_by_bash(script, "render --turn"), "--turntable\n");
  EXPECT_EQ(offered_by_bash(script, "graph ch"), "check\n");
  EXPECT_EQ(offered_by_bash(script, "graph check --st"), "--strict\n");
  EXPECT_EQ(offered_by_bash(script, "study accuracy --en"), "--ensembles\n");
  EXPECT_EQ(offered_by_bash(script, "completion z"), "zsh\n");
  EXPECT_EQ(offered_by_bash(script, "render -o ''"), "compopt -o default\n\n");
}

TEST(Manners, FishCompletes) {
  if (!is_installed("fish")) GTEST_SKIP() << "fish is not installed";
  const std::string script = own_directory() + "sinew.fish";
  run_program(SINEW_COMMAND, "completion fish > " + script);
  const auto offered = [&](const std::string& typed) {
    return run_program("fish", "-N -c \"source " + script + "; complete -C '" + typed + "' | cut -f 1\"").out;
  };
  EXPECT_EQ(offered("sinew render --theme "), "dark\nlight\n");
  EXPECT_NE(offered("sinew conv").find("convert\n"), std::string::npos);
  EXPECT_NE(offered("sinew graph check --st").find("--strict\n"), std::string::npos);
  EXPECT_EQ(offered("sinew graph check --st").find("--start"), std::string::npos);
}

TEST(Manners, ZshReadsTheScript) {
  if (!is_installed("zsh")) GTEST_SKIP() << "zsh is not installed";
  const std::string script = own_directory() + "_sinew";
  run_program(SINEW_COMMAND, "completion zsh > " + script);
  const Outcome checked = run_program(
      "zsh", "-f -c 'autoload -U compinit; compinit -u -D; source " + script + "; echo ${_comps[sinew]}'");
  EXPECT_EQ(checked.out, "_sinew\n");
}

TEST(Manners, ColoursAreForTerminalsOnlyAndNeverWithNoColor) {
  EXPECT_EQ(sinew("info /no/such").out.find('\033'), std::string::npos);
  if (!is_installed("script")) GTEST_SKIP() << "script(1), which makes a terminal, is not installed";
  const auto on_terminal = [](const std::string& environment) {
    return run_program("env", environment + " script -qec '" SINEW_COMMAND " info /no/such' /dev/null").out;
  };
  EXPECT_NE(on_terminal("-u NO_COLOR TERM=xterm").find("\033[31m"), std::string::npos);
  EXPECT_EQ(on_terminal("NO_COLOR=1 TERM=xterm").find('\033'), std::string::npos);
  EXPECT_EQ(on_terminal("-u NO_COLOR TERM=dumb").find('\033'), std::string::npos);
}

TEST(Manners, QuietCommandsSayNothingButErrors) {
  const std::string out = own_directory();
  const std::string character = source_dir() + "/assets/character/mannequin.glb";
  const std::string mechanism = source_dir() + "/assets/mechanisms/chain.json";
  for (const std::string& arguments :
       {"convert -q " + character + " -o " + out + "q.sinew", "info --quiet " + kAsset,
        "export -q " + kAsset + " --clip walk -o " + out + "q.bvh",
        "simulate -q " + mechanism + " --t-end 0.1 -o " + out + "q.csv",
        "render -q " + kAsset + " --size 64x64 --quality fast -o " + out + "q.png"}) {
    const Outcome run = sinew(arguments);
    EXPECT_EQ(run.code, 0) << arguments;
    EXPECT_EQ(run.out, "") << arguments;
  }
  expect_refused("info --quiet /no/such", "/no/such");
  EXPECT_EQ(json::parse(sinew("info --quiet --json " + kAsset).out)["name"], "mannequin");
}

}  // namespace
}  // namespace sinew::test
