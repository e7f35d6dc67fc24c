#include "cli/graph.h"

#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>

#include "cli/files.h"
#include "cli/terminal.h"
#include "graph/certificate.h"
#include "graph/compile.h"
#include "graph/describe.h"
#include "graph/dump.h"
#include "graph/trace.h"
#include "scene/graph_plot.h"
#include "sinew/graph/graph_file.h"
#include "sinew/graph/graph_recorder.h"

namespace sinew::cli {
namespace {

using convert::Error;
using graph_tools::Compiled;

Error read_text(const std::string& path, std::string& out) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    if (file && file.peek() == std::ifstream::traits_type::eof()) return {path + ": is empty"};
    return {path + ": cannot be read"};
  }
  out = text.str();
  return {};
}

/// JSON or a compiled graph.
Error load(const std::string& path, Compiled& out) {
  std::string text;
  if (Error error = read_text(path, text)) return error;
  if (text.size() > 8 && text.compare(4, 4, "SNGR") == 0) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    const Status status = read_graph({bytes, text.size()}, out.graph);
    out.lines.assign(out.graph.nodes.size(), 0);
    return status ? Error{} : Error{path + ": " + status.reason};
  }
  out = graph_tools::compile_graph(text, path);
  return {out.error};
}

std::string order_text(int order) {
  return order < 0 ? "pose" : order == 0 ? "velocity" : "acceleration";
}

}  // namespace

void GraphCommand::add(CLI::App& app) {
  app.require_subcommand(1);
  const auto graph = [&](CLI::App* c) {
    c->add_option("graph", input, "JSON or a compiled graph")->required()->type_name("FILE");
  };
  check_ = app.add_subcommand("check", "faults, warnings, and where the motion is not smooth");
  graph(check_);
  check_->add_option("--asset", asset, "asset or source file that its clips must be in")->type_name("FILE");
  check_->add_flag("--strict", strict_, "a graph that is not smooth, or has warnings, is a fault");
  check_->add_flag("--json", json_output, "what was found, on standard output as JSON");
  compile_ = app.add_subcommand("compile", "JSON to the file that games load");
  graph(compile_);
  compile_->add_option("-o,--output", output, "file to write (.sgraph)")->required()->type_name("FILE");
  compile_->add_flag("--json", json_output, "what was written, on standard output as JSON");
  dot_ = app.add_subcommand(
      "dot", "a drawing for Graphviz\nExample: sinew graph dot hero.graph.json | dot -Tsvg > hero.svg");
  graph(dot_);
  dot_->add_option("-o,--output", output, "file to write")->type_name("FILE")->default_str("standard output");
  trace_ = app.add_subcommand("trace", "plays a graph and writes what it does, frame by frame");
  graph(trace_);
  trace_->add_option("--asset", asset, "asset or source file with its clips")->required()->type_name("FILE");
  trace_->add_option("--inputs", script, "JSON: [[seconds, \"parameter\", value], [seconds, \"trigger\"], …]")
      ->type_name("FILE");
  trace_->add_option("--seconds", seconds, "how long")
      ->check(CLI::Range(0.0, 36000.0))
      ->capture_default_str();
  trace_->add_option("--rate", rate, "frames per second")
      ->check(CLI::Range(1.0, 10000.0))
      ->capture_default_str();
  trace_->add_option("--joint", joint, "whose acceleration is explained: by which nodes")
      ->type_name("NAME")
      ->default_str("the busiest");
  trace_->add_option("-o,--output", output, "CSV to write")
      ->type_name("FILE")
      ->default_str("standard output");
  trace_->add_flag("--json", json_output, "the state at the end as JSON instead");
  trace_->add_option("--record", recording, "file for the last frames, as GraphRecorder keeps them")
      ->type_name("FILE");
  trace_->add_option("--frames", frames, "frames of that file")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  plot_ = app.add_subcommand(
      "plot", "accelerations and loads over a scene, beside the same graph with smoothstep crossfades");
  plot_->add_option("scene", input, "scene whose first character plays a graph")
      ->required()
      ->type_name("FILE");
  plot_->add_option("-o,--output", output, "picture: .svg or .png")->required()->type_name("FILE");
  plot_->add_flag("--json", json_output, "what was found, on standard output as JSON");
  replay_ = app.add_subcommand(
      "replay",
      "plays the frames that a recorder kept again, and writes what they did as JSON; 'same': to the bit");
  graph(replay_);
  replay_->add_option("recording", recording, "of trace --record, or of a game")
      ->required()
      ->type_name("FILE");
  replay_->add_option("--asset", asset, "asset or source file with its clips")->required()->type_name("FILE");
  replay_->add_option("-o,--output", output, "JSON to write")
      ->type_name("FILE")
      ->default_str("standard output");
}

