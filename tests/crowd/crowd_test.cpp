#include "sinew/crowd/crowd.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

#include "character/scenes.h"
#include "fixtures/clips.h"
#include "fixtures/counting_new.h"
#include "fixtures/threads.h"
#include "residual/random_tree.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/effects/support.h"

namespace sinew {
namespace {

constexpr double kStep = 1 / 60.0;

std::unique_ptr<Crowd> crowd_of(const Skeleton& skeleton, const CrowdSettings& settings) {
  Status status;
  auto crowd = Crowd::create(skeleton, settings, status);
  EXPECT_TRUE(crowd) << status.reason;
  return crowd;
}

/// The humanoid with fingers that ride along.
Skeleton rig_with_fingers() {
  Skeleton rig = fixtures::humanoid();
  const int hand = rig.find("hand_r");
  for (int n = 0; n < 2; ++n) {
    Joint finger;
    finger.name = "finger" + std::to_string(n);
    finger.parent = n == 0 ? hand : int(rig.joints.size()) - 1;
    finger.rest.translation = {0.01, 0.02, -0.09};
    rig.joints.push_back(finger);
  }
  return rig;
}

/// A mixed crowd: clips, times, rates and places all differ.
struct Scene {
  Skeleton rig = rig_with_fingers();
  std::array<Clip, 3> clips = {fixtures::swaying_clip(rig, 1), fixtures::swaying_clip(rig, 2),
                               fixtures::swaying_clip(rig, 3)};

  CrowdTrack track(int i) const {
    CrowdTrack track;
    track.clip = &clips[i % 3];
    track.time = {0.137 * i, 0.8 + 0.05 * (i % 9)};
    const int column = i % 10, row = i / 10;
    track.place = {rotation_exp<float>({0, 0, 0.7f * float(i)}), {3.f * float(column), 2.f * float(row), 0}};
    return track;
  }
  std::unique_ptr<Crowd> crowd(const CrowdSettings& settings) const {
    auto crowd = crowd_of(rig, settings);
    for (int i = 0; i < settings.capacity; ++i) EXPECT_TRUE(crowd->play(i, track(i)).ok());
    return crowd;
  }
};

/// What the recursions of residual/ say in double of the motion that a character of the crowd plays.
std::vector<double> slow_torques(const Skeleton& skeleton, std::span<const JointJet<float>> jets,
                                 const CrowdSettings& settings) {
  const Tree<double> tree(skeleton);
  std::vector<JointJet<double>> exact;
  for (const JointJet<float>& j : jets)
    exact.push_back({j.rotation.cast<double>().normalized(), j.omega.cast<double>(), j.alpha.cast<double>(),
                     j.translation.cast<double>(), j.velocity.cast<double>(), j.acceleration.cast<double>()});
  Kinematics<double> kinematics(tree);
  Motion<double> motion(tree);
  std::vector<Vec3<double>> force(tree.bodies), moment(tree.bodies);
  std::vector<double> torque(tree.dofs);
  const Vec3<double> origin = exact[0].translation;
  inertial_wrenches<double>(tree, exact, settings.gravity, origin, kinematics, motion, force, moment);
  std::vector<ContactPoint<double>> points;
  for (const Collider& collider : skeleton.colliders) append_contact_points<double>(collider, points);
  const SupportPoints<double> support(tree, points);
  std::vector<StandingPoint<double>> room(support.points.size());
  if (settings.ground)
    share_support<double>(support, kinematics.rotation, kinematics.origin,
                          LevelGround<double>{settings.ground_height - origin.z()}, {}, room, force, moment);
  project_wrenches<double>(tree, kinematics, force, moment, torque);
  return torque;
}

TEST(Crowd, TorquesAreThoseOfTheResidualPassForEveryTypeOfJoint) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Skeleton skeleton = fixtures::random_skeleton(seed);
    CrowdSettings settings;
    settings.capacity = 19;
    settings.ground = false;
    settings.gravity = {1, -2, -9};
    const auto crowd = crowd_of(skeleton, settings);
    fixtures::Random random(seed + 100);
    const Tree<double> tree(skeleton);
    for (int i = 0; i < settings.capacity; ++i) {
      ASSERT_TRUE(crowd->play(i, {}).ok());
      const auto pose = fixtures::random_pose(tree, random, 0.6);
      for (int j = 0; j < tree.bodies; ++j) {
        const auto vector = [&](double scale) -> Vec3<float> { return random.vector(scale).cast<float>(); };
        crowd->jets(i)[j] = {pose[j].rotation.cast<float>(),    vector(1), vector(3),
                             pose[j].translation.cast<float>(), vector(1), vector(3)};
      }
    }
    ASSERT_TRUE(crowd->step(kStep).ok());
    for (int i = 0; i < settings.capacity; ++i) {
      const std::vector<double> wanted = slow_torques(skeleton, crowd->jets(i), settings);
      double scale = 1;  // float: 1e-6 of the largest number that a chain of ten joints adds up
      for (const double torque : wanted) scale = std::max(scale, std::abs(torque));
      for (int dof = 0; dof < crowd->dof_count(); ++dof)
        EXPECT_NEAR(crowd->torque(i, dof), wanted[dof], 1e-5 * scale) << "seed " << seed << " dof " << dof;
    }
  }
}

