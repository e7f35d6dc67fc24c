/* What the page asks of Sinew: one character that plays a clip, and balls that are thrown at it. The page's
 * script calls these functions and reads their results out of WebAssembly's memory; it knows no C structs. */
#include <emscripten.h>
#include <sinew/c/sinew.h>

#define BALLS 8
static const float kBallRadius = 0.12f; /* m */

static sinew_asset asset;
static sinew_world world;
static sinew_character hero;
static sinew_prop balls[BALLS];
static int32_t clip, next_ball;
static double played;   /* s of the clip */
static double down_for; /* s until its muscles are back */
static float strength = 1;
static sinew_character_report report = {.size = sizeof report};

static sinew_status add_balls(void) {
  for (int b = 0; b < BALLS; ++b) {
    sinew_prop_settings ball = {.size = sizeof ball};
    sinew_status status = sinew_prop_settings_init(&ball);
    ball.shape = SINEW_SHAPE_SPHERE;
    ball.extent[0] = kBallRadius;
    ball.mass = 4;
    ball.restitution = 0.3;
    if (status == SINEW_OK) status = sinew_world_add_prop(world, &ball, &balls[b]);
    if (status == SINEW_OK) status = sinew_prop_park(balls[b]);
    if (status != SINEW_OK) return status;
  }
  return SINEW_OK;
}

static sinew_status target(double ahead) {
  const sinew_play play = {.character = hero, .asset = asset, .clip = clip, .time = played + ahead, .rate = 1};
  return sinew_play_clips(&play, 1);
}

/* Null when all is well, else what is wrong. After it the character stands at rest: what the page measures its
 * bones by. */
EMSCRIPTEN_KEEPALIVE const char* page_open(const void* bytes, size_t size) {
  sinew_status status = sinew_asset_read(bytes, size, &asset);
  if (status == SINEW_OK) status = sinew_world_create(NULL, &world);
  sinew_character_settings settings = {.size = sizeof settings};
  if (status == SINEW_OK) status = sinew_character_settings_init(&settings);
  settings.root = SINEW_ROOT_ASSISTED;
  settings.self_collision = 1;
  if (status == SINEW_OK) status = sinew_world_add_character(world, asset, &settings, &hero);
  if (status == SINEW_OK) status = add_balls();
  return status == SINEW_OK ? NULL : sinew_last_reason();
}

EMSCRIPTEN_KEEPALIVE const char* page_play(const char* name) {
  if (sinew_asset_find_clip(asset, name, &clip) != SINEW_OK) return sinew_last_reason();
  played = 0;
  if (target(0) != SINEW_OK || sinew_character_reset(hero) != SINEW_OK) return sinew_last_reason();
  return NULL;
}

EMSCRIPTEN_KEEPALIVE int page_joints(void) {
  sinew_asset_info info = {.size = sizeof info};
  return sinew_asset_get_info(asset, &info) == SINEW_OK ? info.joints : 0;
}

EMSCRIPTEN_KEEPALIVE const char* page_joint_name(int joint) {
  sinew_joint_info info = {.size = sizeof info};
  return sinew_asset_get_joint(asset, joint, &info) == SINEW_OK ? info.name : NULL;
}

/* Eight floats a joint: rotation x y z w, translation (m, world, z up), one that nobody reads. */
EMSCRIPTEN_KEEPALIVE const float* page_models(void) {
  sinew_view view;
  return sinew_character_get_view(hero, SINEW_VIEW_MODEL, &view) == SINEW_OK ? view.data : NULL;
}

EMSCRIPTEN_KEEPALIVE void page_strength(float of_its_own) {
  strength = of_its_own;
  if (down_for <= 0) sinew_character_set_strength(hero, strength);
}

/* Muscles and root let go for so many seconds. */
EMSCRIPTEN_KEEPALIVE void page_knock_out(double seconds) {
  down_for = seconds;
  sinew_character_set_root_drive(hero, SINEW_ROOT_FREE);
  sinew_character_set_strength(hero, 0);
}

/* A ball of 4 kg from a point (m) at a velocity (m/s); the ninth is the first again. */
EMSCRIPTEN_KEEPALIVE void page_throw(float x, float y, float z, float vx, float vy, float vz) {
  const sinew_transform at = {{0, 0, 0, 1}, {x, y, z}};
  const float velocity[3] = {vx, vy, vz}, spin[3] = {0, 0, 0};
  sinew_prop_set_state(balls[next_ball], &at, velocity, spin);
  next_ball = (next_ball + 1) % BALLS;
}

EMSCRIPTEN_KEEPALIVE int page_balls(void) { return BALLS; }
EMSCRIPTEN_KEEPALIVE float page_ball_radius(void) { return kBallRadius; }

EMSCRIPTEN_KEEPALIVE const float* page_ball(int ball) {
  static sinew_transform at;
  return sinew_prop_get_state(balls[ball], &at, NULL) == SINEW_OK ? at.rotation : NULL;
}

/* Null when all is well, else what is wrong. */
EMSCRIPTEN_KEEPALIVE const char* page_step(float h) {
  if (down_for > 0 && (down_for -= h) <= 0) {
    sinew_character_set_root_drive(hero, SINEW_ROOT_ASSISTED);
    sinew_character_set_strength(hero, strength);
  }
  played += h;
  if (target(0) != SINEW_OK || sinew_world_step(world, h) != SINEW_OK) return sinew_last_reason();
  if (sinew_character_get_report(hero, &report) != SINEW_OK) return sinew_last_reason();
  return NULL;
}

EMSCRIPTEN_KEEPALIVE int page_unknowns(void) { return report.unknown_dofs; }
EMSCRIPTEN_KEEPALIVE int page_dofs(void) { return report.dofs; }
