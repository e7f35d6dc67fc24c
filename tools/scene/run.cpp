#include "scene/run.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::scene {
namespace {

template <class Value>
Value value_at(const Timeline<Value>& line, double t, Value otherwise) {
  for (const auto& [time, value] : line)
    if (time <= t + 1e-9) otherwise = value;
  return otherwise;
}

/// Strengths are joined by straight lines.
double ramp_at(const Timeline<double>& line, double t) {
  if (t <= line.front().first) return line.front().second;
  for (std::size_t i = 1; i < line.size(); ++i)
    if (t < line[i].first) {
      const double u = (t - line[i - 1].first) / (line[i].first - line[i - 1].first);
      return line[i - 1].second + u * (line[i].second - line[i - 1].second);
    }
  return line.back().second;
}

Transform<double> upright(const Vec3<double>& position, double yaw) {
  return {Quat<double>(Eigen::AngleAxisd(yaw, Vec3<double>::UnitZ())), position};
}

double heading(const Quat<double>& rotation, const Quat<double>& rest) {
  const Vec3<double> forward = (rotation * rest.conjugate()) * Vec3<double>::UnitX();
  return std::atan2(forward.y(), forward.x());
}

/// What one character's animation wants at a time: its clips one after the other, crossfaded, each placed in
/// the world.
template <class T>
class Player {
 public:
  explicit Player(const SceneCharacter& c)
      : c_(c), places_(c.clips.size()), a_(c.asset->skeleton.joints.size()), b_(a_.size()) {
    for (auto& place : places_) place = upright(c.position, c.yaw);
  }

  const std::vector<JointJet<T>>& at(double t, const Transform<T>& root_now) {
    rest(a_);
    bool any = false;
    for (std::size_t i = 0; i < c_.clips.size(); ++i) {
      const ClipUse& use = c_.clips[i];
      if (t < use.start - 1e-9) break;
      if (use.align && !aligned_.count(i)) align(i, root_now);
      const bool over = i + 1 < c_.clips.size() && t >= c_.clips[i + 1].start + c_.clips[i + 1].blend;
      if (over) continue;
      const SamplingJob<T> job{&c_.asset->clips[use.clip], (t - use.start) * use.rate, use.rate, b_};
      job.Run();
      place_root<T>(places_[i].template cast<T>(), b_[0]);
      const EaseWeight<T> w =
          any ? EaseWeight<T>::at(T(t - use.start), T(use.blend)) : EaseWeight<T>{T(1), T(0), T(0)};
      if (any)
        crossfade<T>(a_, b_, w, a_);
      else
        a_.swap(b_);
      any = true;
    }
    return a_;
  }

 private:
  void rest(std::vector<JointJet<T>>& jets) const {
    for (std::size_t i = 0; i < jets.size(); ++i) {
      jets[i] = {};
      jets[i].rotation = c_.asset->skeleton.joints[i].rest.rotation.template cast<T>();
      jets[i].translation = c_.asset->skeleton.joints[i].rest.translation.template cast<T>();
    }
    place_root<T>(upright(c_.position, c_.yaw).template cast<T>(), jets[0]);
  }

  /// The clip's first root pose comes to stand where the character's root is, facing the same way; heights
  /// stay.
  void align(std::size_t i, const Transform<T>& root_now) {
    SamplingJob<T>{&c_.asset->clips[c_.clips[i].clip], 0, 1, b_}.Run();
    const Quat<double> rest = c_.asset->skeleton.joints[0].rest.rotation;
    const Transform<double> now = root_now.template cast<double>();
    const Quat<double> first = b_[0].rotation.template cast<double>();
    const double turn = heading(now.rotation, rest) - heading(first, rest);
    const Transform<double> turned = upright(Vec3<double>::Zero(), turn);
    Vec3<double> shift = now.translation - turned * b_[0].translation.template cast<double>();
    shift.z() = c_.position.z();
    places_[i] = upright(shift, turn);
    aligned_[i] = true;
  }

  const SceneCharacter& c_;
  std::vector<Transform<double>> places_;
  std::map<std::size_t, bool> aligned_;
  std::vector<JointJet<T>> a_, b_;
};

template <class T>
class Runner {
 public:
  Runner(const Scene& scene, Recording& recording, Telemetry& telemetry)
      : s_(scene), recording_(recording), telemetry_(telemetry), world_(scene.world) {}

