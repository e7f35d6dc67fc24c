// The accuracy report: figures, words, pictures and page. Times in it are made up; none is measured here.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include "study/accuracy_report.h"
#include "study/words.h"

namespace sinew::study {
namespace {

/// A survivor of a step of h seconds.
AccuracyPoint point(const char* engine, const char* option, double h, double us, double error) {
  AccuracyPoint p;
  p.engine = engine, p.option = option, p.varied = "step";
  p.h = h, p.us = us, p.error = error, p.degrees = 10 * error;
  p.us_low = p.us_high = us, p.us_p99 = 2 * us, p.us_worst = 3 * us;
  p.survived = true;
  return p;
}

/// A scene with something in every part of the page: 1 cm costs 12.5 µs, 1 mm 50 µs.
AccuracyResult result_of(const AccuracyScene& scene, bool peers) {
  AccuracyResult result;
  result.scene = scene;
  result.scene.drive = [](Engine&, double, double) {};  // has angles
  result.points = {
      point("Sinew", "bossak float", 1.0 / 30, 7, 2e-2), point("Sinew", "bossak float", 1.0 / 60, 12.5, 8e-3),
      point("Sinew", "bossak float", 1.0 / 240, 50, 5e-4), point("Sinew", "bdf1 float", 1.0 / 60, 1, 1e-4)};
  if (peers) {
    result.points.push_back(point("MuJoCo", "Euler", 1.0 / 60, 8, 5e-3));
    result.points.push_back(point("ODE", "exact", 1.0 / 240, 1230, 9e-4));
  }
  mark_pareto(result.points);
  result.slopes = {{"Sinew", "bdf2 double", 1.98, 2}};
  for (const double truth : {1e-6, 1e-5, 1e-4, 1e-3}) result.estimates.push_back({0, 1.3 * truth, truth});
  result.uncertainty = 1e-6;
  return result;
}

Ensemble fall_of(const char* engine, const char* option) {
  Ensemble e;
  e.engine = engine, e.option = option, e.scene = ensemble_scenes()[0].name;
  e.hz = 60, e.seeds = 96;
  for (int n = 1; n < 90; ++n) {
    e.t.push_back(n / 60.0);
    for (EnergyCurve* c : {&e.energy, &e.truth}) c->mean.push_back(100 + n), c->deviation.push_back(9);
  }
  return e;
}

/// All scenes of the study, with made-up times.
AccuracyReport report_of(bool peers) {
  AccuracyReport report;
  for (const AccuracyScene& scene : accuracy_scenes()) report.results.push_back(result_of(scene, peers));
  report.results.push_back(result_of(stiff_driver(), peers));
  CrowdCost hit;
  hit.name = "walkers_hit", hit.title = "1000 walkers, 50 of them are pushed in every second";
  hit.characters = 1000, hit.solved = 31, hit.us = {2000, 3400, 4100};
  report.crowds = {hit};
  report.falls = {fall_of("Sinew", "bossak float")};
  if (peers) report.falls.push_back(fall_of("MuJoCo", "Euler"));
  return report;
}

/// What a reader sees: no tags, no styles, no scripts; one space between words.
std::string text_of(const std::string& page) {
  std::string text;
  for (std::size_t at = 0; at < page.size();) {
    if (page[at] != '<') {
      text += page[at++];
      continue;
    }
    for (const char* hidden : {"style", "script"})
      if (page.compare(at, 1 + std::strlen(hidden), std::string("<") + hidden) == 0)
        at = page.find(std::string("</") + hidden, at);
    at = page.find('>', at) + 1;
    text += ' ';
  }
  return std::regex_replace(text, std::regex("[ \n]+"), " ");
}

TEST(Words, NumbersNeedNoExponentAndNoMoreDigitsThanTheyMean) {
  for (const auto& [value, text] :
       {std::pair(0.0, "0"), std::pair(0.00012, "0.00012"), std::pair(0.284, "0.28"), std::pair(0.996, "1"),
        std::pair(1.0, "1"), std::pair(9.96, "10"), std::pair(12.5, "13"), std::pair(141.4, "141"),
        std::pair(999.7, "1000"), std::pair(1000.0, "1000"), std::pair(12345.0, "12,300"),
        std::pair(1.5e6, "1,500,000"), std::pair(-1.0, "–"), std::pair(std::nan(""), "–")})
    EXPECT_EQ(number(value), text) << value;
}

TEST(Words, TimesAndLengthsHaveTheUnitThatAPersonWouldChoose) {
  EXPECT_EQ(duration(1000), "1000 µs");
  EXPECT_EQ(duration(0.284), "0.28 µs");
  EXPECT_EQ(duration(1990), "1990 µs");
  EXPECT_EQ(duration(2000), "2 ms");
  EXPECT_EQ(duration(12345), "12 ms");
  EXPECT_EQ(duration(-1), "–");
  for (const auto& [metres, text] :
       {std::pair(1.0, "1 m"), std::pair(0.2, "20 cm"), std::pair(0.01, "1 cm"), std::pair(0.00667, "6.7 mm"),
        std::pair(1e-3, "1 mm"), std::pair(3e-4, "0.3 mm"), std::pair(3e-5, "30 µm"),
        std::pair(1e-4, "0.1 mm"), std::pair(1e-7, "0.1 µm"), std::pair(1e-9, "1 nm")})
    EXPECT_EQ(length(metres), text) << metres;
  EXPECT_EQ(rate(1.0 / 60), "60 Hz");
}

TEST(Report, FirstScreenSaysWhatACentimetreAndAMillimetreCostAndHowManyFit) {
  const std::string text = text_of(accuracy_html(report_of(false)));
  const std::size_t first = text.find(
      "a walker who is pushed costs 13 µs a frame where 1 cm is close enough, 50 µs "
      "for 1 mm: 80 or 20 of them fit into a millisecond of one core");
  ASSERT_NE(first, std::string::npos) << text.substr(0, 1500);
  EXPECT_NE(text.find("1000 walkers, 50 of them are pushed in every second: 2 ms a frame, at worst 4.1 ms"),
            std::string::npos);
  for (const char* word : {"Default scheme", "bdf1", "momentum"})  // a sentence each, before the diagrams
    EXPECT_LT(text.find(word), text.find("Scene by scene")) << word;
  EXPECT_LT(first, text.find("Default scheme"));
}

TEST(Report, SummaryCountsWhatAGameCanHaveAndPeersWhereTheyGetThere) {
  const std::vector<SummaryRow> rows = summary_rows(report_of(true).results);
  ASSERT_EQ(rows.size(), 6u);  // walker, runner, limp; 1 cm and 1 mm each
  EXPECT_EQ(rows[0].ours.us, 12.5) << "neither the longer step nor the scheme for comparison";
  EXPECT_EQ(rows[0].per_millisecond(), 80);
  EXPECT_EQ(rows[0].peers.size(), 2u);
  EXPECT_EQ(rows[1].ours.us, 50);
  ASSERT_EQ(rows[1].peers.size(), 1u);
  EXPECT_EQ(rows[1].peers[0].engine, "ODE");
}

TEST(Report, SaysWhereAnotherEngineIsCheaperAndWhereNone) {
  std::string text = text_of(accuracy_html(report_of(true)));
  EXPECT_NE(text.find("A walker is pushed, within 1 cm: MuJoCo 8 µs (Sinew 13 µs)"), std::string::npos);
  EXPECT_EQ(text.find("A walker is pushed, within 1 mm: ODE"), std::string::npos) << "which is dearer";
  AccuracyReport dear = report_of(true);
  for (AccuracyResult& result : dear.results)
    for (AccuracyPoint& p : result.points)
      if (p.engine == "MuJoCo") p.us = 80;
  text = text_of(accuracy_html(dear));
  EXPECT_NE(text.find("In none of these is another engine cheaper."), std::string::npos);
}

TEST(Report, WithoutPeersThereIsNoWordAboutThem) {
  const std::string page = accuracy_html(report_of(false));
  for (const char* word : {"MuJoCo", "Bullet", "DART", "ODE", "Simbody", "SUNDIALS", "Odeint", "peer", "Peer",
                           "another engine", "other engine", "two engines", "same engine, since"})
    EXPECT_EQ(page.find(word), std::string::npos) << word << ": " << page.substr(page.find(word), 200);
  EXPECT_NE(accuracy_html(report_of(true)).find("is behind MuJoCo"), std::string::npos)
      << "or the words above say nothing";
}

TEST(Report, NumbersOnThePageHaveNoExponents) {
  const std::string page = accuracy_html(report_of(true));
  const std::regex exponent("[0-9]e[-+]?[0-9]");
  std::smatch found;
  const std::string text = text_of(page);
  EXPECT_FALSE(std::regex_search(text, found, exponent))
      << found.prefix().str().substr(0, 100) << found.str();
  EXPECT_NE(page.find("1230 µs"), std::string::npos);
}

TEST(Report, MediansStandBesideTheDearestFrames) {
  const std::string text = text_of(accuracy_html(report_of(false)));
  EXPECT_NE(text.find("13 µs · 25 µs · 38 µs"), std::string::npos) << "average, 99 %, slowest";
  const std::string csv = accuracy_csv({result_of(accuracy_scenes()[0], false)});
  EXPECT_NE(csv.find(",us_p99,us_worst,"), std::string::npos);
  EXPECT_NE(csv.find(",12.5,12.5,12.5,25,37.5,"), std::string::npos);
  const nlohmann::json json = accuracy_json(report_of(false));
  EXPECT_EQ(json["summary"][0]["sinew"]["us_worst"], 37.5);
  EXPECT_EQ(json["crowds"][0]["us_p99"], 3400);
}

TEST(Report, ABusyMachineIsToldAtTheTop) {
  AccuracyReport report = report_of(false);
  report.busy = "a fixed piece of work took 8.0 ms once and 9.1 ms another time";
  const std::string text = text_of(accuracy_html(report));
  EXPECT_LT(text.find(report.busy), text.find("a walker who is pushed"));
}

TEST(Report, IsOnePageWithNothingToLoadWhateverNamesHold) {
  AccuracyReport report;
  report.results = {result_of(accuracy_scenes()[0], false)};
  for (AccuracyPoint& p : report.results[0].points) p.option = "</script><b>'&";
  const std::string page = accuracy_html(report);
  for (const char* hole :
       {"@MACHINE@", "@FIRST@", "@WORDS@", "@BODY@", "<script src", "<link", "<img", "<b>'"})
    EXPECT_EQ(page.find(hole), std::string::npos) << hole;
  EXPECT_NE(page.find(report.results[0].scene.title), std::string::npos);
}

/// Where a text of an SVG lies, by the font that pictures are laid out with.
struct Extent {
  std::string what;
  double left, right, top, bottom;
};

/// Texts and marks of a picture, and its box.
std::vector<Extent> extents_of(const std::string& svg, double& wide, double& high) {
  std::smatch box;
  EXPECT_TRUE(std::regex_search(svg, box, std::regex("viewBox='0 0 ([0-9.]+) ([0-9.]+)'")));
  wide = std::stod(box[1]), high = std::stod(box[2]);
  std::vector<Extent> all;
  const std::regex text("<text x='([-0-9.]+)' y='([-0-9.]+)' font-size='([0-9.]+)'([^>]*)>([^<]*)<");
  for (std::sregex_iterator m(svg.begin(), svg.end(), text), end; m != end; ++m) {
    const double x = std::stod((*m)[1]), y = std::stod((*m)[2]), size = std::stod((*m)[3]);
    const std::string how = (*m)[4];
    const double length = Canvas::width_of((*m)[5], size, how.find("bold") != std::string::npos);
    const double share = how.find("'end'") != std::string::npos    ? 1
                         : how.find("middle") != std::string::npos ? 0.5
                                                                   : 0;
    all.push_back({(*m)[5], x - share * length, x + (1 - share) * length, y - 0.8 * size, y + 0.25 * size});
  }
  const std::regex mark("<rect x='([-0-9.]+)' y='([-0-9.]+)' width='([0-9.]+)' height='([0-9.]+)'");
  for (std::sregex_iterator m(svg.begin(), svg.end(), mark), end; m != end; ++m) {
    const double x = std::stod((*m)[1]), y = std::stod((*m)[2]);
    all.push_back({"mark", x, x + std::stod((*m)[3]), y, y + std::stod((*m)[4])});
  }
  return all;
}

void expect_whole(const std::string& svg, const std::string& picture) {
  double wide = 0, high = 0;
  const std::vector<Extent> all = extents_of(svg, wide, high);
  EXPECT_GT(all.size(), 5u) << picture;
  for (const Extent& e : all) {
    EXPECT_GE(e.left, 0) << picture << ": " << e.what;
    EXPECT_LE(e.right, wide) << picture << ": " << e.what;
    EXPECT_GE(e.top, 0) << picture << ": " << e.what;
    EXPECT_LE(e.bottom, high) << picture << ": " << e.what;
  }
}

/// Two dozen lines with names as long as any engine's.
AccuracyResult crowded() {
  AccuracyResult result = result_of(accuracy_scenes()[0], false);
  for (int n = 0; n < 24; ++n) {
    const std::string option = "semi-explicit Euler 2, steps chosen, number " + std::to_string(n);
    result.points.push_back(point("Simbody", option.c_str(), 1.0 / 60, 10 + n, 1e-3));
  }
  return result;
}

std::string drawn(const std::function<convert::Error(const std::string&)>& draw) {
  const std::string file = testing::TempDir() + "report_" + std::to_string(getpid()) + ".svg";
  EXPECT_FALSE(draw(file));
  std::ifstream in(file);
  std::string svg(std::istreambuf_iterator<char>(in), {});
  std::filesystem::remove(file);
  return svg;
}

TEST(Report, LegendsStandWithinTheirPictures) {
  const AccuracyResult result = crowded();
  const std::string svg = drawn([&](const std::string& file) { return draw_accuracy(result, file); });
  expect_whole(svg, "diagram");
  for (const ChartLine& line : chart_lines(result))
    EXPECT_NE(svg.find(">" + escaped(line.label) + "</text>"), std::string::npos) << line.label;
  std::vector<Ensemble> falls;
  for (int n = 0; n < 24; ++n)
    falls.push_back(fall_of("Simbody", ("semi-explicit Euler 2, number " + std::to_string(n)).c_str()));
  for (int n = 12; n < 24; ++n) falls[n].seeds = 0, falls[n].lost = 96;  // listed below the others
  expect_whole(ensembles_svg(falls, ensemble_scenes()[0], 60), "falls");
  for (const double width : {350.0, 720.0}) {
    expect_whole(summary_svg(summary_rows(report_of(true).results), width), "bars");
    expect_whole(chart_svg(result, width, 400), "inline diagram");
    expect_whole(agreement_svg(result.estimates, width), "estimates");
  }
}

TEST(Report, PicturesAreDrawnAsFiles) {
  for (const char* ending : {"png", "svg"}) {
    const std::string file = testing::TempDir() + "accuracy_" + std::to_string(getpid()) + "." + ending;
    EXPECT_FALSE(draw_accuracy(result_of(accuracy_scenes()[0], true), file));
    EXPECT_GT(std::filesystem::file_size(file), 2000u);
    std::filesystem::remove(file);
  }
  EXPECT_TRUE(draw_accuracy(AccuracyResult{}, "nowhere.svg")) << "there is nothing to draw";
}

/// What headless Chromium makes of a page: its document after all scripts, and what it said of itself.
struct Browsed {
  std::string document, log;
};

Browsed browse(const std::string& file) {
  const std::string profile = file + ".profile", log = file + ".log";
  const std::string command =
      "timeout 100 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run "
      "--disable-background-networking --disable-component-update --disable-sync --user-data-dir=" +
      profile + " --virtual-time-budget=3000 --dump-dom file://" + file + " 2>" + log;
  Browsed result;
  FILE* browser = popen(command.c_str(), "r");
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, browser)) > 0;) result.document.append(buffer, n);
  pclose(browser);
  std::ifstream said(log);
  result.log.assign(std::istreambuf_iterator<char>(said), {});
  std::filesystem::remove_all(profile);
  std::filesystem::remove(log);
  return result;
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(Report, ABrowserShowsTextAndPicturesWithAndWithoutScripts) {
  const std::string file = testing::TempDir() + "report_" + std::to_string(getpid()) + ".html";
  std::ofstream(file) << "<html><body><script>document.body.append('it runs')</script></body></html>";
  if (browse(file).document.find("it runs</body>") == std::string::npos)
    GTEST_SKIP() << "no Chromium here that opens a page of one line";
  std::string page = accuracy_html(report_of(true));
  std::ofstream(file) << page;
  const Browsed with = browse(file);
  const std::string charset = "<meta charset=\"utf-8\">";
  page.insert(page.find(charset),
              "<meta http-equiv='Content-Security-Policy' content=\"script-src 'none'\">");
  std::ofstream(file) << page;
  const Browsed without = browse(file);
  std::filesystem::remove(file);
  EXPECT_NE(with.document.find("data-errors=\"0\""), std::string::npos)
      << with.document.substr(0, 300) << with.log;
  EXPECT_EQ(without.document.find("data-errors"), std::string::npos) << "scripts ran";
  EXPECT_EQ(text_of(with.document), text_of(without.document));
  EXPECT_EQ(count_of(without.document, "<svg"), count_of(without.document, "</svg>"));
  EXPECT_GT(count_of(without.document, "<svg"), 10u);
}

}  // namespace
}  // namespace sinew::study