Error GraphCommand::run() {
  if (check_->parsed()) return check();
  if (compile_->parsed()) return compile();
  if (replay_->parsed()) return replay();
  if (plot_->parsed()) return plot();
  return dot_->parsed() ? dot() : trace();
}

Error GraphCommand::check() const {
  Compiled compiled;
  if (Error error = load(input, compiled)) return error;
  if (!asset.empty()) {
    Asset with;
    nlohmann::json report;
    if (Error error = convert::open_any(asset, {}, with, report)) return error;
    if (const std::string fault = graph_tools::bind_fault(compiled, input, with); !fault.empty())
      return {fault};
  }
  const auto losses = graph_tools::smoothness_losses(compiled.graph);
  if (json_output) {
    graph_tools::Json out = {
        {"nodes", compiled.graph.nodes.size()}, {"warnings", compiled.warnings}, {"smooth", losses.empty()}};
    out["jumps"] = graph_tools::Json::array();
    for (const auto& loss : losses)
      out["jumps"].push_back({{"node", compiled.graph.nodes[std::size_t(loss.node)].name},
                              {"line", compiled.lines[std::size_t(loss.node)]},
                              {"what", order_text(loss.order)},
                              {"reason", loss.reason}});
    std::puts(json_text(out).c_str());
  } else {
    for (const std::string& warning : compiled.warnings) say("warning: %s\n", warning.c_str());
    for (const auto& loss : losses)
      say("%s:%d: %s: the %s may jump: %s\n", input.c_str(), compiled.lines[std::size_t(loss.node)],
          compiled.graph.nodes[std::size_t(loss.node)].name.c_str(), order_text(loss.order).c_str(),
          loss.reason.c_str());
    say("%s: %zu nodes, %zu parameters; %s\n", input.c_str(), compiled.graph.nodes.size(),
        compiled.graph.parameters.size(),
        losses.empty() ? "poses, velocities and accelerations are continuous" : "not smooth everywhere");
  }
  if (strict_ && !(losses.empty() && compiled.warnings.empty()))
    return {input + ": has warnings or is not smooth (--strict)"};
  return {};
}

Error GraphCommand::compile() const {
  if (Error error = check_outputs({output}, {input})) return error;
  Compiled compiled;
  if (Error error = load(input, compiled)) return error;
  for (const std::string& warning : compiled.warnings) say_error("warning: " + warning);
  const std::vector<std::uint8_t> bytes = write_graph(compiled.graph);
  if (Error error = write_atomically(output, bytes.data(), bytes.size())) return error;
  if (json_output)
    std::puts(json_text(graph_tools::Json{{"output", output},
                                          {"nodes", compiled.graph.nodes.size()},
                                          {"bytes", bytes.size()},
                                          {"warnings", compiled.warnings}})
                  .c_str());
  else
    say("%s: %zu nodes, %zu bytes\n", output.c_str(), compiled.graph.nodes.size(), bytes.size());
  return {};
}