  convert::Error run(const std::function<void(int, int)>& progress) {
    if (convert::Error error = set_up()) return error;
    const int frames = static_cast<int>(std::ceil(s_.duration * s_.frame_rate - 1e-9));
    const T h = T(1 / s_.frame_rate);
    for (int f = 0; f <= frames; ++f) {
      const double t = f / s_.frame_rate;
      for (std::size_t c = 0; c < s_.characters.size(); ++c)
        if (convert::Error error = drive(static_cast<int>(c), t, f == 0)) return error;
      double microseconds = 0;
      if (f > 0) {
        launch_and_push(t - 1 / s_.frame_rate);
        const auto begin = std::chrono::steady_clock::now();
        const Status status = world_.step(h);
        microseconds =
            std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
        if (!status) return {std::string("step at ") + std::to_string(t) + " s: " + status.reason};
      }
      record(t, microseconds);
      if (progress) progress(f, frames);
    }
    return {};
  }

 private:
  convert::Error set_up() {
    Status status;
    recording_.title = s_.title;
    recording_.frame_rate = s_.frame_rate;
    recording_.camera = s_.camera;
    recording_.obstacles = s_.obstacles;
    for (const SceneCharacter& c : s_.characters) {
      CharacterSettings settings = c.settings;
      settings.strength = ramp_at(c.strength, 0);
      settings.root = value_at(c.root, 0, RootDrive::kKinematic);
      if (world_.add_character(c.asset->skeleton, settings, status) < 0)
        return {"character '" + c.name + "': " + status.reason};
      recording_.characters.push_back(c.asset);
      players_.emplace_back(c);
    }
    for (const Collider& o : s_.obstacles)
      if (status = world_.add_obstacle(o); !status) return {std::string("obstacle: ") + status.reason};
    for (const SceneProp& p : s_.props) {
      PropSettings settings = p.settings;
      if (p.launch_time > 0) settings.pose.translation = {0, 0, -1000};
      if (world_.add_prop(settings, status) < 0) return {"prop '" + p.name + "': " + status.reason};
      recording_.props.push_back(
          {p.name, p.settings.shape, p.settings.size.cast<float>(), static_cast<float>(p.settings.mass)});
      launched_.push_back(p.launch_time <= 0);
    }
    telemetry_.plotted_joint = recording_.plotted_joint = s_.plotted_joint;
    if (s_.plotted_joint >= 0)
      telemetry_.plotted_name = s_.characters[0].asset->skeleton.joints[s_.plotted_joint].name;
    return {};
  }

  convert::Error drive(int c, double t, bool first) {
    const SceneCharacter& source = s_.characters[c];
    Character<T> character = world_.character(c);
    const Status status = character.set_target(players_[c].at(t, character.model()[0]));
    if (!status) return {"character '" + source.name + "' at " + std::to_string(t) + " s: " + status.reason};
    if (first) {
      character.reset();
      return {};
    }
    character.set_strength(T(ramp_at(source.strength, t)));
    character.set_root_drive(value_at(source.root, t, RootDrive::kKinematic));
    return {};
  }

  void launch_and_push(double t) {
    for (std::size_t p = 0; p < s_.props.size(); ++p) {
      const SceneProp& prop = s_.props[p];
      if (!launched_[p] && t < prop.launch_time) {
        world_.set_prop(static_cast<int>(p), {Quat<T>::Identity(), {T(0), T(0), T(-1000)}}, Vec3<T>::Zero(),
                        Vec3<T>::Zero());
        continue;
      }
      if (launched_[p]) continue;
      launched_[p] = true;
      Vec3<double> from = prop.settings.pose.translation, velocity = prop.settings.velocity;
      if (prop.target_character >= 0) aim(prop, from, velocity);
      world_.set_prop(static_cast<int>(p), {Quat<T>::Identity(), from.cast<T>()}, velocity.cast<T>(),
                      Vec3<T>::Zero());
    }
    for (const Push& push : s_.pushes)
      if (push.time >= t - 1e-9 && push.time < t + 1 / s_.frame_rate - 1e-9) {
        Character<T> c = world_.character(push.character);
        c.apply_impulse(push.joint, c.model()[push.joint].translation, push.impulse.cast<T>());
      }
  }