TEST(Crowd, GroundSupportIsSharedAsInAWorld) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 40;
  for (const double ground : {-0.3, 0.0, 0.02, 0.05}) {  // in flight … sunk in
    settings.ground_height = ground;
    const auto crowd = scene.crowd(settings);
    ASSERT_TRUE(crowd->step(kStep).ok());
    for (int i = 0; i < settings.capacity; ++i) {
      const std::vector<double> wanted = slow_torques(scene.rig, crowd->jets(i), settings);
      // The least-squares system of points within centimetres of each other loses four digits of float.
      for (int dof = 0; dof < crowd->dof_count(); ++dof)
        EXPECT_NEAR(crowd->torque(i, dof), wanted[dof], 0.5) << "character " << i << " dof " << dof;
    }
  }
}

TEST(Crowd, SaysOfACharacterWhatAWorldSays) {
  fixtures::Playing<float> scene;
  CrowdSettings settings;
  settings.capacity = 3;
  const auto crowd = crowd_of(scene.skeleton, settings);
  ASSERT_TRUE(crowd->play(1, {}).ok());
  for (int n = 0; n < 30; ++n) {
    scene.step(float(kStep));
    ASSERT_TRUE(scene.character().on_animation());
    const auto jets = fixtures::idle<float>(scene.skeleton, double(scene.time));
    std::copy(jets.begin(), jets.end(), crowd->jets(1).begin());
    ASSERT_TRUE(crowd->step(kStep).ok());
    EXPECT_TRUE(crowd->overloaded().empty());
    float peak = 0;
    for (int dof = 0; dof < crowd->dof_count(); ++dof) {
      EXPECT_NEAR(crowd->torque(1, dof), scene.character().torque()[dof], 0.05)
          << "N·m; weight 770 N, in float";
      if (dof >= 6) peak = std::max(peak, scene.character().load()[dof]);
    }
    EXPECT_NEAR(crowd->peak_load(1), peak, 1e-3);
    for (std::size_t j = 0; j < jets.size(); ++j) {
      EXPECT_LT((crowd->model(1)[j].translation - scene.character().model()[j].translation).norm(), 1e-6);
      EXPECT_LT(crowd->model(1)[j].rotation.angularDistance(scene.character().model()[j].rotation), 2e-3);
    }
  }
}

struct Result {
  std::vector<float> numbers;

  explicit Result(Crowd& crowd, int count) {
    for (int i = 0; i < count; ++i) {
      numbers.push_back(crowd.peak_load(i));
      for (int dof = 0; dof < crowd.dof_count(); ++dof) numbers.push_back(crowd.torque(i, dof));
      for (const Transform<float>& t : crowd.model(i)) {
        numbers.insert(numbers.end(), t.rotation.coeffs().begin(), t.rotation.coeffs().end());
        numbers.insert(numbers.end(), t.translation.begin(), t.translation.end());
      }
    }
  }
  bool same_bits(const Result& other) const {
    return numbers.size() == other.numbers.size() &&
           std::memcmp(numbers.data(), other.numbers.data(), numbers.size() * sizeof(float)) == 0;
  }
};

TEST(Crowd, EveryInstructionSetBatchWidthAndNumberOfThreadsGivesTheSameBits) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 53;
  settings.instruction_set = InstructionSet::kBaseline;
  settings.lanes = 8;
  const auto reference = scene.crowd(settings);
  for (int n = 0; n < 3; ++n) ASSERT_TRUE(reference->step(kStep).ok());
  const Result wanted(*reference, settings.capacity);
  for (const InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512})
    for (const int lanes : {8, 16})
      for (int threads : {0, 1, 3}) {
        if (!available(set)) continue;
        settings.instruction_set = set;
        settings.lanes = lanes;
        settings.chunks = threads == 0 ? 1 : 2 * threads + 1;
        const auto crowd = scene.crowd(settings);
        for (int n = 0; n < 3; ++n)
          ASSERT_TRUE(crowd
                          ->step(kStep, threads == 0 ? ParallelFor{}
                                                     : ParallelFor{fixtures::run_on_threads, &threads})
                          .ok());
        EXPECT_TRUE(Result(*crowd, settings.capacity).same_bits(wanted))
            << "set " << int(set) << ", " << lanes << " lanes, " << threads << " threads";
      }
}

