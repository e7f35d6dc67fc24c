/* Sinew from C: a walker is hit by a ball, and pushed a second later.
 * Usage: c ASSET.sinew [FRAMES]. Prints a hash of all poses, which is the same from every language. */
#include <sinew/c/sinew.h>
#include <stdio.h>
#include <stdlib.h>

static void check(sinew_status status, const char* what) {
  if (status == SINEW_OK) return;
  fprintf(stderr, "c: %s: %s: %s\n", what, sinew_status_name(status), sinew_last_reason());
  exit(1);
}

/* FNV-1a over rotation and translation of every joint. */
static uint64_t add_pose(uint64_t hash, sinew_view model) {
  for (int32_t j = 0; j < model.count; ++j) {
    const unsigned char* bytes = (const unsigned char*)model.data + (size_t)j * (size_t)model.stride;
    for (size_t k = 0; k < 7 * sizeof(float); ++k) hash = (hash ^ bytes[k]) * 0x100000001b3u;
  }
  return hash;
}

int main(int argc, char** argv) {
  if (argc < 2) {
    fprintf(stderr, "usage: c ASSET.sinew [FRAMES]\n");
    return 2;
  }
  const int frames = argc > 2 ? atoi(argv[2]) : 180;
  sinew_asset asset;
  check(sinew_asset_load(argv[1], &asset), argv[1]);
  int32_t chest;
  check(sinew_asset_find_role(asset, SINEW_ROLE_CHEST, &chest), "chest");

  sinew_world world;
  sinew_character hero;
  sinew_prop ball;
  check(sinew_world_create(NULL, &world), "world");
  check(sinew_world_add_character(world, asset, NULL, &hero), "character");
  sinew_prop_settings thrown = {.size = sizeof thrown};
  check(sinew_prop_settings_init(&thrown), "ball");
  thrown.mass = 4;
  thrown.pose.translation[1] = 3;
  thrown.pose.translation[2] = 1.5;
  thrown.velocity[0] = 1.2;  /* as the walker */
  thrown.velocity[1] = -6;
  thrown.velocity[2] = 2;
  check(sinew_world_add_prop(world, &thrown, &ball), "ball");

  const float h = 1 / 60.f;
  uint64_t hash = 0xcbf29ce484222325u;
  for (int frame = 0; frame < frames; ++frame) {
    const sinew_play play = {.character = hero, .asset = asset, .clip = 0, .time = frame / 60.0, .rate = 1};
    check(sinew_play_clips(&play, 1), "clip");
    if (frame == 0) check(sinew_character_reset(hero), "reset");
    sinew_view model;
    check(sinew_character_get_view(hero, SINEW_VIEW_MODEL, &model), "pose");
    if (frame == 60) {
      const sinew_transform* at = (const sinew_transform*)model.data + chest;
      const double point[3] = {at->translation[0], at->translation[1], at->translation[2]};
      check(sinew_character_apply_impulse(hero, chest, point, (const double[3]){0, 90, 0}), "push");
    }
    check(sinew_world_step(world, h), "step");
    check(sinew_character_get_view(hero, SINEW_VIEW_MODEL, &model), "pose");
    hash = add_pose(hash, model);
  }
  sinew_character_report report = {.size = sizeof report};
  check(sinew_character_get_report(hero, &report), "report");
  printf("%d of %d degrees of freedom unknown at the end, %s the animation\n", report.unknown_dofs,
         report.dofs, report.on_animation ? "on" : "off");
  printf("pose hash %016llx\n", (unsigned long long)hash);
  check(sinew_world_destroy(world), "world");
  check(sinew_asset_destroy(asset), "asset");
  return 0;
}
