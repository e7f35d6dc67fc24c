// The `sinew-study` command, which `sinew` becomes for studies and mechanisms. Exit codes as its own.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "cli/definitions.h"
#include "cli/files.h"
#include "cli/mechanism.h"
#include "cli/study.h"
#include "cli/tables.h"
#include "cli/terminal.h"
#include "import/plain_words.h"

namespace {

using sinew::convert::Error;
namespace cli = sinew::cli;

struct MechanismCommand {
  std::string file, output;
  bool json_output = false;
  sinew::mechanism::SimulateOptions options;

  void add(CLI::App& app) {
    app.add_option("mechanism", file, "mechanism (.json)")->required()->type_name("FILE");
    app.add_option("-o,--output", output, "coordinates and points: .csv, or .json for the summary")
        ->required()
        ->type_name("FILE");
    app.add_flag("--json", json_output, "the summary on standard output as JSON");
    cli::add_mechanism_options(app, options);
  }
};

void add_options(CLI::App& app, cli::ScenesCommand& command) {
  app.add_option("-o,--output", command.directory, "directory for the JSON file")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--scene", command.only, "run one, by its name")->type_name("NAME")->default_str("all");
  app.add_flag("--quick", command.quick, "shorter runs, fewer seeds");
  app.add_flag("--json", command.json_output, "results on standard output as JSON");
}

void add_options(CLI::App& app, cli::BehaviourCommand& command) {
  app.add_option("-o,--output", command.directory, "directory for JSON and pictures")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--directions", command.directions, "of pushes")
      ->check(CLI::IsMember({2, 4, 8}))
      ->default_str("8, with --quick 4");
  app.add_option("--seeds", command.seeds, "of every push")
      ->check(CLI::Range(1, 1000))
      ->default_str("10, with --quick 3");
  app.add_flag("--quick", command.quick, "4 directions, chest and 60 Hz only, 3 seeds, fewer impulses");
  app.add_flag("--json", command.json_output, "results on standard output as JSON");
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{
      "Sinew's studies, and mechanisms of the reference family: what `sinew study` and `sinew simulate` "
      "run."};
  app.require_subcommand(1);
  MechanismCommand mechanism;
  auto* simulate = app.add_subcommand(
      "simulate", "run a mechanism\nExample: sinew simulate chain.json --integrator DASSL -o chain.csv");
  mechanism.add(*simulate);

  cli::StabilityCommand stability;
  auto* study = app.add_subcommand("study", "the evidence, as tables, CSV and pictures");
  study->require_subcommand(1);
  auto* hard = study->add_subcommand(
      "stability", "hard cases of the step\nExample: sinew study stability --quick -o out/study");
  hard->add_option("-o,--output", stability.directory, "directory for CSV and pictures")
      ->type_name("DIR")
      ->capture_default_str();
  hard->add_option("--case", stability.only, "run one case, by its name")
      ->type_name("NAME")
      ->default_str("all");
  hard->add_flag("--quick", stability.quick, "shorter runs, fewer seeds");
  hard->add_flag("--json", stability.json_output, "results on standard output as JSON");
  cli::TablesCommand tables;
  auto* paper = study->add_subcommand("tables",
                                      "formulations and integrators of the reference family\nExample: sinew "
                                      "study tables --quick -o out/study");
  cli::add_options(*paper, tables);
  cli::AccuracyCommand accuracy;
  auto* cost = study->add_subcommand(
      "accuracy", "what accuracy costs in time\nExample: sinew study accuracy --quick -o out/study");
  cost->add_option("-o,--output", accuracy.directory, "directory for report, CSV and pictures")
      ->type_name("DIR")
      ->capture_default_str();
  cost->add_option("--scene", accuracy.only,
                   "tumbling, pendulum, collapse, drop, stack, tracking, running, lod or driver")
      ->type_name("NAME")
      ->default_str("all");
  cost->add_flag("--ensembles", accuracy.ensembles,
                 "mean energies of many limp falls instead: JSON, pictures");
  cost->add_flag("--quick", accuracy.quick, "fewer steps and repetitions");
  cost->add_flag("--json", accuracy.json_output, "results on standard output as JSON");
  cli::ScenesCommand scenes, talk_scenes;
  talk_scenes.talk = true;
  auto* ordinary = study->add_subcommand(
      "scenes", "ordinary situations, judged from poses\nExample: sinew study scenes --quick -o out/study");
  add_options(*ordinary, scenes);
  auto* talk = study->add_subcommand(
      "talk", "the seed talk's scenes, judged from poses\nExample: sinew study talk --scene torque_limit");
  add_options(*talk, talk_scenes);
  cli::BehaviourCommand behaviour;
  auto* balance = study->add_subcommand(
      "behaviour", "pushes beside what people bear\nExample: sinew study behaviour --quick -o out/study");
  add_options(*balance, behaviour);
  cli::EffectsCommand effects;
  auto* each = study->add_subcommand(
      "effects",
      "what every effect costs, in instructions and time\nExample: sinew study effects -o out/study");
  each->add_option("-o,--output", effects.directory, "directory for CSV and pictures")
      ->type_name("DIR")
      ->capture_default_str();
  each->add_flag("--quick", effects.quick, "fewer timed steps");
  each->add_flag("--json", effects.json_output, "results on standard output as JSON");

  if (const auto code = cli::parse_or_describe(app, argc, argv)) return *code;
  Error error;
  if (simulate->parsed())
    error = cli::run_mechanism(mechanism.file, mechanism.options, mechanism.output, mechanism.json_output);
  else if (hard->parsed())
    error = stability.run();
  else if (paper->parsed())
    error = tables.run();
  else if (cost->parsed())
    error = accuracy.run();
  else if (ordinary->parsed())
    error = scenes.run();
  else if (talk->parsed())
    error = talk_scenes.run();
  else if (balance->parsed())
    error = behaviour.run();
  else
    error = effects.run();
  if (!error) return 0;
  cli::say_error(error.message);
  return cost->parsed() ? accuracy.exit_code : 1;
} catch (const std::exception& unexpected) {
  cli::say_error(sinew::import::plain_words(unexpected));
  return 1;
}
