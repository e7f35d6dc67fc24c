// A world's account of its memory, and the cap on it.
#include "character/scenes.h"
#include "fixtures/counting_new.h"

namespace sinew {
namespace {

TEST(Memory, AccountIsWhatTheHeapGave) {
  for (int characters : {1, 3, 40}) {
    WorldSettings settings;
    settings.workers = 3;
    const std::size_t before = fixtures::bytes_in_use;
    World<float> world(settings);
    Status status;
    for (int n = 0; n < characters; ++n) ASSERT_EQ(world.add_character(fixtures::humanoid(), {}, status), n);
    const double heap = double(fixtures::bytes_in_use - before), said = double(world.memory().total());
    // Names, the grid and lists of indices are left out; vectors that grow have room to spare.
    EXPECT_NEAR(said / heap, 1, 0.1) << characters << " characters, " << heap << " bytes";
  }
}

TEST(Memory, CharactersOfOneSkeletonShareIt) {
  World<float> world({});
  Status status;
  ASSERT_EQ(world.add_character(fixtures::humanoid(), {}, status), 0);
  const WorldMemory one = world.memory();
  for (int n = 1; n < 10; ++n) ASSERT_EQ(world.add_character(fixtures::humanoid(), {}, status), n);
  EXPECT_EQ(world.memory().rigs, one.rigs);
  EXPECT_EQ(world.memory().characters, 10 * one.characters);
  RecordProperty("bytes_per_character", int(one.characters));
  EXPECT_LT(one.characters, 64u * 1024) << "of 37 degrees of freedom, 14 bodies";
}

TEST(Memory, SolvingTakesNoMoreThanTheLargestIslandHoweverManyCharactersThereAre) {
  WorldSettings settings;
  settings.island_dofs = 8 * 37;
  std::size_t solving[2];
  for (int big = 0; big < 2; ++big) {
    World<float> world(settings);
    Status status;
    for (int n = 0; n < (big ? 60 : 20); ++n)
      ASSERT_EQ(world.add_character(fixtures::humanoid(), {}, status), n);
    solving[big] = world.memory().solving;
  }
  // 20 have a little less than 8 of the neediest and one more would.
  EXPECT_NEAR(double(solving[0]) / double(solving[1]), 1, 0.01);
}

TEST(Memory, TheCapIsKeptAndNamed) {
  WorldSettings settings;
  settings.memory_cap = 8'000'000;
  World<float> world(settings);
  Status status;
  int count = 0;
  while (count < 1000 && world.add_character(fixtures::humanoid(), {}, status) >= 0) ++count;
  EXPECT_GT(count, 1);
  EXPECT_LT(count, 100);
  EXPECT_EQ(status.code, Code::kOutOfRange);
  EXPECT_NE(std::string(status.reason).find("memory_cap"), std::string::npos);
  EXPECT_EQ(world.character_count(), count);
  EXPECT_LE(world.memory().total(), settings.memory_cap);
  EXPECT_TRUE(world.step(1 / 60.f).ok());
}

}  // namespace
}  // namespace sinew
