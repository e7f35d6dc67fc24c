// The `sinew-render` command, which `sinew render` becomes: drawing and video bring libraries of a hundred
// megabytes with them, which nobody else should load. Exit codes as its own.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>

#include "cli/definitions.h"
#include "cli/files.h"
#include "cli/render_folder.h"
#include "cli/scene_options.h"
#include "cli/source_options.h"
#include "cli/terminal.h"
#include "convert/convert.h"
#include "import/plain_words.h"
#include "render/render.h"
#include "scene/run.h"

namespace {

using nlohmann::json;
using sinew::Asset;
using sinew::convert::Error;
namespace cli = sinew::cli;
using sinew::cli::SourceOptions;

struct RenderCommand {
  std::string input, output, scheme, telemetry_file;
  SourceOptions source;
  sinew::render::Options options;
  bool demo = false, no_overlay = false, json_output = false, still = false;
  std::string size;
  int jobs = 1;

  /// `app`: the command, whose options a folder's renderings get.
  Error run(const CLI::App& app) {
    if (std::filesystem::is_directory(input)) return run_folder(app);
    if (still) return {"--still is for folders; a single picture is -o NAME.png"};
    if (!size.empty() && std::sscanf(size.c_str(), "%dx%d", &options.width, &options.height) != 2)
      return {"--size is not WIDTHxHEIGHT"};
    options.overlay = !no_overlay;
    if (options.inside && std::filesystem::path(input).extension() != ".json" && !demo)
      return {"--inside is for scenes and --demo: an asset alone has no world"};
    if (std::filesystem::path(input).extension() == ".json") {
      sinew::scene::Scene scene;
      if (Error error = cli::load_scene(input, scheme, scene)) return error;
      return render_scene(scene);
    }
    json conversion, report;
    auto asset = std::make_shared<Asset>();
    if (Error error = source.read(conversion)) return error;
    if (Error error = sinew::convert::open_any(input, conversion, *asset, report)) return error;
    if (demo) return render_scene(sinew::scene::demo_scene(asset));
    if (Error error =
            sinew::render::render_asset(asset, options, output, cli::progress_line("render: frame")))
      return error;
    sinew::scene::Recording one;
    one.characters = {asset};
    return done(one);
  }

 private:
  Error run_folder(const CLI::App& app) const {
    cli::FolderRender folder{input, output, {}, jobs, still, json_output};
    const std::set<std::string> own = {"--output", "--jobs", "--still", "--json", "--quiet", "--telemetry"};
    for (const CLI::Option* option : app.get_options()) {
      if (option->count() == 0 || option->get_lnames().empty()) continue;
      std::vector<std::string> words = {"--" + option->get_lnames()[0]};
      if (own.count(words[0]) > 0) continue;
      for (const std::string& value : option->results())
        if (option->get_items_expected_max() > 0) words.push_back(value);
      if (words.size() == 2 && words[1].front() == '-')
        words = {words[0] + "=" + words[1]};  // "-x", no option
      folder.options.push_back(std::move(words));
    }
    int failed = 0;
    if (Error error = cli::render_folder(folder, failed)) return error;
    if (failed > 0)
      return {std::to_string(failed) + (failed == 1 ? " file" : " files") + " could not be rendered"};
    return {};
  }

