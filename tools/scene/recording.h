// What a simulation leaves behind for the renderer and the plots: everything that a frame of video shows.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/drawing.h"
#include "sinew/io/asset.h"

namespace sinew::scene {

/// One character in one frame.
struct CharacterFrame {
  std::vector<Transform<float>> model;  ///< [joint] joint → world
  std::vector<float> load;  ///< [joint] largest |residual| / limit over the joint's DOFs; 1 = saturated
  std::vector<float>
      effort;  ///< [joint] the same of the limit at full strength, fading over 0.1 s: what colours show
  std::vector<float> torque;  ///< [joint] of the most loaded DOF, N·m
  std::vector<float> limit;   ///< [joint] of that DOF and direction, N·m
  std::vector<float> curves;  ///< [slot of its asset's curves], or empty: all at rest
  int unknown_dofs = 0;       ///< DOFs handed to the optimizer in this frame (0 = playback)
  int total_dofs = 0;
  float microseconds = 0;  ///< of the step
  int most_loaded_joint = -1;
  float strength = 1;
  bool root_free = false;

  /// What colours show of a joint; 0 where nobody filled `effort`.
  float effort_of(std::size_t joint) const { return joint < effort.size() ? effort[joint] : 0; }
  /// A curve's value; 0 of a slot that the asset does not have.
  float curve(const Asset& asset, std::size_t slot) const {
    if (slot < curves.size()) return curves[slot];
    return slot < asset.curve_slots.size() ? asset.curve_slots[slot].rest : 0;
  }
};

struct PropFrame {
  Transform<float> world;
};

constexpr float kHidden = -1000;  ///< m: height of a prop that is not there yet; not drawn

struct Prop {
  std::string name;
  Shape shape = Shape::kSphere;
  Vec3<float> size = Vec3<float>::Constant(0.1f);
  float mass = 1;
  const ConvexHull* hull = nullptr;  ///< of who is convex
};

struct Frame {
  double time = 0;  ///< s
  std::vector<CharacterFrame> characters;
  std::vector<PropFrame> props;
  std::string caption;  ///< "walk · playback", "hit", … lower third; may be empty
  Drawing inside;       ///< where Recording::shows_inside asks for it
};

struct Camera {
  Vec3<float> eye{3.5f, -3.5f, 1.6f}, target{0, 0, 0.9f};
  float vertical_fov_deg = 32;
  int follow_character = -1;  ///< eye and target move with its pelvis horizontally (smoothed), when ≥ 0
  bool frame_automatically = true;  ///< ignore eye distance; fit the bounding box of the whole recording
};

struct Recording {
  std::string title;
  double frame_rate = 60;
  std::vector<std::shared_ptr<const Asset>> characters;
  std::vector<std::string> names;  ///< [character] as the scene calls them; empty: as their assets are called
  std::vector<Prop> props;
  std::vector<Frame> frames;
  Camera camera;
  std::optional<float> ground = 0.f;  ///< m, height of the floor; none: drawn below everything
  std::vector<Collider> obstacles;    ///< static shapes in world space (joint unused)
  bool shows_inside = false;          ///< asked for before the run: frames hold what the world has inside
  int plotted_joint = -1;             ///< torque curve in the overlay; -1: the most loaded over the recording
};

}  // namespace sinew::scene
