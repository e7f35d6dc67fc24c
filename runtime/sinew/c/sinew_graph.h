/// @file
/// Graphs of clips: what a character may do, as data that `sinew graph compile` writes. Part of sinew.h.
///
///     sinew_graph graph;
///     int32_t speed;
///     sinew_graph_load("hero.sgraph", asset, &graph);
///     sinew_graph_find_parameter(graph, "speed", &speed);
///     sinew_character_add_graph(hero, graph, NULL);
///     sinew_character_play_graph(hero, 0);
///     sinew_character_reset(hero);
///     for (;;) {
///       sinew_character_set_parameter(hero, speed, stick);
///       sinew_character_play_graph(hero, 1 / 60.f);  // where it goes in this time becomes its target
///       sinew_world_step(world, 1 / 60.f);
///     }
///
/// Nodes, states and parameters are numbered; sinew_graph_find_... gives the numbers of names.
#ifndef SINEW_C_SINEW_GRAPH_H
#define SINEW_C_SINEW_GRAPH_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

// ---- Graphs ----

/// What may be done with the clips of an asset; constant, for any number of characters. Destroy it.
typedef uint64_t sinew_graph;

/// What a parameter is.
typedef int32_t sinew_parameter_type;
/// Values of sinew_parameter_type.
enum sinew_parameter_type_values {
  SINEW_PARAMETER_FLOAT = 0,   ///< a number; weights, speeds and blends see it filtered
  SINEW_PARAMETER_BOOL = 1,    ///< 0 or 1, for conditions
  SINEW_PARAMETER_TRIGGER = 2  ///< asked for once; the transition that it lets through uses it up
};

/// What a node does.
typedef int32_t sinew_node_type;
/// Values of sinew_node_type.
enum sinew_node_type_values {
  SINEW_NODE_CLIP = 0,      ///< plays a clip
  SINEW_NODE_BLEND = 1,     ///< mixes others by one or two parameters
  SINEW_NODE_LAYERS = 2,    ///< lays others upon the first
  SINEW_NODE_MACHINE = 3,   ///< is in one of several states
  SINEW_NODE_EMPTY = 4,     ///< no pose: a layer that has faded out
  SINEW_NODE_PHYSICAL = 5,  ///< the pose that the character has
  SINEW_NODE_MIRROR = 6,    ///< left and right exchanged
  SINEW_NODE_TRAVEL = 7,    ///< goes over the ground as parameters say
  SINEW_NODE_FEET = 8,      ///< feet on the ground
  SINEW_NODE_LOOK = 9       ///< looks at something
};

/// What a graph holds.
typedef struct sinew_graph_info {
  uint32_t size;         ///< bytes of this struct, as the caller knows it
  int32_t joints;        ///< of the asset
  int32_t parameters;    ///< that the game sets
  int32_t nodes;         ///< the last one is the root
  int32_t curves;        ///< of the asset, that clips move
  int32_t unused;        ///< 0
  uint64_t state_bytes;  ///< that sinew_character_save_graph writes
} sinew_graph_info;

/// One parameter of a graph.
typedef struct sinew_parameter_info {
  uint32_t size;              ///< bytes of this struct, as the caller knows it
  sinew_parameter_type type;  ///< what it is
  const char* name;           ///< while the graph lives
  float value;                ///< at the start
  float half_life;            ///< s, of the filter of a float; 0: as the game sets it
  float buffer;               ///< s, how long a trigger waits for a transition that takes it
  int32_t unused;             ///< 0
} sinew_parameter_info;

/// One node of a graph.
typedef struct sinew_node_info {
  uint32_t size;         ///< bytes of this struct, as the caller knows it
  sinew_node_type type;  ///< what it does
  const char* name;      ///< while the graph lives: where it stands, "main/move/walk"
  int32_t states;        ///< of a machine
  int32_t start;         ///< state in which a machine begins
} sinew_node_info;

/// One state of a machine.
typedef struct sinew_state_info {
  uint32_t size;     ///< bytes of this struct, as the caller knows it
  int32_t node;      ///< what it shows; -1: a conduit, in which a machine never stays
  const char* name;  ///< while the graph lives
} sinew_state_info;

/// Set-up: reads a file and binds it to an asset's clips, which may be destroyed then. Where the asset has
/// not what the graph needs, sinew_last_index() is the node or parameter (`sinew graph check` names it).
SINEW_API sinew_status sinew_graph_load(const char* path, sinew_asset asset, sinew_graph* out);
/// The same from memory, which is copied.
SINEW_API sinew_status sinew_graph_read(const void* bytes, size_t size, sinew_asset asset, sinew_graph* out);
/// Characters that follow it keep what they need.
SINEW_API sinew_status sinew_graph_destroy(sinew_graph graph);
/// Sizes.
SINEW_API sinew_status sinew_graph_get_info(sinew_graph graph, sinew_graph_info* out);
/// One parameter, by index.
SINEW_API sinew_status sinew_graph_get_parameter(sinew_graph graph, int32_t parameter,
                                                 sinew_parameter_info* out);
