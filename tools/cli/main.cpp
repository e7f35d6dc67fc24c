// The `sinew` command: parses arguments and hands them to the libraries. Exit codes: 0 done, 1 bad input, 2
// usage.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <set>

#include "cli/batch.h"
#include "cli/convert_folder.h"
#include "cli/definitions.h"
#include "cli/evaluate.h"
#include "cli/export.h"
#include "cli/files.h"
#include "cli/graph.h"
#include "cli/manual.h"
#include "cli/memory.h"
#include "cli/other_programs.h"
#include "cli/retarget.h"
#include "cli/scene_options.h"
#include "cli/source_options.h"
#include "cli/terminal.h"
#include "convert/convert.h"
#include "convert/report_text.h"
#include "import/plain_words.h"
#include "retarget/retarget.h"
#include "scene/presets.h"
#include "scene/run.h"
#include "sinew/skeleton/version.h"

namespace {

using nlohmann::json;
using sinew::Asset;
using sinew::convert::Error;
namespace cli = sinew::cli;
using sinew::cli::SourceOptions;

struct ConvertCommand {
  std::vector<std::string> inputs;
  std::string output, report_file;
  SourceOptions source;
  bool json_output = false, reference = false, each = false, dry_run = false, again = false, watch = false,
       retarget = false, verbose = false;
  int jobs = 1;

  Error run() const {
    if (reference) {
      std::fputs(sinew::convert::reference_options().c_str(), stdout);
      return {};
    }
    const auto is_folder = [](const std::string& input) { return std::filesystem::is_directory(input); };
    if (each || std::any_of(inputs.begin(), inputs.end(), is_folder)) return run_folder();
    if (dry_run || again || watch) return {"--dry-run, --again and --watch are for folders and for --each"};
    json options, report;
    Asset asset;
    std::vector<std::string> read = inputs;
    read.insert(read.end(), {source.options_file, source.clip_data});
    if (Error error = cli::check_outputs({output, report_file}, read)) return error;
    if (Error error = source.read(options)) return error;
    if (retarget) options["retarget"] = true;
    if (Error error =
            sinew::convert::convert_files(inputs, options, asset, report, sinew::retarget::add_retargeted))
      return error;
    const std::vector<std::uint8_t> bytes = sinew::write_asset(asset);
    const auto detail = verbose ? sinew::convert::Detail::kWhole : sinew::convert::Detail::kFolded;
    if (Error error = cli::write_atomically(output, bytes.data(), bytes.size())) return error;
    if (!report_file.empty())
      if (Error error = cli::write_atomically(report_file, cli::json_text(report, 2) + "\n")) return error;
    report["output"] = output;
    report["bytes"] = bytes.size();
    if (json_output)
      std::puts(cli::json_text(report).c_str());
    else
      cli::say("%s%s: %zu bytes\n", sinew::convert::report_text(report, detail).c_str(), output.c_str(),
               bytes.size());
    return {};
  }

 private:
  Error run_folder() const {
    if (retarget) return {"--retarget is for one character and its files, not for folders"};
    json options;
    if (Error error = source.read(options)) return error;  // once, instead of once a file
    cli::FolderConversion folder;
    folder.inputs = inputs;
    folder.output = output;
    folder.options = source.arguments();
    folder.jobs = jobs;
    folder.dry_run = dry_run;
    folder.again = again;
    folder.watch = watch;
    folder.report_file = report_file;
    folder.json = json_output;
    int failed = 0;
    if (Error error = cli::convert_folder(folder, failed)) return error;
    if (failed > 0)
      return {std::to_string(failed) + (failed == 1 ? " file" : " files") + " could not be converted"};
    return {};
  }
};

struct InfoCommand {
  std::string file;
  SourceOptions source;
  bool json_output = false;

  Error run() const {
    json options, report;
    Asset asset;
    if (Error error = source.read(options)) return error;
    if (Error error = sinew::convert::open_any(file, options, asset, report)) return error;
    json colliders = asset.skeleton.colliders.size();
    report["colliders"] = colliders;
    report["meshes"] = asset.meshes.size();
    const json memory = cli::memory_of(asset);
    report["memory_bytes"] = memory;
    json clips = json::array();
    for (const sinew::Clip& c : asset.clips) clips.push_back(describe(asset, c));
    if (!report.contains("clips") || report["clips"].size() != clips.size())
      report["clips"] = clips;
    else
      for (std::size_t k = 0; k < clips.size(); ++k) report["clips"][k].update(clips[k]);
    report["masks"] = json::object();
    for (const sinew::JointMask& mask : asset.masks) report["masks"][mask.name] = mask.weights;
    report["morph_targets"] = morph_targets(asset);
    if (json_output)
      std::puts(cli::json_text(report).c_str());
    else
      cli::say("%s%scolliders %zu, meshes %zu\n%s",
               sinew::convert::report_text(listed(report), sinew::convert::Detail::kWhole).c_str(),
               events_text(asset).c_str(), asset.skeleton.colliders.size(), asset.meshes.size(),
               memory_text(memory).c_str());
    return {};
  }

