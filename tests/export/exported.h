// What export tests share: assets, files of this process, other programs where they are installed.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "convert/convert.h"
#include "export/motion.h"
#include "fixtures/paths.h"

namespace sinew::exporting::test {

constexpr double kSamePlace = 1e-4;  ///< m: what a tool may move a joint by

/// The project's character with its clips.
inline Asset mannequin() {
  Asset asset;
  const Status status = load_asset((binary_dir() + "/sample.sinew").c_str(), asset);
  EXPECT_TRUE(status) << status.reason;
  return asset;
}

inline std::string shared_asset(const std::string& name) {
  return shared_dir() + "/assets/" + name;
}

inline Asset converted(const std::string& path, const nlohmann::json& options = nlohmann::json::object()) {
  Asset asset;
  nlohmann::json report;
  const convert::Error error = convert::convert_files({path}, options, asset, report);
  EXPECT_FALSE(error) << error.message;
  return asset;
}

/// A path in a directory of this process.
inline std::string own_path(const std::string& name) {
  const std::string directory = testing::TempDir() + "sinew_export_" + std::to_string(getpid()) + "/";
  std::filesystem::create_directories(directory);
  return directory + name;
}

inline std::string written(const std::string& name, const std::string& bytes) {
  std::string path = own_path(name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

struct Outcome {
  int code = -1;
  std::string out;  ///< standard output
};

inline Outcome run(const std::string& command) {
  Outcome result;
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) result.out.append(buffer, n);
  result.code = WEXITSTATUS(pclose(pipe));
  return result;
}

/// Where the joints of a motion are, time by time, by name.
struct Track {
  std::string motion;
  std::vector<double> times;
  std::vector<std::string> joints;
  std::vector<std::vector<Vec3<double>>> places;    ///< [time][joint] m, Sinew's axes
  std::string mesh;                                 ///< whose vertices are compared as well, or none
  std::vector<std::vector<Vec3<double>>> vertices;  ///< [time][vertex] m, Sinew's axes
};

inline nlohmann::json as_json(const std::vector<std::vector<Vec3<double>>>& frames) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& places : frames) {
    nlohmann::json frame = nlohmann::json::array();
    for (const Vec3<double>& p : places) frame.push_back({p.x(), p.y(), p.z()});
    out.push_back(std::move(frame));
  }
  return out;
}

inline Track track_of(const Skeleton& skeleton, const Motion& motion) {
  Track track{motion.name, motion.times, {}, {}, {}, {}};
  for (const Joint& joint : skeleton.joints) track.joints.push_back(joint.name);
  for (const auto& frame : motion.frames) {
    std::vector<Vec3<double>> places;
    for (const Transform<double>& x : model_pose(skeleton, frame)) places.push_back(x.translation);
    track.places.push_back(std::move(places));
  }
  return track;
}

/// Opens a file in Blender and compares where its bones begin, and vertices where a track has some. Skips the
/// test where there is no Blender.
inline void expect_same_in_blender(const std::string& file, const std::vector<Track>& tracks) {
  if (run("blender --version 2>/dev/null").code != 0 ||
      run("blender -b --factory-startup --python-exit-code 1 --python-expr 'import numpy' 2>&1").code != 0)
    GTEST_SKIP() << "Blender (Debian: blender, python3-numpy) is not installed: not compared with it";
  nlohmann::json expected = nlohmann::json::array();
  for (const Track& track : tracks)
    expected.push_back({{"motion", track.motion},
                        {"times", track.times},
                        {"joints", track.joints},
                        {"places", as_json(track.places)},
                        {"mesh", track.mesh},
                        {"vertices", as_json(track.vertices)}});
  const std::string wanted = written("expected.json", expected.dump()), answer = own_path("answer.json");
  const Outcome blender =
      run("blender -b --factory-startup --python-exit-code 1 --python " + source_dir() +
          "/tests/export/compare_in_blender.py -- '" + file + "' " + wanted + " " + answer + " 2>&1");
  ASSERT_EQ(blender.code, 0) << blender.out;
  const nlohmann::json found = nlohmann::json::parse(std::ifstream(answer));
  ASSERT_EQ(found.size(), tracks.size());
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    EXPECT_EQ(found[k]["frames"].get<std::size_t>(), tracks[k].times.size());
    EXPECT_LT(found[k]["largest_m"].get<double>(), kSamePlace)
        << tracks[k].motion << ": " << found[k]["where"];
  }
}

}  // namespace sinew::exporting::test