/// Clips of which no two have the same tracks, knots, degree, length or way to end.
std::vector<Clip> unlike_clips(const Skeleton& rig) {
  const int joints = int(rig.joints.size());
  std::vector<Clip> clips = {fixtures::swaying_clip(rig, 1)};
  clips.push_back(fixtures::swaying_clip(rig, 2));
  clips.back().root_step = {0.7f, 0.1f, 0};
  clips.push_back(fixtures::random_clip(
      {.joints = joints, .duration = 3, .knot_interval = 0.25f, .degree = 3, .loops = false, .moving = 3}));
  clips.push_back(clips.back());  // only joints 2 … 7 move
  Clip::Group& group = clips.back().groups[0];
  const std::vector<float> controls = group.controls;
  const std::size_t tracks = group.tracks.size();
  group.tracks.assign(group.tracks.begin() + 2, group.tracks.begin() + 8);
  group.controls.clear();
  for (int k = 0; k < group.control_count; ++k) {
    const float* row = controls.data() + (std::size_t(k) * tracks + 2) * 4;
    group.controls.insert(group.controls.end(), row, row + 24);
  }
  clips.push_back(clips[3]);  // nothing moves
  clips.back().groups.clear();
  for (Clip& clip : clips) EXPECT_TRUE(validate(clip).ok());
  return clips;
}

/// As Result, with jets.
std::vector<float> everything(Crowd& crowd, int count) {
  std::vector<float> numbers = Result(crowd, count).numbers;
  for (int i = 0; i < count; ++i)
    for (const JointJet<float>& jet : crowd.jets(i))
      for (const auto& v : {jet.omega, jet.alpha, jet.velocity, jet.acceleration})
        numbers.insert(numbers.end(), v.begin(), v.end());
  return numbers;
}

TEST(Crowd, ClipsSampledTogetherHaveTheBitsOfClipsSampledOneByOne) {
  const Skeleton rig = rig_with_fingers();
  const std::vector<Clip> clips = unlike_clips(rig);
  Clip many = clips[0];  // more groups than a batch holds
  for (int n = 0; n < 8; ++n) many.groups.push_back(many.groups[1]);
  CrowdSettings settings;
  settings.capacity = 53;
  for (const InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512})
    for (const int lanes : {8, 16}) {
      if (!available(set)) continue;
      settings.instruction_set = set;
      settings.lanes = lanes;
      const auto together = crowd_of(rig, settings), by_host = crowd_of(rig, settings);
      std::vector<CrowdTrack> tracks;
      for (int i = 0; i < settings.capacity; ++i) {
        CrowdTrack track;  // clips of one batch differ, then those of one batch are the same
        track.clip = i < 32 ? &clips[i % 5] : i < 48 ? &clips[1] : &many;
        track.time = {0.31 * i - 2, 0.8 + 0.05 * (i % 9), 0.3 * (i % 4) - 0.4};
        track.place = {rotation_exp<float>({0, 0.02f * float(i % 5), 0.7f * float(i)}),
                       {3.f * float(i % 10), 2.f * float(i), 0.01f * float(i % 7)}};
        tracks.push_back(track);
        ASSERT_TRUE(together->play(i, track).ok());
        ASSERT_TRUE(by_host->play(i, {}).ok());
      }
      for (int n = 0; n < 3; ++n) {
        for (int i = 0; i < settings.capacity; ++i) {
          CrowdTrack& track = tracks[i];
          track.time = track.time.after(kStep);
          const std::span jets = by_host->jets(i);
          ASSERT_TRUE((SamplingJob<float>{track.clip, track.time, jets}.Run().ok()));
          place_root(track.place, jets[0]);
        }
        ASSERT_TRUE(together->step(kStep).ok());
        ASSERT_TRUE(by_host->step(kStep).ok());
        const std::vector<float> a = everything(*together, settings.capacity),
                                 b = everything(*by_host, settings.capacity);
        ASSERT_EQ(a.size(), b.size());
        EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0)
            << "set " << int(set) << ", " << lanes << " lanes, step " << n;
        for (int i = 0; i < settings.capacity; ++i)
          EXPECT_EQ(together->root_velocity(i), together->jets(i)[0].velocity);
      }
    }
}