 private:
  /// As conversion reports it: numbers and names instead of what they count.
  static json listed(json report) {
    json masks = json::array();
    for (const auto& [name, weights] : report["masks"].items()) masks.push_back(name);
    report["masks"] = masks;
    std::set<std::string> targets;
    for (const json& target : report["morph_targets"]) targets.insert(target["name"].get<std::string>());
    report["morph_targets"] = targets;
    for (json& clip : report["clips"])
      for (const char* what : {"contacts", "events", "curves", "markers"}) clip[what] = clip[what].size();
    return report;
  }

  /// Of every mesh, each with the vertices that it moves.
  static json morph_targets(const Asset& asset) {
    json out = json::array();
    for (const sinew::Mesh& mesh : asset.meshes)
      for (std::size_t k = 0; k < mesh.morphs.size(); ++k) {
        std::size_t vertices = 0;
        for (const sinew::MorphRun& run : mesh.morphs[k].runs) vertices += run.count;
        out.push_back({{"mesh", mesh.name},
                       {"name", asset.curve_slots[static_cast<std::size_t>(mesh.morph_curves[k])].name},
                       {"vertices", vertices}});
      }
    return out;
  }

  /// What a clip says beside its motion.
  static json describe(const Asset& asset, const sinew::Clip& c) {
    json out = {{"name", c.name}, {"duration_s", c.duration}, {"loops", c.loops}};
    for (const char* list : {"events", "curves", "markers", "contacts"}) out[list] = json::array();
    for (const sinew::ClipEvent& e : c.events)
      out["events"].push_back(
          {{"name", name_of(asset, e)}, {"begin_s", e.begin}, {"end_s", e.end}, {"always", e.always}});
    for (const sinew::FloatCurve& curve : c.curves)
      out["curves"].push_back({{"name", asset.curve_slots[static_cast<std::size_t>(curve.slot)].name},
                               {"knot_s", curve.knot_interval},
                               {"controls", curve.controls.size()}});
    for (const sinew::PhaseMarker& m : c.markers)
      out["markers"].push_back({{"phase", m.phase}, {"time_s", m.time}});
    for (const sinew::ContactWindow& w : c.contacts)
      out["contacts"].push_back({{"joint", asset.skeleton.joints[static_cast<std::size_t>(w.joint)].name},
                                 {"begin_s", w.begin},
                                 {"end_s", w.end}});
    return out;
  }

  static std::string name_of(const Asset& asset, const sinew::ClipEvent& event) {
    for (const std::string& name : asset.event_names)
      if (sinew::event_name(name) == event.name) return name;
    return {};
  }

  static std::string events_text(const Asset& asset) {
    std::string text;
    for (const sinew::Clip& c : asset.clips) {
      if (c.events.empty()) continue;
      text += "events of " + c.name + ":";
      for (const sinew::ClipEvent& e : c.events) {
        char line[64];
        if (e.end > e.begin)
          std::snprintf(line, sizeof line, " %.3f to %.3f s", double(e.begin), double(e.end));
        else
          std::snprintf(line, sizeof line, " %.3f s", double(e.begin));
        text += (&e == c.events.data() ? " " : ", ") + name_of(asset, e) + line;
      }
      text += "\n";
    }
    return text;
  }

  static std::string memory_text(const json& bytes) {
    if (bytes.is_null()) return "";
    const auto kilobytes = [&](const char* key) {
      char text[32];
      std::snprintf(text, sizeof text, "%.1f kB", bytes[key].get<double>() / 1000);
      return std::string(text);
    };
    return "memory: per rig " + kilobytes("rig") + " and clips of " + kilobytes("clips") +
           "; per character " + kilobytes("character") + ", snapshot at most " + kilobytes("snapshot") +
           "; per thread and character of an island that it solves " + kilobytes("solving") + "\n";
  }
};

struct EvaluateCommand {
  std::string model, state_file;
  SourceOptions source;
  bool fixed_base = false;

