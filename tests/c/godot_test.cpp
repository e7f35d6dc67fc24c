// The library of samples/godot: what it refuses of Godot's tables, and what it says of wrong use.
#include <dlfcn.h>
#include <gdnative.h>
#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "fixtures/paths.h"

namespace sinew {
namespace {

using gdnative::CoreTable;
using gdnative::InitOptions;
using gdnative::Object;
using gdnative::Table;
using testing::HasSubstr;

/// The tables of Godot 3.2 without a function: nothing may be called before they are looked at.
struct Tables {
  Tables() = default;
  Tables(const Tables&) = delete;  // they point at each other
  Tables& operator=(const Tables&) = delete;
  Table script{gdnative::kNativeScript, {1, 0}, nullptr};
  const Table* extensions[1] = {&script};
  Table second{gdnative::kCore, {1, 2}, nullptr};
  Table first{gdnative::kCore, {1, 1}, &second};
  CoreTable core{{gdnative::kCore, {1, 0}, &first}, 1, extensions};
};

/// What Godot is told when it loads the library with these tables; "" if they are taken.
std::string told_of(const CoreTable* core) {
  static std::string told;
  told.clear();
  void* const library = dlopen(SINEW_GODOT_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (!library) return dlerror();
  const auto begin = reinterpret_cast<void (*)(InitOptions*)>(dlsym(library, "godot_gdnative_init"));
  const auto classes = reinterpret_cast<void (*)(void*)>(dlsym(library, "godot_nativescript_init"));
  const auto end = reinterpret_cast<void (*)(void*)>(dlsym(library, "godot_gdnative_terminate"));
  InitOptions options{};
  options.core = core;
  options.report_loading_error = [](const Object*, const char* what) { told = what; };
  begin(&options);
  if (!told.empty()) classes(nullptr);  // Godot calls it all the same: it may touch nothing
  end(nullptr);
  dlclose(library);
  return told;
}

TEST(GodotTables, ThoseOfGodot32AreTaken) {
  const Tables tables;
  EXPECT_EQ(told_of(&tables.core), "");
}

TEST(GodotTables, OthersAreRefusedBeforeAnythingIsCalled) {
  EXPECT_THAT(told_of(nullptr), HasSubstr("no core table"));
  Tables no_core, newer;
  no_core.core.table.type = gdnative::kNativeScript;
  EXPECT_THAT(told_of(&no_core.core), HasSubstr("no core table"));
  newer.core.table.version = {2, 0};
  EXPECT_THAT(told_of(&newer.core), HasSubstr("not of version 1.0"));
}

TEST(GodotTables, AnOlderGodotIsRefused) {
  Tables tables;
  tables.first.next = nullptr;
  EXPECT_THAT(told_of(&tables.core), HasSubstr("Godot 3.2"));
}

TEST(GodotTables, GodotWithoutNativeScriptIsRefused) {
  Tables tables;
  tables.script.type = 2;
  EXPECT_THAT(told_of(&tables.core), HasSubstr("NativeScript"));
  tables.script = {gdnative::kNativeScript, {2, 0}, nullptr};
  EXPECT_THAT(told_of(&tables.core), HasSubstr("NativeScript"));
  tables.core.extension_count = 0;
  EXPECT_THAT(told_of(&tables.core), HasSubstr("extensions"));
}

std::string words_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  for (int c = 0; pipe && (c = std::fgetc(pipe.get())) != EOF;) text += static_cast<char>(c);
  return text;
}

TEST(Godot, WrongUseIsToldByMethodAndCulpritAndBreaksNothing) {
  std::string home = binary_dir() + "/godot_home.XXXXXX";
  ASSERT_NE(mkdtemp(home.data()), nullptr) << home;
  const std::string said =
      words_of("env -i PATH=\"$PATH\" HOME=" + home +
               " LANG=en_US.UTF-8 timeout 100 " SINEW_GODOT " --path " + binary_dir() + "/godot --script " +
               source_dir() + "/tests/c/godot_misuse.gd --asset=" + binary_dir() + "/sample.sinew 2>&1");
  std::filesystem::remove_all(home);
  for (const char* words : {"_enter_tree: a SinewCharacter belongs below a SinewWorld",  //
                            "sample.sinew: this character is in no world",
                            "res://main.gd: not a Sinew asset (SINEW_BAD_FILE)",
                            "no bone of this Skeleton has the name of a joint",
                            "clip: swim: the asset has nothing of that name",
                            "play: clip 99: no such clip",
                            "play: clip must be String, and is Vector3",
                            "push: bone \"tail\"",
                            "push: impulse must be Vector3, and is int",
                            "push: impulse must be Vector3, and is missing",
                            "push: bone 99: no joint",
                            "push: the impulse: impulse is not finite",
                            "set_strength: the strength",
                            "an asset is chosen before the node enters the tree",
                            "balance is chosen before the node enters the tree",
                            "steps_per_second: must be 4 to 100000",
                            "throw_ball: a ball: mass must be",
                            "ball_transform: a ball: no such prop",
                            "a character stays in the SinewWorld that it was in first",
                            "still 22 bones, on the animation",
                            "all are gone"})
    EXPECT_THAT(said, HasSubstr(words));
  EXPECT_THAT(said, testing::Not(HasSubstr("stands still")));
}

}  // namespace
}  // namespace sinew
