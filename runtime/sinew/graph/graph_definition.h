// A graph of clips as data: what a character may do, and when it goes from one thing to the next.
//
// This is what a graph file holds and what the compiler of JSON makes (tools/graph). To play it, bind it to
// an asset: see graph.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sinew/animation/foot_lock.h"
#include "sinew/animation/look_at_job.h"
#include "sinew/skeleton/status.h"

namespace sinew {

/// What a game gives a graph.
enum class ParameterType : std::uint8_t {
  kFloat,    ///< a number that the game sets; weights, speeds and blends see it filtered
  kBool,     ///< 0 or 1, for conditions
  kTrigger,  ///< asked for once; the transition that it lets through uses it up
};

/// An input of a graph.
struct GraphParameter {
  std::string name;                            ///< by which find_parameter() finds it
  ParameterType type = ParameterType::kFloat;  ///< says which of the others it has
  float value = 0;                             ///< at the start
  float half_life = 0.1f;  ///< s, of the filter that floats go through (SmoothInput); 0: as the game sets it
  float buffer = 0.15f;    ///< s, how long a trigger waits for a transition that takes it
};

/// A weight or a speed: a number, or a float parameter.
struct GraphValue {
  float constant = 1;  ///< where there is no parameter
  int parameter = -1;  ///< of GraphDefinition::parameters; −1: none
};

/// What a step of a condition does on a stack of numbers; 0 is false, all others are true.
enum class ConditionCode : std::uint8_t {
  kNumber,     ///< pushes `value`
  kParameter,  ///< pushes parameter `index`, unfiltered; a trigger that waits is 1
  kTime,       ///< pushes the seconds in the present state
  kRemaining,  ///< pushes the seconds until the end of the state's leading clip, at its present speed
  kPhase,      ///< pushes the phase of group `index`, 0 … 1
  kEvent,      ///< pushes 1 where the frame before passed event `index` (GraphDefinition::events)
  kFading,     ///< pushes 1 while a transition of this machine runs
  kLess,       ///< replaces the two uppermost, a below b, by a < b: 0 or 1
  kLessEqual,  ///< likewise, a ≤ b
  kEqual,      ///< likewise, a = b, to the bit
  kAnd,        ///< likewise, both are true
  kOr,         ///< likewise, one is
  kNot,        ///< replaces the uppermost by 1 where it is 0, else by 0
};

/// One instruction of a condition; conditions are in postfix order.
struct ConditionStep {
  ConditionCode code = ConditionCode::kNumber;  ///< what it does
  std::uint16_t index = 0;                      ///< kParameter, kPhase, kEvent: which one
  float value = 0;                              ///< kNumber; finite
};

/// How a motion becomes another one.
enum class TransitionKind : std::uint8_t {
  kInertial,    ///< the new state alone, and what was different fades away (InertializeJob)
  kDead,        ///< as kInertial from what the old motion goes on as without a source (ExtrapolateJob)
  kCrossfade,   ///< both states play; one that interrupts a transition is kInertial
  kCut,         ///< at once: the pose jumps
  kSmoothstep,  ///< kCrossfade by 3x² − 2x³, as is usual: accelerations jump. For comparison
};

/// What may end a transition that runs.
enum class Interruption : std::uint8_t {
  kAny,     ///< by every transition whose condition holds
  kListed,  ///< only by transitions to the states in `interrupted_by`
  kNever,   ///< it runs to its end
};

/// From one state of a machine to another.
struct GraphTransition {
  static constexpr int kAnyState = -1;              ///< for `from`
  int from = kAnyState;                             ///< state; kAnyState: all but `to`
  int to = 0;                                       ///< state
  std::vector<ConditionStep> condition;             ///< empty: always
  TransitionKind kind = TransitionKind::kInertial;  ///< how
  float duration = 0.25f;                           ///< s
  /// > 0: as long as the joints' muscles need, who may spend this share of what they can spare on it
  /// (GraphPoseJob::muscles); `duration` is the longest then, and without them.
  float budget = 0;
  Interruption interrupt = Interruption::kAny;  ///< by what, while it runs
  std::vector<int> interrupted_by;              ///< kListed: states
  float entry = 0;                              ///< s, where unsynchronised clips of the new state begin
  /// Of inertial ones without a budget: a mask of the asset, whose joints are done after `share` of the
  /// duration (0.1 … 1, by their weights in the mask); "": all take as long. As InertializeJob::profile.
  std::string profile;
  float share = 1;  ///< see `profile`
};

/// One of the things that a machine may do.
struct GraphState {
  std::string name;  ///< for people and tools
  int node = -1;     ///< −1: a conduit, passed through in the same frame or not entered at all
};

/// What a node does to make its pose.
enum class NodeType : std::uint8_t {
  kClip,      ///< plays a clip
  kBlend,     ///< children with a point each, by one or two parameters
  kLayers,    ///< children[0], and layers upon it
  kMachine,   ///< states
  kEmpty,     ///< no pose: a state of a machine that is a layer, which then fades out
  kPhysical,  ///< the pose that the physical character has
  kMirror,    ///< children[0], left and right exchanged (MirrorJob)
  kTravel,    ///< children[0], which goes over the ground as parameters say
  // Of the whole pose where the character stands: only one another may be above them.
  kFeet,  ///< children[0] with its feet on the ground (FootPlacementJob)
  kLook,  ///< children[0] looking at something (LookAtJob)
};

/// What a layer does to the pose below it.
enum class LayerMode : std::uint8_t {
  kOverride,     ///< takes its place, by weight and mask; curves and travel, too
  kAdditive,     ///< adds what differs from the reference, in the joints' own axes
  kMeshAdditive  ///< the same in model space (MeshAdditiveJob)
};

/// What lies upon the first child of a kLayers node.
struct GraphLayer {
  std::string mask;   ///< of the asset; empty: all joints
  GraphValue weight;  ///< 0 … 1; a parameter goes through a soft step, which keeps it there
  LayerMode mode = LayerMode::kOverride;  ///< how
  std::string reference;                  ///< additive: the clip whose pose is no difference; empty: rest
  float reference_time = 0;               ///< s
};

/// Root motion that a game's controller has a say in.
struct GraphTravel {
  int parameters[3] = {-1, -1, -1};  ///< m/s forwards, m/s to the left, rad/s; −1: as the clips go
  bool adds = false;                 ///< to what the clips do, or in place of that
  GraphValue weight;                 ///< 0 … 1
};

/// Feet on the ground that there is (FootPlacementJob); left and right are found by their roles.
struct GraphFeet {
  GraphValue weight;  ///< 0 … 1
  /// m, height of the ground on which the character goes: the game's own. −1: the character is lifted as the
  /// ground rises under it.
  int level = -1;
  bool locks = true;             ///< feet that bear stay where they are
  FootSettings<float> settings;  ///< of both
  float reach = 0.995f;          ///< see FootPlacementJob
  float follow = 0.5f;           ///< see FootPlacementJob
  float rise = 0.07f;            ///< s, see FootPlacementJob
  float deepest = 0.3f;          ///< m, see FootPlacementJob
  float lift = 0.2f;             ///< s, half-life of the character's height over ground that rises
};

/// A look at something (LookAtJob).
struct GraphLook {
  GraphValue weight;                ///< 0 … 1
  int target[3] = {-1, -1, -1};     ///< parameters, m
  bool in_world = true;             ///< or ahead, to the left and above of where the character stands
  std::vector<std::string> joints;  ///< from the root outwards; none: by their roles
  std::vector<float> shares;        ///< of the turn
  LookSettings<float> settings;     ///< limits and speeds
};

/// A pose, or what is made of those of its children. Members that name a type are of that type alone.
struct GraphNode {
  NodeType type = NodeType::kClip;  ///< what it is
  std::string name;                 ///< where it stands: "main/move/walk"
  std::vector<int> children;        ///< before their parents in GraphDefinition::nodes