  Error run() const {
    json options, report, state, out;
    Asset asset;
    if (Error error = source.read(options)) return error;
    if (Error error = sinew::convert::open_any(model, options, asset, report)) return error;
    if (!state_file.empty())
      if (Error error = cli::read_json(state_file, state)) return error;
    if (Error error = cli::evaluate(asset.skeleton, state, fixed_base, out))
      return {(state_file.empty() ? model : state_file) + ": " + error.message};
    std::puts(cli::json_text(out).c_str());
    return {};
  }
};

struct SimulateCommand {
  std::string scene_file, output, scheme, preset, max_error, budget;
  bool json_output = false, plot = false;

  Error run() const {
    bool as_json = false;
    if (Error error = cli::telemetry_format(output, as_json)) return error;
    if (Error error = cli::check_outputs({output}, {scene_file})) return error;
    sinew::scene::Scene scene;
    if (Error error = cli::load_scene(scene_file, scheme, scene)) return error;
    if (Error error = turn_dial(scene)) return {scene_file + ": " + error.message};
    sinew::scene::Recording recording;
    sinew::scene::Telemetry telemetry;
    if (Error error =
            sinew::scene::run_scene(scene, recording, telemetry, cli::progress_line("simulate: frame")))
      return {scene_file + ": " + error.message};
    const json summary = sinew::scene::telemetry_summary(scene, telemetry);
    if (Error error = cli::write_atomically(output, as_json ? cli::json_text(summary, 2) + "\n"
                                                            : sinew::scene::telemetry_csv(scene, telemetry)))
      return error;
    if (plot) {
      const std::string png = std::filesystem::path(output).replace_extension(".png").string();
      if (Error error = sinew::scene::plot_telemetry(output, telemetry, png)) cli::say_error(error.message);
    }
    if (json_output)
      std::puts(cli::json_text(summary).c_str());
    else
      cli::say("%s: %d frames of playback (median %.1f us), %d solved (median %.1f us), %d unconverged\n",
               output.c_str(), summary["frames_playback"].get<int>(),
               summary["median_us_playback"].get<double>(), summary["frames_solved"].get<int>(),
               summary["median_us_solved"].get<double>(), summary["unconverged_steps"].get<int>());
    return {};
  }

 private:
  /// What --preset, --max-error or --budget ask for, instead of the scene's own accuracy.
  Error turn_dial(sinew::scene::Scene& scene) const {
    sinew::scene::MeasuredAccuracy chosen;
    Error error;
    if (!preset.empty())
      error = sinew::scene::find_preset(preset, chosen);
    else if (!max_error.empty())
      error = sinew::scene::within_error(max_error, chosen);
    else if (!budget.empty())
      error = sinew::scene::within_budget(budget, chosen);
    else
      return {};
    if (error) return error;
    sinew::scene::set_accuracy(chosen, scene.frame_rate, scene.world.accuracy, scene.double_precision);
    if (!json_output)
      cli::say("%d substeps, tolerance %g m, %s: measured within %.2g mm and %.2g degrees, %.3g us\n",
               scene.world.accuracy.substeps, chosen.accuracy.tolerance,
               chosen.double_precision ? "double" : "float", 1e3 * chosen.error, chosen.degrees, chosen.us);
    return {};
  }
};

struct ExportCommand {
  std::string input, interpolation = "linear", mesh = "skin";
  SourceOptions source;
  cli::Export what;
  bool json_output = false;

  void add(CLI::App& app) {
    app.add_option("input", input, "asset or source file; or a scene (.json), which is played")
        ->required()
        ->type_name("FILE");
    app.add_option(
           "-o,--output", what.output,
           "glTF: .glb, or .gltf in one file; a motion: .bvh; the physical body: .xml (MJCF) or .urdf")
        ->required()
        ->type_name("FILE");
    app.add_option("--clip", what.clips, "assets: a clip by name, or several (BVH holds one)")
        ->allow_extra_args(false)
        ->type_name("NAME")
        ->default_str("all");
    app.add_option("--character", what.character, "scenes: one character by name, without the scene's props")
        ->type_name("NAME")
        ->default_str("all");
    app.add_option("--rate", what.rate, "keys per second of clips; a scene has one a step")
        ->check(CLI::Range(1.0, 1000.0))
        ->capture_default_str()
        ->each([this](const std::string&) { what.rate_asked = true; });
    app.add_option("--interpolation", interpolation,
                   "linear, or cubic: splines through the keys with the clips' own velocities")
        ->check(CLI::IsMember({"linear", "cubic"}))
        ->capture_default_str();
    app.add_option("--mesh", mesh,
                   "skin (the body's shapes where the asset has none), shapes (of the physical body) or none")
        ->check(CLI::IsMember({"skin", "shapes", "none"}))
        ->capture_default_str()
        ->each([this](const std::string&) { what.surface_asked = true; });
    app.add_flag("--json", json_output, "what was written, on standard output as JSON");
    source.add(app);
  }