  /// Ballistic launch that meets the moving joint: its velocity is taken from the root's.
  void aim(const SceneProp& prop, Vec3<double>& from, Vec3<double>& velocity) {
    const Character<T> c = world_.character(prop.target_character);
    const Transform<double> root = c.model()[0].template cast<double>();
    const Skeleton& skeleton = s_.characters[prop.target_character].asset->skeleton;
    const Vec3<double> joint = c.model()[prop.target_joint].template cast<double>() *
                               Vec3<double>(0.5 * skeleton.joints[prop.target_joint].center_of_mass);
    const double yaw = heading(root.rotation, skeleton.joints[0].rest.rotation);
    from = upright({root.translation.x(), root.translation.y(), 0}, yaw) * prop.from;
    const double flight = (joint - from).norm() / prop.speed;
    const Vec3<double> drift(root_velocity_.x(), root_velocity_.y(), 0);
    velocity = (joint + drift * flight - from) / flight - s_.world.gravity * (flight / 2);
  }

  void record(double t, double microseconds) {
    Frame frame;
    frame.time = t;
    frame.caption = value_at<std::string>(s_.captions, t, "");
    for (std::size_t n = 0; n < s_.characters.size(); ++n) {
      const Character<T> c = world_.character(static_cast<int>(n));
      const Skeleton& skeleton = c.skeleton();
      CharacterFrame made;
      for (const Transform<T>& x : c.model()) made.model.push_back(x.template cast<float>());
      made.load.assign(skeleton.joints.size(), 0);
      made.torque = made.limit = made.load;
      for (int i = 0; i < skeleton.body_count; ++i) {
        if (skeleton.joints[i].type == JointType::kFree) continue;
        const int dofs = dof_count(skeleton.joints[i].type);
        double most = 0;  // hinges show their sign, ball joints the size of their largest component
        for (int k = 0; k < dofs; ++k) {
          const auto dof = static_cast<std::size_t>(c.first_dof(i) + k);
          made.load[i] = std::max(made.load[i], float(c.load()[dof]));
          made.limit[i] = std::max(made.limit[i], float(c.limit()[dof]));
          most = std::max(most, std::abs(double(c.torque()[dof])));
        }
        made.torque[i] =
            dofs == 1 ? float(c.torque()[static_cast<std::size_t>(c.first_dof(i))]) : float(most);
      }
      for (std::size_t i = skeleton.body_count; i < skeleton.joints.size(); ++i)
        made.load[i] = made.load[skeleton.joints[i].parent];
      made.most_loaded_joint = static_cast<int>(
          std::max_element(made.load.begin(), made.load.begin() + skeleton.body_count) - made.load.begin());
      made.unknown_dofs = c.report().unknown_dofs;
      made.total_dofs = c.report().dofs;
      made.microseconds = static_cast<float>(microseconds);
      made.strength = static_cast<float>(ramp_at(s_.characters[n].strength, t));
      made.root_free = value_at(s_.characters[n].root, t, RootDrive::kKinematic) == RootDrive::kFree;
      if (n == 0) {
        const Vec3<double> root = made.model[0].translation.cast<double>();
        if (!recording_.frames.empty())
          root_velocity_ =
              (root - recording_.frames.back().characters[0].model[0].translation.template cast<double>()) *
              s_.frame_rate;
      }
      TelemetryRow row;
      row.time = t;
      row.character = static_cast<int>(n);
      row.report = c.report();
      row.microseconds = microseconds;
      row.loaded_joint = made.most_loaded_joint;
      row.load = double(made.load[row.loaded_joint]);
      row.torque = double(made.torque[row.loaded_joint]);
      row.limit = double(made.limit[row.loaded_joint]);
      const int plotted = s_.plotted_joint >= 0 && n == 0 ? s_.plotted_joint : row.loaded_joint;
      row.plotted_torque = double(made.torque[plotted]);
      row.plotted_limit = double(made.limit[plotted]);
      telemetry_.rows.push_back(row);
      frame.characters.push_back(std::move(made));
    }
    for (int p = 0; p < world_.prop_count(); ++p)
      frame.props.push_back({world_.prop_pose(p).template cast<float>()});
    recording_.frames.push_back(std::move(frame));
  }

  const Scene& s_;
  Recording& recording_;
  Telemetry& telemetry_;
  World<T> world_;
  std::vector<Player<T>> players_;
  std::vector<bool> launched_;
  Vec3<double> root_velocity_ = Vec3<double>::Zero();
};

}  // namespace

convert::Error run_scene(const Scene& scene, Recording& recording, Telemetry& telemetry,
                         const std::function<void(int, int)>& progress) {
  if (scene.double_precision) return Runner<double>(scene, recording, telemetry).run(progress);
  return Runner<float>(scene, recording, telemetry).run(progress);
}