  std::string clip;         ///< kClip
  GraphValue speed;         ///< kClip
  int group = -1;           ///< kClip: plays by this group's phase
  bool root_motion = true;  ///< kClip: what the root does on the ground moves the character

  int parameters[2] = {-1, -1};  ///< kBlend; the second only in two dimensions
  std::vector<float> points;     ///< kBlend: [child][dimension]

  std::vector<GraphLayer> layers;  ///< kLayers: of children[1], children[2], …

  std::vector<GraphState> states;            ///< kMachine
  std::vector<GraphTransition> transitions;  ///< kMachine: the first that may be taken is
  int start = 0;                             ///< kMachine: state

  GraphTravel travel;  ///< kTravel
  GraphFeet feet;      ///< kFeet
  GraphLook look;      ///< kLook
};

/// Plain data; validate() says what is wrong with it.
struct GraphDefinition {
  static constexpr int kMostNodes = 4096;       ///< validate() refuses more
  static constexpr int kMostParameters = 256;   ///< likewise, and of groups
  static constexpr int kMostEvents = 32;        ///< a bit each in a character's block
  static constexpr int kDeepest = 24;           ///< levels of nodes
  static constexpr int kDeepestCondition = 16;  ///< numbers on the stack
  static constexpr int kMostConduits = 8;       ///< one after another

  std::string name;                        ///< may be empty
  std::vector<GraphParameter> parameters;  ///< what the game sets
  std::vector<std::string> groups;         ///< of clips that step together
  std::vector<std::string> events;         ///< that conditions ask for
  std::vector<GraphNode> nodes;            ///< the last one is the root

  int find_parameter(const std::string& wanted) const;  ///< index, or −1
};

/// What a float parameter is called that set_physics() is to set (graph_physics.h), in the order of
/// PhysicsValues; kPhysicsLoad with a dot and the name of a mask behind it is the load of those joints alone.
inline constexpr const char* kPhysicsNames[] = {
    "physics.tilt",     "physics.face_up",       "physics.height",        "physics.load",
    "physics.contacts", "physics.off_animation", "physics.contact_force",
};
inline constexpr int kPhysicsLoad = 3;  ///< of kPhysicsNames

/// Which of kPhysicsNames a name is, or −1. `mask`: where in the name that of a mask begins, or 0.
int physics_value(const std::string& name, std::size_t& mask);

/// Is the node a machine that may show nothing? Then it is a layer.
bool has_empty_state(const GraphDefinition& graph, int node);

/// What is at fault, if anything, so that playing it needs no further checks: indices, order of nodes,
/// numbers, depth, stacks of conditions. `Status::index`: node, or parameter.
Status validate(const GraphDefinition& graph);

}  // namespace sinew