TEST(Crowd, WhoStandsOnTheGroundChangesNoBitOfWhoDoesNot) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 16;
  const auto after_a_step = [&](int only) {
    auto crowd = scene.crowd(settings);
    for (int i = 0; i < settings.capacity; ++i) {
      CrowdTrack track = scene.track(i);
      track.place.translation.z() = 0.02f * float(i % 5 - 2);  // feet and ground: through it … above it
      EXPECT_TRUE(crowd->play(i, track).ok());
      EXPECT_TRUE(crowd->set_active(i, only < 0 || i == only).ok());
    }
    EXPECT_TRUE(crowd->step(kStep).ok());
    return crowd;
  };
  const auto all = after_a_step(-1);
  for (int i = 0; i < settings.capacity; ++i) {
    const auto alone = after_a_step(i);
    for (int dof = 0; dof < all->dof_count(); ++dof)
      EXPECT_EQ(alone->torque(i, dof), all->torque(i, dof)) << "character " << i << " dof " << dof;
  }
}

TEST(Crowd, AHostThatTakesOverFromAClipFindsItsPose) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 3;
  const auto crowd = scene.crowd(settings), other = scene.crowd(settings);
  ASSERT_TRUE(crowd->step(kStep).ok());
  ASSERT_TRUE(other->step(kStep).ok());
  ASSERT_TRUE(crowd->play(1, {}).ok());
  for (std::size_t j = 0; j < scene.rig.joints.size(); ++j) {
    EXPECT_EQ(crowd->jets(1)[j].rotation.coeffs(), other->jets(1)[j].rotation.coeffs());
    EXPECT_EQ(crowd->jets(1)[j].acceleration, other->jets(1)[j].acceleration);
  }
  const Result before(*other, 2);
  ASSERT_TRUE(crowd->step(0).ok());
  EXPECT_TRUE(Result(*crowd, 2).same_bits(before));
}

TEST(Crowd, ModelPosesChainTheJetsRideAlongJointsIncluded) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 21;
  const auto crowd = scene.crowd(settings);
  ASSERT_TRUE(crowd->step(kStep).ok());
  for (int i = 0; i < settings.capacity; ++i) {
    std::vector<Transform<float>> model;
    for (std::size_t j = 0; j < scene.rig.joints.size(); ++j) {
      const Transform<float> local{crowd->jets(i)[j].rotation, crowd->jets(i)[j].translation};
      const int parent = scene.rig.joints[j].parent;
      model.push_back(parent < 0 ? local : model[parent] * local);
      EXPECT_LT((crowd->model(i)[j].translation - model[j].translation).norm(), 1e-5) << "float at 30 m";
      EXPECT_LT((crowd->model(i)[j].rotation.coeffs() - model[j].rotation.coeffs()).norm(), 1e-5);
    }
  }
}

TEST(Crowd, OnlyTheCharacterWhoseMusclesAreTooWeakIsOverloaded) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 40;
  const auto crowd = scene.crowd(settings);
  for (int i = 0; i < settings.capacity; ++i)
    ASSERT_TRUE(crowd->set_strength(i, std::numeric_limits<float>::infinity()).ok());
  ASSERT_TRUE(crowd->step(kStep).ok());
  EXPECT_TRUE(crowd->overloaded().empty());
  EXPECT_EQ(crowd->peak_load(17), 0);
  ASSERT_TRUE(crowd->set_strength(17, 0.001f).ok());
  ASSERT_TRUE(crowd->set_strength(33, 0).ok());
  ASSERT_TRUE(crowd->step(kStep).ok());
  EXPECT_EQ(std::vector<int>(crowd->overloaded().begin(), crowd->overloaded().end()),
            (std::vector<int>{17, 33}));
  // The load is the torque over the limit of its own direction.
  const Tree<double> tree(scene.rig);
  double load = 0;
  for (int i = 1; i < tree.bodies; ++i)
    for (int k = 0; k < tree.dof_count(i); ++k) {
      const double torque = crowd->torque(17, tree.first_dof[i] + k);
      const DofLimits& limits = scene.rig.joints[i].dofs[k];
      load = std::max(load,
                      std::abs(torque) / (0.001 * (torque >= 0 ? limits.torque_plus : limits.torque_minus)));
    }
  EXPECT_NEAR(crowd->peak_load(17), load, 1e-5 * load);
}