std::string telemetry_csv(const Scene& scene, const Telemetry& telemetry) {
  std::string csv =
      "time_s,character,dofs,unknown_dofs,microseconds,outer_passes,factorisations,converged,bdf2,contacts,"
      "penetration_m,"
      "kinetic_J,potential_J,loaded_joint,load,torque_Nm,limit_Nm,plotted_torque_Nm,plotted_limit_Nm\n";
  char line[512];
  for (const TelemetryRow& r : telemetry.rows) {
    std::snprintf(line, sizeof line,
                  "%.6f,%s,%d,%d,%.2f,%d,%d,%d,%d,%d,%.6f,%.6f,%.6f,%s,%.4f,%.3f,%.3f,%.3f,%.3f\n", r.time,
                  scene.characters[r.character].name.c_str(), r.report.dofs, r.report.unknown_dofs,
                  r.microseconds, r.report.outer_passes, r.report.factorisations, r.report.converged,
                  r.report.used_bdf2, r.report.contacts, r.report.penetration, r.report.kinetic_energy,
                  r.report.potential_energy,
                  scene.characters[r.character].asset->skeleton.joints[r.loaded_joint].name.c_str(), r.load,
                  r.torque, r.limit, r.plotted_torque, r.plotted_limit);
    csv += line;
  }
  return csv;
}

nlohmann::json telemetry_summary(const Scene& scene, const Telemetry& telemetry) {
  nlohmann::json out{
      {"title", scene.title}, {"duration_s", scene.duration}, {"frame_rate", scene.frame_rate}};
  std::vector<double> playback, solved;
  int unconverged = 0, most = 0;
  for (const TelemetryRow& r : telemetry.rows) {
    if (r.time > 0) (r.report.unknown_dofs == 0 ? playback : solved).push_back(r.microseconds);
    unconverged += !r.report.converged;
    most = std::max(most, r.report.unknown_dofs);
  }
  const auto median = [](std::vector<double>& v) {
    if (v.empty()) return 0.0;
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  out["frames_playback"] = playback.size();
  out["frames_solved"] = solved.size();
  out["median_us_playback"] = median(playback);
  out["median_us_solved"] = median(solved);
  out["most_unknown_dofs"] = most;
  out["unconverged_steps"] = unconverged;
  return out;
}

convert::Error plot_telemetry(const std::string& csv_path, const Telemetry& telemetry,
                              const std::string& png_path) {
  const std::string script_path = png_path + ".gp";
  FILE* script = std::fopen(script_path.c_str(), "w");
  if (!script) return {script_path + ": cannot be written"};
  std::fprintf(
      script,
      "set terminal pngcairo size 1200,900 font ',11'\nset output '%s'\nset datafile separator ','\nset grid "
      "lc rgb '#dddddd'\n"
      "set lmargin 10\nset rmargin 4\nset multiplot layout 3,1\nset key top right\nset ylabel 'unknown "
      "DOFs'\n"
      "plot '%s' using 1:4 every ::1 with filledcurves y1=0 lc rgb '#3d9a8b' title 'handed to the "
      "optimizer'\n"
      "set ylabel 'µs per step'\nset logscale y\nplot '%s' using 1:5 every ::2 with lines lc rgb '#34556e' "
      "title 'world step'\n"
      "unset logscale y\nset ylabel 'N·m'\nset xlabel 'time, s'\n"
      "plot '%s' using 1:18 every ::1 with lines lw 2 lc rgb '#c8553d' title 'torque of %s', '' using 1:19 "
      "every ::1 with lines dt 2 lc rgb "
      "'#888888' title 'limit', '' using 1:(-$19) every ::1 with lines dt 2 lc rgb '#888888' notitle\n",
      png_path.c_str(), csv_path.c_str(), csv_path.c_str(), csv_path.c_str(), telemetry.plotted_name.c_str());
  std::fclose(script);
  const char* arguments[] = {"gnuplot", script_path.c_str(), nullptr};
  pid_t pid = 0;
  int status = -1;
  const bool started =
      posix_spawnp(&pid, "gnuplot", nullptr, nullptr, const_cast<char**>(arguments), environ) == 0;
  if (started) waitpid(pid, &status, 0);
  std::remove(script_path.c_str());
  if (!started) return {"gnuplot is not installed; no plot"};
  if (status != 0) return {"gnuplot could not draw " + png_path};
  return {};
}

}  // namespace sinew::scene
