#include "cli/mechanism.h"

#include <cstdio>

#include "cli/files.h"
#include "cli/terminal.h"

namespace sinew::cli {

using convert::Error;

void add_mechanism_options(CLI::App& app, mechanism::SimulateOptions& o) {
  const std::string group = "Mechanisms";
  app.add_option("--formulation", o.formulation, "coordinates and constraints")
      ->check(CLI::IsMember(mechanism::formulation_names()))
      ->capture_default_str()
      ->group(group);
  app.add_option("--integrator", o.integrator, "method and its step control")
      ->check(CLI::IsMember(mechanism::integrator_names()))
      ->capture_default_str()
      ->group(group);
  app.add_option("--rtol", o.rtol, "relative tolerance")
      ->check(CLI::Range(1e-16, 1.0))
      ->capture_default_str()
      ->group(group);
  app.add_option("--atol", o.atol, "absolute tolerance")
      ->check(CLI::Range(1e-16, 1.0))
      ->capture_default_str()
      ->group(group);
  app.add_option("--step", o.fixed_step, "step of bdf1 and bdf2, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group(group);
  app.add_option("--max-step", o.max_step, "longest step, s")
      ->check(CLI::PositiveNumber)
      ->default_str("none")
      ->group(group);
  app.add_option("--max-steps", o.max_steps, "stop after so many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group(group);
  app.add_option("--t-end", o.t_end, "simulated time, s")
      ->check(CLI::PositiveNumber)
      ->default_str("the file's")
      ->group(group);
  app.add_option("--samples", o.intervals, "rows of the table after the first")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str()
      ->group(group);
  app.add_option("--at", o.instants, "instants of the rows instead, s")->default_str("none")->group(group);
}

Error run_mechanism(const std::string& path, const mechanism::SimulateOptions& options,
                    const std::string& output, bool json_output) {
  bool as_json = false;
  if (Error error = telemetry_format(output, as_json)) return error;
  multibody::Mechanism description;
  if (const std::string fault = mechanism::load_mechanism(path, description); !fault.empty()) return {fault};
  const multibody::Model model(description);
  const double t_end = options.t_end > 0 ? options.t_end : description.t_end;
  const auto bar = progress_line("simulate");
  const auto progress = [&](double t) {
    if (bar) bar(static_cast<int>(1000 * std::min(t, t_end) / t_end), 1000);
  };
  multibody::SimulationResult result;
  const std::string why = mechanism::simulate_mechanism(model, options, progress, result);
  if (!why.empty() && result.samples.empty()) return {path + ": " + why};
  const nlohmann::json summary = mechanism::telemetry(model, options, result);
  if (Error error = write_atomically(
          output, as_json ? json_text(summary, 2) + "\n" : mechanism::samples_csv(model, result)))
    return error;
  if (json_output)
    std::puts(json_text(summary).c_str());
  else
    say("%s: %zu rows, %ld steps, %.3g s of CPU time, loops closed to %.1e m\n", output.c_str(),
        result.samples.size(), result.steps.steps, result.seconds, summary["closure_error_m"].get<double>());
  return why.empty() ? Error{} : Error{path + ": " + why};
}

}  // namespace sinew::cli
