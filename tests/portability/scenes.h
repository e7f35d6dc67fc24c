// Scenes that between them run every layer of the runtime, as functions of the scalar. Each tells a PoseHash
// of every frame where everything is.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/graph/graph.h"
#include "sinew/io/asset.h"
#include "sinew/skeleton/transform.h"

namespace sinew::portability {

/// FNV-1a over what it is told: every bit counts.
class PoseHash {
 public:
  template <class T>
  void add(std::span<const T> numbers) {
    for (const T& number : numbers) {
      unsigned char bytes[sizeof(T)];
      std::memcpy(bytes, &number, sizeof(T));
      for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 0x100000001b3u;
    }
  }
  template <class T>
  void add(const Transform<T>& pose) {
    const T numbers[] = {pose.rotation.x(),    pose.rotation.y(),    pose.rotation.z(),   pose.rotation.w(),
                         pose.translation.x(), pose.translation.y(), pose.translation.z()};
    add(std::span<const T>(numbers));
  }
  template <class T>
  void add(std::span<const Transform<T>> poses) {
    for (const Transform<T>& pose : poses) add(pose);
  }
  template <class T>
  void add(const Vec3<T>& v) {
    add(std::span<const T>(v.data(), 3));
  }
  /// After everything of a frame was added.
  void end_frame() {
    if (each_frame) each_frame(frame_, hash_);
    ++frame_;
  }
  std::uint64_t value() const { return hash_; }
  int frames() const { return frame_; }

  std::function<void(int frame, std::uint64_t hash)> each_frame;  ///< where wanted

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
  int frame_ = 0;
};

/// What scenes are made of: the demo's character and its graph.
struct Actors {
  Asset asset;
  GraphDefinition definition;
  Graph graph;

  /// Reads both files, and makes sure that the clips are there which scenes play.
  Status load(const char* asset_file, const char* graph_file);
  const Clip& clip(const char* name) const { return asset.clips[std::size_t(asset.find_clip(name))]; }
};

struct Scene {
  const char* name;
  const char* about;
  std::string (*in_float)(const Actors&, PoseHash&);  ///< what went wrong, or ""
  std::string (*in_double)(const Actors&, PoseHash&);
};

/// All of them.
std::span<const Scene> scenes();

}  // namespace sinew::portability
