// Books on motions whose energies are known: they find no gain where there is none, and the gain that there
// is.
#include "study/audit/books.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "fixtures/paths.h"
#include "study_audit/motions.h"

namespace sinew::audit {
namespace {

using Eigen::Vector3d;

const Vector3d kGravity(0, 0, -9.81);

TEST(Books, OfAFreeFallHoldTheTextbooksEnergies) {
  const Path fall = [](double t) {
    return Transform<double>{turn(Vector3d(0, 0, 2 * t)), {3 * t, 0, 5 - 9.81 * t * t / 2}};
  };
  const Member body = one_body(2, {0.1, 0.2, 0.3});
  const Books books = books_of(body, fall, 0.01, 100, kGravity);
  const Balance& b = books.balance();
  EXPECT_NEAR(b.kinetic_start, 0.5 * 2 * 9 + 0.5 * 0.3 * 4, 1e-9);
  EXPECT_NEAR(b.kinetic_most, 9 + 0.6 + 2 * 9.81 * 9.81 / 2, 1) << "the last step's chord: half a step ago";
  EXPECT_LE(b.gain, 1e-9);
  EXPECT_LE(b.rise, 1e-9);
  EXPECT_EQ(b.seen, b.instants) << "differences of a parabola are exact";
  // Four steps before the end.
  EXPECT_NEAR(books.momentum_between_impacts().linear.z(), -2 * 9.81 * 0.96, 1e-9);
  EXPECT_NEAR(books.momentum_between_impacts().linear.x(), 6, 1e-9);
}

TEST(Books, OfASymmetricTopKeepItsEnergyAndMomentum) {
  const Vector3d omega(3, 0, 8);
  const Member top = one_body(1, {0.3, 0.3, 0.1});
  const Books books = books_of(top, symmetric_top(0.3, 0.1, omega), 1.0 / 60, 300);
  const double energy = 0.5 * (0.3 * 9 + 0.1 * 64);
  EXPECT_NEAR(books.balance().kinetic_start, energy, 1e-8);
  EXPECT_LE(books.balance().gain, 1e-8);
  EXPECT_LE(books.balance().rise, 1e-5 * energy);
  EXPECT_EQ(books.balance().seen, books.balance().instants);
  const Momentum& m = books.momentum_between_impacts();
  EXPECT_LE((m.angular - Vector3d(0.9, 0, 0.8)).norm(), m.angular_error + 1e-12);
  EXPECT_LE(m.angular_error, 1e-5);
}

TEST(Books, OfAnEulerTopThatFlipsKeepItsEnergyAndMomentum) {
  // Spun about its middle axis: it flips again and again.
  const Vector3d moments(0.010833, 0.008333, 0.004167), omega(0.05, 5, 0.05);
  const int steps = 600;
  const double h = 1.0 / 50;
  const std::vector<Transform<double>> poses = euler_top(moments, omega, h, steps);
  Books books(Vector3d::Zero(), 1e-16);
  const Member top = one_body(1, moments);
  const auto start = [&](double t) {
    return std::vector<Transform<double>>{{turn(omega * t), Vector3d::Zero()}};
  };
  books.add(top, start(-1e-5), start(0), start(1e-5), 1e-5);
  const Vector3d momentum = moments.cwiseProduct(omega);
  double off = 0;
  bool flipped = false;
  for (int n = 1; n <= steps; ++n) {
    books.record(h, {poses[static_cast<std::size_t>(n)]}, 0);
    flipped = flipped || (poses[static_cast<std::size_t>(n)].rotation * Vector3d::UnitY()).y() < -0.9;
    if (n >= 8) off = std::max(off, (books.momentum_between_impacts().angular - momentum).norm());
  }
  EXPECT_TRUE(flipped);
  EXPECT_LE(books.balance().gain, 1e-6 * books.balance().kinetic_start);
  EXPECT_EQ(books.balance().seen, books.balance().instants);
  EXPECT_LE(off, 1e-4 * momentum.norm()) << "differences of eighth order at 0.1 rad a step";
}

/// A rod's end on a pendulum of 1 m, let go at 2 rad.
Books pendulum_books(double h, int steps, double scale = 1) {
  const std::vector<double> angles = pendulum(1, 2, h, steps);
  const Path path = [&](double t) {
    const double a = t <= 0 ? 2 : scale * angles[static_cast<std::size_t>(std::lround(t / h))];
    return Transform<double>{turn(Vector3d(0, -a, 0)), {std::sin(a), 0, -std::cos(a)}};
  };
  return books_of(one_body(1, Vector3d::Constant(1e-9)), path, h, steps, kGravity);
}

TEST(Books, OfAPendulumKeepItsEnergy) {
  for (const double h : {0.02, 0.01}) {
    const Books books = pendulum_books(h, static_cast<int>(std::lround(4 / h)));
    const double most = 9.81 * (1 - std::cos(2.0));
    EXPECT_NEAR(books.balance().kinetic_most, most, 1e-3 * most) << "a node at the bottom or beside it";
    EXPECT_LE(books.balance().gain, 1e-6 * most);
    EXPECT_LE(books.balance().rise, 1e-3 * most);
    EXPECT_EQ(books.balance().seen, books.balance().instants);
  }
}

/// A kilogram on a spring of 100 N/m, amplitude 1 m and growing at `growth` per second; the books get the
/// spring's work, which a straight line between forces gives exactly.
Books spring_books(double growth) {
  const auto at = [=](double t) { return std::exp(growth * t) * std::cos(10 * t); };
  const Path path = [=](double t) {
    return Transform<double>{Eigen::Quaterniond::Identity(), {at(t), 0, 0}};
  };
  return books_of(one_body(1, Vector3d::Ones()), path, 1.0 / 120, 240, Vector3d::Zero(),
                  [=](double from, double to) { return 50 * (at(from) * at(from) - at(to) * at(to)); });
}

TEST(Books, OfASpringBalanceItsWork) {
  const Balance b = spring_books(0).balance();
  EXPECT_NEAR(b.kinetic_most, 50, 0.5);
  EXPECT_LE(b.gain, 1e-5 * 50);
  EXPECT_LE(b.rise, 1e-3 * 50);
}

TEST(Books, FindTheEnergyOfASpringThatGrows) {
  // The total grows as exp(2·growth·t), by 8 % in the two seconds, of which the last four steps are unseen,
  // and swings by 5·growth J with the damping that grows it.
  const Balance b = spring_books(0.02).balance();
  EXPECT_NEAR(b.gain, 50 * (std::exp(0.04 * (2 - 4.0 / 120)) - 1), 0.11);
  EXPECT_GE(b.rise, 50 * 0.04 * 8 / 120) << "of twelve steps' share";
}

TEST(Books, OfABouncingBallFindNoGainWhateverPartOfAStepItStrikesIn) {
  // In the end it bounces several times in a step.
  for (const double h : {1.0 / 60, 1.0 / 30})
    for (const double restitution : {1.0, 0.7, 0.5, 0.3, 0.0})
      for (const double height : {1.0, 0.97, 0.93, 0.9, 0.87}) {
        const Balance b =
            books_of(one_body(2, Vector3d::Ones()), bouncing(height, {restitution}), h, 180, kGravity)
                .balance();
        EXPECT_LE(b.gain, 1e-9) << restitution << " from " << height << " in steps of " << h;
        EXPECT_LE(b.rise, 1e-6) << restitution << " from " << height << " in steps of " << h;
      }
}

TEST(Books, FindWhatABounceAddedToTheJoule) {
  // The third bounce returns 1.1 of the speed: from 2·9.81·1 J of the whole height, 21 % more.
  const Books books =
      books_of(one_body(2, Vector3d::Ones()), bouncing(1, {1, 1, 1.1, 1}), 1.0 / 60, 180, kGravity);
  EXPECT_NEAR(books.balance().gain, 0.21 * 2 * 9.81, 1e-6);
}

TEST(Books, FindThatABodyIsPutElsewhereThoughItIsAsSlowAsBefore) {
  // A metre in a hundredth of a second, between a second's rest and another's.
  const Path leaps = [](double t) {
    return Transform<double>{Eigen::Quaterniond::Identity(), {t < 1 ? 0.0 : 1.0, 0, 0}};
  };
  const Books books = books_of(one_body(2, Vector3d::Ones()), leaps, 0.01, 200, kGravity);
  EXPECT_NEAR(books.balance().leap, 0.5 * 2 * 100 * 100, 0.01) << "less what gravity may do in a step";
  EXPECT_LE(books.balance().gain, 1e-9) << "it is at rest as soon as it is over";
  EXPECT_LE(books.balance().kinetic_most, 0.01) << "of what it has without the leap";
}

TEST(Books, FindThatABodyIsTurnedThoughItDoesNotTurnAfterwards) {
  const Path turns = [](double t) {
    return Transform<double>{turn(Vector3d(0, t < 1 ? 0 : 1, 0)), Vector3d::Zero()};
  };
  const double needed = 0.5 * 0.2 * 100 * 100;
  const double leap = books_of(one_body(1, Vector3d(0.3, 0.2, 0.25)), turns, 0.01, 200).balance().leap;
  EXPECT_LE(leap, needed);
  EXPECT_GE(leap, needed / std::sqrt(3)) << "of an inertia that is known by its norm";
}

TEST(Books, FindNoLeapWhereNoneIs) {
  const Path fall = [](double t) {
    return Transform<double>{turn(Vector3d(0, 0, 200 * t)), {3 * t, 0, 5 - 9.81 * t * t / 2}};
  };
  EXPECT_EQ(books_of(one_body(2, {0.1, 0.2, 0.3}), fall, 0.02, 100, kGravity).balance().leap, 0);
  for (const double restitution : {1.0, 0.7, 0.3})
    for (const double h : {1.0 / 240, 1.0 / 60, 1.0 / 10})
      EXPECT_LE(
          books_of(one_body(2, Vector3d::Ones()), bouncing(1, {restitution}), h, 60, kGravity).balance().leap,
          1e-9)
          << restitution << " in steps of " << h;
  // 4 rad a step: which way it turns cannot be told, but that it need not turn faster than it did.
  EXPECT_EQ(
      books_of(one_body(1, Vector3d::Ones()), symmetric_top(1, 1, {0, 0, 240}), 1.0 / 60, 30).balance().leap,
      0);
}

TEST(LeastEnergy, OfAFreeFallIsASixthOfWhatGravityDoesInAStepBelowTheBodys) {
  const Member body = one_body(2, Vector3d::Ones());
  const auto at = [](double t) {
    return Transform<double>{Eigen::Quaterniond::Identity(), {0, 0, -9.81 * t * t / 2}};
  };
  for (const double t : {0.0, 0.5, 3.0})
    EXPECT_NEAR(least_energy(body.bodies[0], at(t), at(t + 0.1), 0.1, kGravity, 0),
                -2 * 9.81 * 9.81 * 0.01 / 6, 1e-9);
}

TEST(Books, CountWorkAgainstTheEnergyThatItLeaves) {
  // 4 N on 2 kg for a second.
  const Path pulled = [](double t) {
    return Transform<double>{Eigen::Quaterniond::Identity(), {t * t, 0, 0}};
  };
  const Books with = books_of(one_body(2, Vector3d::Ones()), pulled, 0.01, 100, Vector3d::Zero(),
                              [](double from, double to) { return 4 * (to * to - from * from); });
  EXPECT_LE(with.balance().gain, 1e-9);
  EXPECT_NEAR(with.balance().work, 4, 1e-12);
  const Books without = books_of(one_body(2, Vector3d::Ones()), pulled, 0.01, 100);
  EXPECT_NEAR(without.balance().gain, 0.96 * 0.96 * 4, 1e-9) << "four steps before the end";
}

TEST(Books, StartAfreshWhereTheStateWasSetFromOutside) {
  const auto at = [](double x) {
    return std::vector<Transform<double>>{{Eigen::Quaterniond::Identity(), {x, 0, 0}}};
  };
  Books books(Vector3d::Zero(), 1e-16);
  books.add(one_body(1, Vector3d::Ones()), at(0), at(0), at(0), 1e-5);
  for (int n = 0; n < 20; ++n) books.record(0.01, at(0), 0);
  books.forget();
  for (int n = 0; n < 20; ++n) books.record(0.01, at(1000 + 0.02 * n), 0);  // set moving at 2 m/s
  EXPECT_LE(books.balance().gain, 1e-6);
  EXPECT_NEAR(books.balance().kinetic_most, 2, 1e-6);
}

TEST(Books, ClaimNothingWhereStepsChangeTheirLengthAThousandfold) {
  // Fine steps after coarse ones, at both of which the pendulum keeps its energy.
  const auto angles = pendulum(1, 2, 1e-5, 60000);
  const auto at = [&](double t) {
    const double a = angles[static_cast<std::size_t>(std::lround(std::max(t, 0.0) / 1e-5))];
    return std::vector<Transform<double>>{{turn(Vector3d(0, -a, 0)), {std::sin(a), 0, -std::cos(a)}}};
  };
  Books books(kGravity, 1e-7);
  books.add(one_body(1, Vector3d::Constant(1e-9)), at(0), at(0), at(0), 1e-5);
  double t = 0;
  for (int n = 0; n < 60; ++n) {
    const double h = n < 30 ? 0.01667 : 1e-5;
    books.record(h, at(t += h), 0);
  }
  EXPECT_LE(books.balance().gain, 1e-3 * books.balance().kinetic_most);
}

TEST(Books, SayThatASpinIsTooFastForThem) {
  const Path path = symmetric_top(1, 1, {0, 0, 240});
  // 4 rad a step look like 2.3 the other way; 1 rad is seen.
  const Balance fast = books_of(one_body(1, Vector3d::Ones()), path, 1.0 / 60, 30).balance();
  EXPECT_EQ(fast.blind, fast.instants);
  EXPECT_EQ(fast.gain, 0);
  const Balance slow = books_of(one_body(1, Vector3d::Ones()), path, 1.0 / 240, 30).balance();
  EXPECT_EQ(slow.blind, 0);
  EXPECT_EQ(slow.seen, slow.instants);
}

TEST(Audit, IncludesNothingOfWhatItJudges) {
  namespace fs = std::filesystem;
  int files = 0;
  for (const auto& entry : fs::directory_iterator(source_dir() + "/tools/study/audit")) {
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);)
      EXPECT_TRUE(line.rfind("#include \"", 0) != 0 || line.find("\"study/audit/") != line.npos ||
                  line.find("\"sinew/skeleton/") != line.npos)
          << entry.path() << ": " << line;
    ++files;
  }
  EXPECT_GE(files, 10);
}

}  // namespace
}  // namespace sinew::audit