/// Index of a name; SINEW_NOT_FOUND. O(parameters).
SINEW_API sinew_status sinew_graph_find_parameter(sinew_graph graph, const char* name, int32_t* out);
/// One node, by index.
SINEW_API sinew_status sinew_graph_get_node(sinew_graph graph, int32_t node, sinew_node_info* out);
/// Index of a name; SINEW_NOT_FOUND. O(nodes).
SINEW_API sinew_status sinew_graph_find_node(sinew_graph graph, const char* name, int32_t* out);
/// One state of a machine, by index. `machine`: a node of the graph.
SINEW_API sinew_status sinew_graph_get_state(sinew_graph graph, int32_t machine, int32_t state,
                                             sinew_state_info* out);

// ---- Characters that follow a graph ----

/// What the feet of a graph (SINEW_NODE_FEET) stand on.
typedef int32_t sinew_ground_kind;
/// Values of sinew_ground_kind.
enum sinew_ground_kind_values {
  SINEW_GROUND_LEVEL = 0,  ///< level ground, at the height that the graph's parameter says, or 0
  SINEW_GROUND_WORLD =
      1,  ///< the world's floor, obstacles and shapes; what begins above a foot's ray is passed by
  SINEW_GROUND_HOST = 2  ///< what `below` answers
};

/// The highest ground below a world point [3] (m): write it into `hit`, which holds that point on level
/// ground at rest before. The answer 0: there is none, and what was known stays. Called within
/// sinew_character_play_graph and its like, a dozen times a frame. No call of Sinew for this world.
typedef int32_t (*sinew_ground_below)(void* context, const float point[3], sinew_ground_hit* hit);

/// How a character follows a graph.
typedef struct sinew_graph_settings {
  uint32_t size;             ///< bytes of this struct, as the caller knows it
  int32_t events;            ///< of one frame that find room, 0 to 65536
  double place[2];           ///< m, x and y: where it begins
  double heading;            ///< rad, about Z
  sinew_ground_kind ground;  ///< what feet stand on
  uint32_t layers;           ///< of the world's obstacles, those that have one of these bits
  double reach;              ///< m, how far below feet the world is looked at
  sinew_ground_below below;  ///< of SINEW_GROUND_HOST
  void* context;             ///< given to `below`; must outlive the world
  /// Flag, on: every sinew_world_step sets those float parameters whose names begin with "physics.", as
  /// sinew_character_get_physics tells them: physics.tilt, physics.face_up, physics.height, physics.load,
  /// physics.load.MASK (of the joints of one of the asset's masks), physics.off_animation, physics.contacts,
  /// physics.contact_force.
  int32_t physics;
  int32_t unused;  ///< 0
} sinew_graph_settings;

/// A parameter, as set and as weights and speeds see it.
typedef struct sinew_parameter_value {
  float goal;          ///< as the game set it; of a trigger the seconds that it still waits
  float value;         ///< filtered
  float rate;          ///< 1/s
  float acceleration;  ///< 1/s2
} sinew_parameter_value;

/// Where a machine is.
typedef struct sinew_machine_report {
  uint32_t size;     ///< bytes of this struct, as the caller knows it
  int32_t state;     ///< that it is in; while a transition runs, the one that it goes to
  const char* name;  ///< of the state, while the graph or the world lives
  double time;       ///< s, in that state
  int32_t fading;    ///< flag: a transition runs
  int32_t unused;    ///< 0
} sinew_machine_report;

/// Where root motion has brought a character, and how it goes on.
typedef struct sinew_graph_place {
  double place[2];    ///< m, x and y
  double heading;     ///< rad, about Z
  float velocity[3];  ///< forwards and to the left, m/s, and of the turn, rad/s
  float change[3];    ///< m/s2, rad/s2
} sinew_graph_place;

/// Where in a part of a clip an event is.
typedef int32_t sinew_event_kind;
/// Values of sinew_event_kind.
enum sinew_event_kind_values {
  SINEW_EVENT_INSTANT = 0,  ///< it has no length
  SINEW_EVENT_BEGIN = 1,    ///< the part has begun
  SINEW_EVENT_END = 2       ///< it is over, or its clip has stopped to play
};

/// An event of a clip that a frame passed.
typedef struct sinew_graph_event {
  uint32_t name;          ///< number of its name: sinew_asset_find_event
  sinew_event_kind kind;  ///< of an instant or of a part
  float weight;           ///< of its clip, 0 to 1
  float seconds_ago;      ///< before the end of the frame
  float begin;            ///< s of the clip
  float end;              ///< s of the clip
  uint8_t payload[16];    ///< the game's
} sinew_graph_event;