Error GraphCommand::dot() const {
  if (Error error = check_outputs({output}, {input})) return error;
  Compiled compiled;
  if (Error error = load(input, compiled)) return error;
  const std::string text = graph_tools::graph_dot(compiled.graph);
  if (!output.empty()) return write_atomically(output, text);
  std::fputs(text.c_str(), stdout);
  return {};
}

Error GraphCommand::bind(Asset& with, Compiled& compiled, Graph& graph) const {
  if (Error error = load(input, compiled)) return error;
  nlohmann::json report;
  if (Error error = convert::open_any(asset, {}, with, report)) return error;
  if (const std::string fault = graph_tools::bind_fault(compiled, input, with); !fault.empty())
    return {fault};
  const Status status = Graph::bind(compiled.graph, with, graph);
  return status ? Error{} : Error{input + ": " + status.reason};
}

Error GraphCommand::plot() const {
  scene::Scene own, usual;
  scene::AskedOf asked[2];
  if (Error error = scene::load_scene(input, own)) return error;
  if (Error error = scene::with_smoothsteps(own, usual)) return {input + ": " + error.message};
  if (Error error = scene::run_asked(own, asked[0])) return {input + ": " + error.message};
  if (Error error = scene::run_asked(usual, asked[1]))
    return {input + ", with smoothsteps: " + error.message};
  if (json_output)
    std::puts(json_text(nlohmann::json{{"output", output},
                                       {"graph", scene::summary_of(asked[0])},
                                       {"with_smoothsteps", scene::summary_of(asked[1])}})
                  .c_str());
  else
    say("the graph: %s\nwith smoothsteps: %s\n", scene::summary_of(asked[0]).c_str(),
        scene::summary_of(asked[1]).c_str());
  return scene::plot_asked(own, asked[0], asked[1], output);
}

Error GraphCommand::replay() const {
  if (Error error = check_outputs({output}, {input, asset, recording})) return error;
  Compiled compiled;
  Asset with;
  Graph graph;
  if (Error error = bind(with, compiled, graph)) return error;
  std::string file;
  if (Error error = read_text(recording, file)) return error;
  graph_tools::Json frames_of_file;
  if (const std::string fault = graph_tools::dump_recording(graph, file, frames_of_file); !fault.empty())
    return {recording + ": " + fault};
  const std::string text = json_text(frames_of_file, 1) + "\n";
  if (!output.empty()) return write_atomically(output, text);
  std::fputs(text.c_str(), stdout);
  return {};
}

Error GraphCommand::trace() {
  if (Error error = check_outputs({output, recording}, {input, asset, script})) return error;
  Compiled compiled;
  Asset with;
  Graph graph;
  if (Error error = bind(with, compiled, graph)) return error;
  graph_tools::InputScript inputs;
  if (!script.empty()) {
    std::string text;
    if (Error error = read_text(script, text)) return error;
    if (const std::string fault = inputs.read(text, script, compiled.graph); !fault.empty()) return {fault};
  }
  graph_tools::TraceOptions options{seconds, rate, -1};
  if (!joint.empty() && (options.joint = with.skeleton.find(joint.c_str())) < 0)
    return {asset + ": no joint '" + joint + "'"};
  GraphMemory ring(recording.empty() ? 0 : GraphRecorder<float>::bytes_for(graph, frames));
  if (!recording.empty()) options.recording = &ring;
  std::ostringstream rows;
  graph_tools::Json end;
  if (const Status status = graph_tools::trace_graph(graph, with, inputs, options, rows, end); !status)
    return {input + ": " + status.reason};
  if (!recording.empty())
    if (Error error = write_atomically(recording, graph_tools::recording_file(ring))) return error;
  if (json_output) {
    std::puts(json_text(end, 2).c_str());
    return {};
  }
  if (!output.empty()) return write_atomically(output, rows.str());
  std::fputs(rows.str().c_str(), stdout);
  return {};
}

}  // namespace sinew::cli