  Error run() {
    what.cubic = interpolation == "cubic";
    what.surface = mesh == "skin"     ? sinew::exporting::Surface::kSkin
                   : mesh == "shapes" ? sinew::exporting::Surface::kShapes
                                      : sinew::exporting::Surface::kNone;
    json conversion, report = {{"animations", json::array()}, {"notes", json::array()}};
    if (Error error = what.check()) return error;
    if (Error error = cli::check_outputs({what.output}, {input})) return error;
    if (Error error = source.read(conversion)) return error;
    if (std::filesystem::path(input).extension() == ".json") {
      sinew::scene::Scene scene;
      if (Error error = cli::load_scene(input, "", scene)) return error;
      if (Error error = cli::export_scene(scene, what, report)) return in_input(error);
    } else {
      json ignored;
      Asset asset;
      if (Error error = sinew::convert::open_any(input, conversion, asset, ignored)) return error;
      if (Error error = cli::export_asset(asset, what, report)) return in_input(error);
    }
    if (json_output)
      std::puts(cli::json_text(report).c_str());
    else
      cli::say("%s", cli::export_text(report).c_str());
    return {};
  }

 private:
  /// What is wrong with the output names it already.
  Error in_input(const Error& error) const {
    return error.message.rfind(what.output + ": ", 0) == 0 ? error : Error{input + ": " + error.message};
  }
};

}  // namespace