  Error render_scene(const sinew::scene::Scene& scene) {
    if (Error error = cli::check_outputs({output, telemetry_file}, {input})) return error;
    sinew::scene::Recording recording;
    recording.shows_inside = options.inside;
    sinew::scene::Telemetry telemetry;
    if (Error error = sinew::scene::run_scene(scene, recording, telemetry, {}))
      return {input + ": " + error.message};
    if (!telemetry_file.empty()) {
      if (Error error = cli::write_atomically(telemetry_file, sinew::scene::telemetry_csv(scene, telemetry)))
        return error;
      const std::string png = std::filesystem::path(telemetry_file).replace_extension(".png").string();
      if (Error error = sinew::scene::plot_telemetry(telemetry_file, telemetry, png))
        cli::say_error(error.message);
    }
    if (Error error =
            sinew::render::render_recording(recording, options, output, cli::progress_line("render: frame")))
      return error;
    return done(recording);
  }
  Error done(const sinew::scene::Recording& recording) const {
    json made = {{"output", output}};
    if (options.pass == "id")
      for (const auto& [name, color] : sinew::render::id_colors(recording))
        made["ids"].push_back({{"name", name}, {"color", color}});
    if (json_output)
      std::puts(cli::json_text(made).c_str());
    else
      cli::say("%s: %dx%d\n", output.c_str(), options.width, options.height);
    return {};
  }
};

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Sinew's pictures and videos: what `sinew render` runs."};
  app.name("sinew");
  app.require_subcommand(1);
  RenderCommand render;
  auto* r =
      app.add_subcommand("render",
                         "turntable or scene video, headless\nExamples: sinew render push.json -o push.mp4\n"
                         "          sinew render art/characters --turntable -o out/turntables -j 4");
  r->add_option("input", render.input, "scene (.json), asset or source file")->required()->type_name("FILE");
  r->add_option("-o,--output", render.output,
                ".mp4, .webm, .gif or .png (frame_%04d.png for a sequence); for a folder, a directory")
      ->required()
      ->type_name("FILE");
  r->add_option("--size", render.size, "pixels, even")->type_name("WIDTHxHEIGHT")->default_str("1280x720");
  r->add_option("--fps", render.options.fps, "frames per second")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  r->add_option("--samples", render.options.samples, "multisampling: samples of a pixel")
      ->check(CLI::IsMember({1, 4}))
      ->capture_default_str();
  r->add_option("--quality", render.options.quality, "full (ambient occlusion, softer shadows) or fast")
      ->check(CLI::IsMember({"full", "fast"}))
      ->capture_default_str();
  r->add_option("--start", render.options.start, "first moment shown, s; the moment of a single .png")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  r->add_option("--theme", render.options.theme, "colours of sky, floor and figure")
      ->check(CLI::IsMember({"dark", "light"}))
      ->capture_default_str();
  r->add_option("--background", render.options.background, "one colour instead of the sky")
      ->type_name("RRGGBB")
      ->default_str("the theme's sky");
  r->add_flag("--transparent", render.options.transparent, ".png: neither sky nor floor, with alpha");
  r->add_option(
       "--pass", render.options.pass,
       "color, or as .png: depth (16-bit grey, mm; 65535: nothing), normal (world axes, -1 to 1 as 0 to "
       "255), id (a colour for each thing, listed by --json)")
      ->check(CLI::IsMember({"color", "depth", "normal", "id"}))
      ->capture_default_str();
  r->add_option(
       "--mode", render.options.mode,
       "skin, xray (muscles by load in translucent skin), shapes (of the physical body), or both: skin "
       "beside xray")
      ->check(CLI::IsMember({"skin", "xray", "shapes", "both"}))
      ->capture_default_str();
  r->add_flag("--turntable", render.options.turntable, "assets: the camera goes round once");
  r->add_option("--frames", render.options.frames_per_revolution, "frames per revolution")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  r->add_option("-j,--jobs", render.jobs, "folders: renderings at once")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  r->add_flag("--still", render.still, "folders: a picture each instead of a video");
  r->add_option("--clip", render.options.clip, "assets: clip to play, by name")
      ->type_name("NAME")
      ->default_str("rest pose");
  r->add_flag("--demo", render.demo, "assets: the demo's story instead of a turntable");
  r->add_option("--telemetry", render.telemetry_file, "scenes: also write the telemetry CSV and its plot")
      ->type_name("FILE");
  r->add_flag("--no-overlay", render.no_overlay, "no text and no curves over the picture");
  r->add_flag(
      "--inside", render.options.inside,
      "scenes: what the world has inside: skeletons, colliders, contacts with their forces, loads, what "
      "is solved for, support, targets");
  r->add_flag("--json", render.json_output, "what was written, on standard output as JSON");
  cli::add_scheme(*r, render.scheme);
  render.source.add(*r);

  if (const auto code = cli::parse_or_describe(app, argc, argv)) return *code;
  const Error error = render.run(*r);
  if (!error) return 0;
  cli::say_error(error.message);
  return 1;
} catch (const std::exception& unexpected) {
  cli::say_error(sinew::import::plain_words(unexpected));
  return 1;
}