/// A number that clips move.
typedef struct sinew_curve_value {
  float value;         ///< now
  float rate;          ///< 1/s
  float acceleration;  ///< 1/s2
} sinew_curve_value;

/// Of one character in sinew_play_graphs.
typedef struct sinew_graph_play {
  sinew_character character;  ///< who follows its graph
  float h;                    ///< s, 0 to 1
  int32_t unused;             ///< 0
} sinew_graph_play;

/// The library's defaults.
SINEW_API sinew_status sinew_graph_settings_init(sinew_graph_settings* settings);
/// Set-up: the character follows the graph, from its start. One a character, for good; the graph is of an
/// asset with the character's skeleton. All that it remembers belongs to the world's snapshots of the state.
/// `settings` may be null.
SINEW_API sinew_status sinew_character_add_graph(sinew_character character, sinew_graph graph,
                                                 const sinew_graph_settings* settings);
/// Moves the graph on by h seconds (0 to 1), and what it wants then is wanted at the end of the next step.
/// States that follow the physical pose begin at the one that the character has, and as it moves
/// (sinew_character_get_motion). Transitions with a budget take what its muscles have left. Where a look or a
/// foot fails, sinew_last_index() is its node: the graph has moved on, and the target is whole without it.
/// Allocates nothing.
SINEW_API sinew_status sinew_character_play_graph(sinew_character character, float h);
/// The same of any number of characters, also of several worlds. Stops at the first that is refused:
/// sinew_last_index() says which.
SINEW_API sinew_status sinew_play_graphs(const sinew_graph_play* plays, int32_t count);
/// The same, into jets of the caller's instead of the target, for whoever changes them: one for each joint,
/// aligned to 16 bytes.
SINEW_API sinew_status sinew_character_sample_graph(sinew_character character, float h, sinew_jet* jets,
                                                    int32_t count);
/// A float, or a bool as 0 or 1; within 1e6.
SINEW_API sinew_status sinew_character_set_parameter(sinew_character character, int32_t parameter,
                                                     float value);
/// The same by name; SINEW_NOT_FOUND. O(parameters).
SINEW_API sinew_status sinew_character_set_parameter_by_name(sinew_character character, const char* name,
                                                             float value);
/// Asks for something once; forgotten when no transition has taken it in time.
SINEW_API sinew_status sinew_character_trigger(sinew_character character, int32_t parameter);
/// The same by name; SINEW_NOT_FOUND. O(parameters).
SINEW_API sinew_status sinew_character_trigger_by_name(sinew_character character, const char* name);
/// As set, and filtered.
SINEW_API sinew_status sinew_character_get_parameter(sinew_character character, int32_t parameter,
                                                     sinew_parameter_value* out);
/// The state that a machine is in. `machine`: a node of the graph.
SINEW_API sinew_status sinew_character_get_machine(sinew_character character, int32_t machine,
                                                   sinew_machine_report* out);
/// Where its root motion has brought it.
SINEW_API sinew_status sinew_character_get_graph_place(sinew_character character, sinew_graph_place* out);
/// Puts it elsewhere: [2] x and y (m), and heading (rad). Its target jumps with the next frame: reset it
/// then.
SINEW_API sinew_status sinew_character_put_graph(sinew_character character, const double place[2],
                                                 double heading);
/// What sinew_ground_hit::body refers to, at most 8, from the next frame on: frames to world and how they
/// move, aligned to 16 bytes.
SINEW_API sinew_status sinew_character_set_grounds(sinew_character character, const sinew_jet* bodies,
                                                   int32_t count);
/// Events of the last frame, heaviest clip of a blend first. `count`: how many, also with SINEW_TOO_SMALL;
/// `lost` (may be null): found no room in sinew_graph_settings::events.
SINEW_API sinew_status sinew_character_get_graph_events(sinew_character character, sinew_graph_event* out,
                                                        int32_t capacity, int32_t* count, int32_t* lost);
/// The asset's curves in the last frame, as sinew_asset_find_curve numbers them. `count`: how many, also with
/// SINEW_TOO_SMALL.
SINEW_API sinew_status sinew_character_get_graph_curves(sinew_character character, sinew_curve_value* out,
                                                        int32_t capacity, int32_t* count);
/// Copies all that its graph remembers; sizes as of sinew_world_save.
SINEW_API sinew_status sinew_character_save_graph(sinew_character character, void* out, size_t capacity,
                                                  size_t* size);
/// Refuses what sinew_character_save_graph for the same graph did not write, with nothing moved.
SINEW_API sinew_status sinew_character_restore_graph(sinew_character character, const void* bytes,
                                                     size_t size);

#endif