int main(int argc, char** argv) try {
  if (const char* other = cli::program_for(argc, argv)) return cli::become(other, argv);
  CLI::App app{
      "Sinew: character animation that gives way to physics only where the muscles are too weak.\n"
      "Example: sinew convert hero.glb -o hero.sinew && sinew render hero.sinew --turntable -o hero.mp4"};
  app.name("sinew");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("sinew ") + sinew::version(), "which version this is");
  ConvertCommand convert;
  auto* c = app.add_subcommand(
      "convert",
      "source files to a runtime asset\nExamples: sinew convert hero.glb walk.fbx -o hero.sinew\n"
      "          sinew convert art/characters -o build/characters -j 8");
  auto* inputs =
      c->add_option("inputs", convert.inputs,
                    "glTF/GLB, FBX, BVH, COLLADA or URDF; mesh and clips may come from several. Or a "
                    "folder, all of which is converted")
          ->type_name("FILE");
  auto* out = c->add_option("-o,--output", convert.output, "asset to write; for a folder, a directory")
                  ->type_name("FILE");
  c->add_flag("--each", convert.each, "every input is a character of its own");
  c->add_option("-j,--jobs", convert.jobs, "folders: conversions at once")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  auto* dry = c->add_flag("--dry-run", convert.dry_run, "folders: say what would be converted");
  c->add_flag("--again", convert.again, "folders: convert also what is up to date");
  c->add_flag("--watch", convert.watch, "folders: go on, and convert what changes")->excludes(dry);
  c->add_option("--report", convert.report_file,
                "write the report as JSON; for a folder also as a page with pictures (.html)")
      ->type_name("FILE");
  c->add_flag("--retarget", convert.retarget, "clips for another skeleton are fitted to this one");
  c->add_flag("--json", convert.json_output, "report on standard output as JSON");
  c->add_flag("--verbose", convert.verbose, "the whole report: every clip and every note (else ten lines)");
  c->add_flag("--reference", convert.reference, "print all conversion options with defaults and comments");
  convert.source.add(*c);

  InfoCommand info;
  auto* i =
      app.add_subcommand("info", "what is in a source file or asset\nExample: sinew info hero.sinew --json");
  i->add_option("file", info.file, "source file or asset")->required()->type_name("FILE");
  i->add_flag("--json", info.json_output, "the same as JSON");
  info.source.add(*i);

  EvaluateCommand evaluate;
  auto* e = app.add_subcommand(
      "evaluate",
      "kinematics and dynamics at a state, as JSON\nExample: sinew evaluate robot.urdf --state s.json");
  e->add_option("model", evaluate.model, "asset or source file")->required()->type_name("FILE");
  e->add_option("--state", evaluate.state_file, "state, JSON (see tools/README.md)")->type_name("FILE");
  e->add_flag("--fixed-base", evaluate.fixed_base, "bolt the root to the world");
  e->add_flag_callback(
      "--json", [] {}, "output is always JSON");
  evaluate.source.add(*e);

  SimulateCommand simulate;
  auto* s = app.add_subcommand(
      "simulate", "run a scene or a mechanism\nExample: sinew simulate push.json -o push.csv --plot");
  s->add_option("scene", simulate.scene_file, "scene or mechanism (.json)")->required()->type_name("FILE");
  s->add_option("-o,--output", simulate.output, "telemetry: .csv, or .json for the summary")
      ->required()
      ->type_name("FILE");
  s->add_flag("--plot", simulate.plot, "draw the telemetry beside it (needs gnuplot)");
  s->add_flag("--json", simulate.json_output, "the summary on standard output as JSON");
  cli::add_scheme(*s, simulate.scheme);
  auto* preset = s->add_option("--preset", simulate.preset, "crowd, game, cinematic or reference")
                     ->type_name("NAME")
                     ->default_str("the scene's accuracy");
  auto* within = s->add_option("--max-error", simulate.max_error,
                               "cheapest measured setting that stays within, such as 1cm or 2deg")
                     ->default_str("none");
  auto* budget = s->add_option("--budget", simulate.budget,
                               "most accurate measured setting per character and 1/60 s, such as 20us")
                     ->default_str("none");
  preset->excludes(within)->excludes(budget);
  within->excludes(budget);
  s->footer("Mechanisms have options of their own: sinew simulate MECHANISM.json --help");

  app.add_subcommand("render",
                     "turntable or scene video, headless\nExample: sinew render push.json -o push.mp4");

  cli::GraphCommand graph;
  auto* g = app.add_subcommand("graph",
                               "graphs of clips: check, compile, dot, trace\n"
                               "Example: sinew graph check hero.graph.json --asset hero.sinew");
  graph.add(*g);

  ExportCommand exporting;
  auto* x =
      app.add_subcommand("export",
                         "assets, clips and what characters did in a scene to files of other tools\n"
                         "Examples: sinew export hero.sinew -o hero.glb --clip walk --interpolation cubic\n"
                         "          sinew export push.json -o push.glb\n"
                         "          sinew export hero.sinew --clip walk -o walk.bvh");
  exporting.add(*x);

  cli::RetargetCommand retarget;
  auto* t = app.add_subcommand("retarget",
                               "clips of one character for another\n"
                               "Example: sinew retarget walk.fbx --to hero.sinew -o hero_walks.sinew");
  retarget.add(*t);

  cli::BatchCommand batch;
  auto* b = app.add_subcommand("batch",
                               "many conversions, renderings and studies, on one machine or on Slurm\n"
                               "Examples: sinew batch plan characters.json -o out/run\n"
                               "          sinew batch run out/run -j 8\n"
                               "          sinew batch merge out/run");
  batch.add(*b);

  app.add_subcommand("study",
                     "the evidence, as tables, CSV and pictures\nExample: sinew study stability --quick");

  cli::ManualCommand manual;
  manual.add(app);
  cli::complete_definitions(app);
  if (argc == 2 && std::string_view(argv[1]) == "--describe") {
    std::puts(cli::json_text(cli::ManualCommand::described(app)).c_str());
    return 0;
  }

  try {
    app.parse(argc, argv);
    if (c->parsed() && !convert.reference && (inputs->count() == 0 || out->count() == 0))
      throw CLI::RequiredError("inputs and --output");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  Error error;
  if (c->parsed())
    error = convert.run();
  else if (i->parsed())
    error = info.run();
  else if (e->parsed())
    error = evaluate.run();
  else if (g->parsed())
    error = graph.run();
  else if (t->parsed())
    error = retarget.run();
  else if (s->parsed())
    error = simulate.run();
  else if (x->parsed())
    error = exporting.run();
  else if (b->parsed())
    error = batch.run();
  else
    error = manual.run(app);
  if (!error) return 0;
  cli::say_error(error.message);
  return b->parsed() ? batch.exit_code : 1;
} catch (const std::exception& unexpected) {
  cli::say_error(sinew::import::plain_words(unexpected));
  return 1;
}
