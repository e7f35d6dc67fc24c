// Telemetry of a run as CSV, summary and plot.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "scene/run.h"

namespace sinew::scene {
namespace {

/// Names come from files that nobody here wrote: nothing in them may end a CSV field.
std::string field(std::string name) {
  for (char& c : name)
    if (c == ',' || c == '"' || static_cast<unsigned char>(c) < ' ') c = '_';
  return name;
}

/// For single quotes of gnuplot.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

/// Names of all simulated joints, each once, in the order of the characters.
std::vector<std::string> body_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneCharacter& c : scene.characters)
    for (int i = 0; i < c.asset->skeleton.body_count; ++i)
      if (const std::string& name = c.asset->skeleton.joints[i].name;
          std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
  return names;
}

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Runs a program without its chatter; -1 when it cannot be started.
int run_quietly(const char* program, const std::string& argument) {
  const char* arguments[] = {program, argument.c_str(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int out : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, out, "/dev/null", O_WRONLY, 0);
  pid_t pid = 0;
  int status = -1;
  const bool started =
      posix_spawnp(&pid, program, &files, nullptr, const_cast<char**>(arguments), environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  return started && waitpid(pid, &status, 0) == pid ? status : -1;
}

}  // namespace

std::string telemetry_csv(const Scene& scene, const Telemetry& telemetry) {
  std::string csv =
      "time_s,character,dofs,unknown_dofs,microseconds,outer_passes,factorisations,converged,contacts,"
      "penetration_m,kinetic_J,potential_J,loaded_joint,load,torque_Nm,limit_Nm,plotted_torque_Nm,"
      "plotted_limit_Nm,elastic_J,substeps,estimated_error_m,help_N,help_Nm";
  const std::vector<std::string> names = body_names(scene);
  for (const std::string& name : names) csv += ",load_" + field(name);
  csv += '\n';
  for (const TelemetryRow& r : telemetry.rows) {
    const SceneCharacter& c = scene.characters[r.character];
    const Skeleton& skeleton = c.asset->skeleton;
    csv += fmt::format("{:.6f},{},{},{},{:.2f},{},{},{:d},{},{:.6f},{:.6f},{:.6f},{},{:.4f}", r.time,
                       field(c.name), r.report.dofs, r.report.unknown_dofs, r.microseconds,
                       r.report.outer_passes, r.report.factorisations, r.report.converged, r.report.contacts,
                       r.report.penetration, r.report.kinetic_energy, r.report.potential_energy,
                       field(skeleton.joints[r.loaded_joint].name), r.load);
    csv += fmt::format(",{:.3f},{:.3f},{:.3f},{:.3f},{:.6f},{},{:.3e},{:.2f},{:.2f}", r.torque, r.limit,
                       r.plotted_torque, r.plotted_limit, r.report.elastic_energy, r.report.substeps,
                       r.report.estimated_error, r.report.help_force, r.report.help_torque);
    for (const std::string& name : names) {
      const int joint = skeleton.find(name.c_str());
      csv += joint >= 0 && joint < skeleton.body_count ? fmt::format(",{:.4f}", r.loads[joint]) : ",";
    }
    csv += '\n';
  }
  return csv;
}

nlohmann::json telemetry_summary(const Scene& scene, const Telemetry& telemetry) {
  std::vector<double> playback, solved;
  int unconverged = 0, most = 0, contacts = 0, substeps = 0;
  double penetration = 0, load = 0, error = 0;
  std::string loaded;
  for (const TelemetryRow& r : telemetry.rows) {
    if (r.time > 0) (r.report.unknown_dofs == 0 ? playback : solved).push_back(r.microseconds);
    unconverged += !r.report.converged;
    most = std::max(most, r.report.unknown_dofs);
    contacts = std::max(contacts, r.report.contacts);
    substeps = std::max(substeps, r.report.substeps);
    error = std::max(error, r.report.estimated_error);
    penetration = std::max(penetration, r.report.penetration);
    if (r.load > load) {
      load = r.load;
      loaded = scene.characters[r.character].asset->skeleton.joints[r.loaded_joint].name;
    }
  }
  return {{"title", scene.title},
          {"duration_s", scene.duration},
          {"frame_rate", scene.frame_rate},
          {"frames_playback", playback.size()},
          {"frames_solved", solved.size()},
          {"median_us_playback", median(playback)},
          {"median_us_solved", median(solved)},
          {"most_unknown_dofs", most},
          {"unconverged_steps", unconverged},
          {"most_substeps", substeps},
          {"most_contacts", contacts},
          {"deepest_penetration_m", penetration},
          {"largest_estimated_error_m", error},
          {"largest_load", load},
          {"largest_load_joint", loaded}};
}

convert::Error plot_telemetry(const std::string& csv_path, const Telemetry& telemetry,
                              const std::string& png_path) {
  const std::string script_path = png_path + ".gp", drawn = png_path + ".tmp";
  const std::string csv = quoted(csv_path);
  const std::string joint = telemetry.plotted_name.empty() ? "the most loaded joint" : telemetry.plotted_name;
  std::ofstream script(script_path);
  script << "set terminal pngcairo noenhanced size 1200,900 font ',11'\n"
         << "set output " << quoted(drawn) << "\n"
         << "set datafile separator ','\nset grid lc rgb '#dddddd'\nset lmargin 10\nset rmargin 4\n"
         << "set multiplot layout 3,1\nset key top right\nset ylabel 'unknown DOFs'\n"
         << "plot " << csv
         << " using 1:4 every ::1 with filledcurves y1=0 lc rgb '#3d9a8b' title 'handed to the optimizer'\n"
         << "set ylabel 'µs per step'\nset logscale y\n"
         << "plot " << csv << " using 1:5 every ::2 with lines lc rgb '#34556e' title 'world step'\n"
         << "unset logscale y\nset ylabel 'N·m'\nset xlabel 'time, s'\n"
         << "plot " << csv << " using 1:18 every ::1 with lines lw 2 lc rgb '#c8553d' title "
         << quoted("torque of " + joint)
         << ", '' using 1:19 every ::1 with lines dt 2 lc rgb '#888888' title 'limit'"
         << ", '' using 1:(-$19) every ::1 with lines dt 2 lc rgb '#888888' notitle\n";
  script.close();
  if (!script) return {script_path + ": cannot be written"};
  const int status = run_quietly("gnuplot", script_path);
  std::remove(script_path.c_str());
  if (status == 0 && std::rename(drawn.c_str(), png_path.c_str()) == 0) return {};
  std::remove(drawn.c_str());
  if (status == -1) return {png_path + ": not drawn: gnuplot is not installed"};
  return {png_path + ": gnuplot could not draw it"};
}

}  // namespace sinew::scene