TEST(Crowd, MotionThatIsNotFiniteIsReportedAndStaysInItsLane) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 16;
  const auto crowd = scene.crowd(settings);
  ASSERT_TRUE(crowd->step(kStep).ok());
  const Result before(*crowd, 5);
  for (int i = 0; i < 16; ++i) {
    ASSERT_TRUE(crowd->set_strength(i, 1e6f).ok());
    CrowdTrack held = crowd->track(i);
    held.clip = nullptr;
    ASSERT_TRUE(crowd->play(i, held).ok());
  }
  crowd->jets(5)[3].alpha.x() = NAN;
  ASSERT_TRUE(crowd->step(0).ok());
  EXPECT_EQ(std::vector<int>(crowd->overloaded().begin(), crowd->overloaded().end()), std::vector<int>{5});
  for (int i = 0; i < 5; ++i)
    for (int dof = 0; dof < crowd->dof_count(); ++dof) EXPECT_TRUE(std::isfinite(crowd->torque(i, dof)));
}

TEST(Crowd, InactiveCharactersAreLeftAloneAndChangeNobody) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 40;
  const auto all = scene.crowd(settings), some = scene.crowd(settings);
  for (int i = 0; i < settings.capacity; ++i)
    if (i % 3 != 1 || (i >= 16 && i < 32)) {  // a whole batch among them
      ASSERT_TRUE(some->set_active(i, false).ok());
      ASSERT_TRUE(some->set_strength(i, 0).ok());
      some->jets(i)[2].rotation.x() = NAN;
    }
  ASSERT_TRUE(all->step(kStep).ok());
  ASSERT_TRUE(some->step(kStep).ok());
  EXPECT_TRUE(some->overloaded().empty() || some->overloaded().size() == all->overloaded().size());
  for (int i = 0; i < settings.capacity; ++i) {
    if (i % 3 != 1 || (i >= 16 && i < 32)) {
      EXPECT_EQ(some->track(i).time.value, scene.track(i).time.value);
      EXPECT_EQ(some->model(i)[0].translation, scene.rig.joints[0].rest.translation.cast<float>());
      continue;
    }
    EXPECT_EQ(some->peak_load(i), all->peak_load(i));
    EXPECT_EQ(some->model(i)[5].translation, all->model(i)[5].translation);
  }
}

TEST(Crowd, StepAllocatesNothing) {
  const Scene scene;
  CrowdSettings settings;
  settings.capacity = 40;
  settings.chunks = 3;
  const auto crowd = scene.crowd(settings);
  const long before = fixtures::allocations;
  std::vector<int> counted(1);
  EXPECT_EQ(fixtures::allocations - before, 1) << "the counter does not count";
  const long start = fixtures::allocations;
  bool ok = true;
  for (int n = 0; n < 10; ++n) ok &= crowd->step(kStep).ok();
  EXPECT_EQ(fixtures::allocations - start, 0);
  EXPECT_TRUE(ok);
}

TEST(Crowd, RefusesWhatCannotBeMeant) {
  const Scene scene;
  const auto refused = [&](auto change) {
    CrowdSettings settings;
    change(settings);
    Status status;
    return !Crowd::create(scene.rig, settings, status) && !status.ok();
  };
  EXPECT_TRUE(refused([](CrowdSettings& s) { s.capacity = 0; }));
  EXPECT_TRUE(refused([](CrowdSettings& s) { s.lanes = 7; }));
  EXPECT_TRUE(refused([](CrowdSettings& s) { s.chunks = 0; }));
  EXPECT_TRUE(refused([](CrowdSettings& s) { s.ground_height = NAN; }));
  Status status;
  Skeleton broken = scene.rig;
  broken.joints[3].parent = 9;
  EXPECT_EQ(Crowd::create(broken, {}, status), nullptr);
  EXPECT_EQ(status.index, 3);
  const auto crowd = scene.crowd({.capacity = 4});
  EXPECT_EQ(crowd->play(4, {}).index, 4);
  EXPECT_FALSE(crowd->set_active(-1, true).ok());
  EXPECT_FALSE(crowd->set_strength(0, NAN).ok());
  EXPECT_FALSE(crowd->step(-1).ok());
  EXPECT_FALSE(crowd->step(NAN).ok());
  const Clip other = fixtures::random_clip({.joints = 3});
  EXPECT_EQ(crowd->play(0, {&other}).code, Code::kInvalidArgument);
  EXPECT_FALSE(crowd->play(0, {nullptr, 0, {Quat<float>(NAN, 0, 0, 0), {0, 0, 0}}}).ok());
}

}  // namespace
}  // namespace sinew
