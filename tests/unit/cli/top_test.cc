// The dashboard's model, layout, drawing and keys, without a terminal.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cli/print/braille.h"
#include "cli/top/keys.h"
#include "cli/top/layout.h"
#include "core/exploration/criterion.h"
#include "core/protocol/methods.h"

namespace regrasp::cli {
namespace {

constexpr const char* kNames[] = {"first", "middle", "ring", "little", "thumb"};

Json Status(double time_s) {
  return {{"version", "9.8.7"},   {"state", "exploring"},
          {"holds_alone", true},  {"paused", false},
          {"time_s", time_s},     {"real_time_factor", 1.0},
          {"tick_p99_s", 104e-6}, {"seed", 7},
          {"hand", "shadow"},     {"object", "sphere"},
          {"clients", 2},         {"noise", {{"preset", "paper"}}}};
}

Json Contacts(double time_s, const char* exploring = nullptr) {
  Json fingers = Json::object();
  for (const char* name : kNames)
    fingers[name] = {
        {"role", exploring != nullptr && std::string(name) == exploring ? "explore" : "hold"},
        {"in_contact", true},
        {"force_n", 1.234}};
  return {{"time_s", time_s},
          {"fingers", fingers},
          {"object", {{"p_WO_m", {0.003, 0, 0.1}}, {"p_WO_reference_m", {0, 0.004, 0.1}}}}};
}

Json Quality(double time_s, double stability = 1.5) {
  Json fingers = Json::object();
  for (const char* name : kNames)
    fingers[name] = {{"manipulability", 0.777}, {"joint_limit_margin_rad", 0.02}};
  return {{"time_s", time_s}, {"criterion", "manipulability"}, {"stability", stability},
          {"threshold", 0.3}, {"exploration", nullptr},        {"fingers", fingers}};
}

DashboardModel Model(const char* exploring = nullptr) {
  DashboardModel model;
  for (int i = 1; i <= 20; ++i) {
    model.Add("status", Status(0.1 * i));
    model.Add("contacts", Contacts(0.1 * i, exploring));
    model.Add("quality", Quality(0.1 * i));
  }
  model.Add("events", {{"t_s", 1.0}, {"kind", "state"}, {"text", "holding"}});
  return model;
}

std::string Text(int rows, int columns, const DashboardModel& model) {
  return DrawDashboard(rows, columns, true, model, Keys().Shown()).Text();
}

bool Has(const std::string& text, std::string_view what) {
  return text.find(what) != std::string::npos;
}

TEST(TopLayout, PanelsFillEveryTerminalWithoutOverlap) {
  for (int rows = 1; rows <= 70; ++rows) {
    int next = 0;
    for (const Placed& panel : Layout(rows, 80, 5)) {
      // The keys stand in the last row; at most one row above them is too little for any panel.
      const bool keys = panel.name == "keys";
      EXPECT_GE(panel.box.row, next) << rows << ' ' << panel.name;
      EXPECT_LE(panel.box.row, next + (keys ? 1 : 0)) << rows << ' ' << panel.name;
      EXPECT_GE(panel.box.rows, 1);
      next = panel.box.row + panel.box.rows;
    }
    EXPECT_EQ(next, rows);
  }
}

TEST(TopLayout, PanelsGoInOneOrder) {
  const std::vector<std::string_view> order = {"events", "exploration", "graphs", "object", "keys"};
  std::size_t gone = 0;
  for (int rows = 60; rows >= 1; --rows) {
    std::set<std::string_view> shown;
    for (const Placed& panel : Layout(rows, 80, 5)) shown.insert(panel.name);
    EXPECT_TRUE(shown.contains("header"));
    // Where one row is left a panel that needs one may stay though a taller one went.
    while (gone < order.size() && !shown.contains(order[gone])) ++gone;
    for (std::size_t i = gone; i < order.size(); ++i) {
      EXPECT_TRUE(shown.contains(order[i]) || order[i] == "exploration") << rows << ' ' << order[i];
    }
  }
  EXPECT_EQ(gone, order.size());
}

TEST(TopDrawing, NoNumberIsEverCutOff) {
  const DashboardModel model = Model("ring");
  for (int columns = 1; columns <= 220; ++columns) {
    const std::string text = Text(24, columns, model);
    for (const std::string_view whole :
         {"1.23 N", "1.1°!", " 0.777", "off by 5.00 mm", "tick p99 104 µs", "1.00× real time"}) {
      // Either all of it, or not even its beginning.
      const std::string_view start = whole.substr(0, whole.size() / 2);
      if (columns < 30 || !Has(text, start)) continue;
      EXPECT_TRUE(Has(text, whole)) << columns << '\n' << text;
    }
  }
}

TEST(TopDrawing, WhereTimeStandsStillThereIsNoSpeed) {
  DashboardModel model = Model();
  Json status = Status(3);
  status.update({{"real_time_factor", nullptr}, {"clock", "lockstep"}, {"advancing", false}});
  model.Add("status", status);
  const std::string lockstep = Text(24, 120, model);
  EXPECT_TRUE(Has(lockstep, "waits for a job")) << lockstep;
  EXPECT_FALSE(Has(lockstep, "real time")) << lockstep;
  status.update({{"clock", "continuous"}, {"paused", true}});
  model.Add("status", status);
  const std::string paused = Text(24, 120, model);
  EXPECT_TRUE(Has(paused, "PAUSED")) << paused;
  EXPECT_FALSE(Has(paused, "waits") || Has(paused, "real time")) << paused;
}

TEST(TopDrawing, AsciiTerminalsGetAscii) {
  const Screen screen = DrawDashboard(40, 120, false, Model("ring"), Keys().Shown());
  const std::string text = screen.Text();
  EXPECT_TRUE(std::all_of(text.begin(), text.end(),
                          [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
  EXPECT_FALSE(Has(text, "?  ?")) << text;
}

TEST(TopDrawing, ControlCharactersNeverReachTheTerminal) {
  DashboardModel model = Model();
  model.Add("events", {{"t_s", 1.0}, {"kind", "state"}, {"text", "evil \x1b[2J\x7f \xff text"}});
  const Screen screen = DrawDashboard(40, 120, true, model, Keys().Shown());
  for (int row = 0; row < screen.rows(); ++row)
    for (int column = 0; column < screen.columns(); ++column) {
      EXPECT_GE(screen.at(row, column).glyph, 0x20u);
      EXPECT_NE(screen.at(row, column).glyph, 0x7Fu);
    }
  EXPECT_TRUE(Has(screen.Text(), "evil ?[2J? ? text"));
}

TEST(TopDrawing, TheActiveCriterionIsMarkedInWords) {
  DashboardModel model = Model("ring");
  EXPECT_TRUE(Has(Text(24, 100, model), "Manipulability φ ring [active]"));
  Json quality = Quality(3, 0.2);
  quality["criterion"] = "stability";
  model.Add("quality", quality);
  EXPECT_TRUE(Has(Text(24, 100, model), "Stability 0.20 < 0.30 [active]"));
  // Where only one graph fits it is the active one.
  EXPECT_TRUE(Has(Text(24, 50, model), "Stability 0.20"));
  EXPECT_FALSE(Has(Text(24, 50, model), "Manipulability φ"));
}

TEST(TopDrawing, EveryCriterionIsMarkedWhereItIsShown) {
  for (const CriterionInfo& row : kCriterionTable) {
    DashboardModel model = Model("ring");
    Json quality = Quality(3, 0.2);
    quality["criterion"] = row.name;
    model.Add("quality", quality);
    const std::string text = Text(24, 100, model);
    const bool finger = row.phi_of == PhiOf::kManipulability || row.phi_of == PhiOf::kBoth;
    const bool grasp = row.phi_of == PhiOf::kStability || row.phi_of == PhiOf::kBoth;
    EXPECT_EQ(Has(text, "φ ring [active]"), finger) << row.name;
    EXPECT_EQ(Has(text, "Stability 0.20 < 0.30 [active]"), grasp) << row.name;
    EXPECT_TRUE(finger || grasp || Has(text, fmt::format("φ ring [{}]", row.name))) << row.name;
  }
}

TEST(TopDrawing, AnEmptyModelDrawsItsFramesAndNoNumbers) {
  for (int rows = 0; rows <= 30; ++rows) {
    const std::string text = Text(rows, 3 * rows, DashboardModel());
    EXPECT_EQ(std::ranges::count(text, '\n'), rows);
    EXPECT_FALSE(Has(text, "nan") || Has(text, "null") || Has(text, "[active]")) << text;
  }
  EXPECT_TRUE(Has(Text(24, 100, DashboardModel()), "Stability"));
}

TEST(TopDrawing, ItemsOfTheHighestRankGoFirst) {
  const auto line = [](int width) {
    Screen screen(1, 40);
    PutItems(&screen, {0, 0, 1, width},
             {{"alpha", Ink::kPlain, 0}, {"beta", Ink::kPlain, 2}, {"gamma", Ink::kPlain, 1}}, 1);
    return screen.Text();
  };
  EXPECT_EQ(line(16), "alpha beta gamma\n");
  EXPECT_EQ(line(15), "alpha gamma\n");
  EXPECT_EQ(line(10), "alpha\n");
  EXPECT_EQ(line(3), "alp\n");
}

TEST(TopDrawing, BarsCountEighths) {
  EXPECT_EQ(FineBar(0.5, 4), "██··");
  EXPECT_EQ(FineBar(1.0 / 32, 4), "▏···");
  EXPECT_EQ(FineBar(7, 2), "██");
  EXPECT_EQ(FineBar(-1, 2), "··");
  EXPECT_EQ(FineBar(std::nan(""), 2), "··");
}

TEST(Braille, DotsStandWhereUnicodePutsThem) {
  BrailleCanvas canvas(1, 1);
  EXPECT_EQ(canvas.Glyph(0, 0), U' ');
  canvas.Set(0, 0);
  EXPECT_EQ(canvas.Glyph(0, 0), U'⠁');
  canvas.Set(1, 3);
  EXPECT_EQ(canvas.Glyph(0, 0), U'⢁');
  canvas.Set(2, 0);
  canvas.Set(0, -1);
  EXPECT_EQ(canvas.Glyph(0, 0), U'⢁');
}

TEST(Braille, LinesAreConnectedAndHitBothEnds) {
  BrailleCanvas canvas(10, 5);
  canvas.Line(3, 17, 15, 2);
  int dots = 0;
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 10; ++column)
      dots += canvas.Glyph(column, row) == U' '
                  ? 0
                  : __builtin_popcount(canvas.Glyph(column, row) & 0xFF);
  EXPECT_EQ(dots, 16);  // one for each step of the longer side, 15 rows down
  BrailleCanvas ends(10, 5);
  ends.Set(3, 17);
  ends.Set(15, 2);
  EXPECT_NE(canvas.Glyph(1, 4), U' ');
  EXPECT_NE(canvas.Glyph(7, 0), U' ');
}

TEST(TopModel, CurvesHold30Seconds) {
  Series series;
  for (int i = 0; i <= 1000; ++i) series.Add(0.1 * i, i);
  EXPECT_NEAR(series.points().front().time_s, 70, 0.11);  // one sample
  EXPECT_EQ(series.points().back().value, 1000);
}

TEST(TopModel, ANewRunBeginsWithEmptyCurves) {
  DashboardModel model = Model();
  model.Add("events", {{"t_s", 2.0}, {"kind", "slip"}, {"text", "slip"}});
  EXPECT_EQ(model.slips(), 1);
  EXPECT_EQ(model.stability().points().size(), 20u);
  model.Add("quality", Quality(0.01));
  EXPECT_EQ(model.stability().points().size(), 1u);
  EXPECT_EQ(model.manipulability("ring").points().size(), 1u);
  EXPECT_EQ(model.slips(), 0);
}

TEST(TopKeys, LettersBecomeRequests) {
  Keys keys;
  const DashboardModel model = Model();
  EXPECT_EQ(keys.Press('p', model)->method, "pause");
  EXPECT_EQ(keys.Press('s', model)->method, "stop");
  EXPECT_FALSE(keys.Press('e', model));
  const auto explore = keys.Press('M', model);
  ASSERT_TRUE(explore);
  EXPECT_EQ(explore->method, "explore");
  EXPECT_EQ(explore->params, (Json{{"finger", "middle"}}));
  keys.Press('r', model);
  EXPECT_FALSE(keys.Press(Keys::kEscape, model));
  EXPECT_FALSE(keys.quit());
  keys.Press('q', model);
  EXPECT_TRUE(keys.quit());
}

// Of fingers that begin alike each has a key of its own.
TEST(TopKeys, EachFingerOfAnyHandCanExplore) {
  Json fingers = Json::object();
  for (const char* name : {"finger1", "finger2", "finger3", "thumb"})
    fingers[name] = {{"role", "hold"}, {"in_contact", true}, {"force_n", 1}};
  DashboardModel model = Model();
  model.Add("contacts", {{"time_s", 3}, {"fingers", fingers}});
  for (const auto& [key, name] : {std::pair{'2', "finger2"}, {'3', "finger3"}, {'t', "thumb"}}) {
    Keys keys;
    EXPECT_FALSE(keys.Press('e', model));
    const auto explore = keys.Press(key, model);
    ASSERT_TRUE(explore) << key;
    EXPECT_EQ(explore->params, (Json{{"finger", name}}));
  }
}

TEST(TopKeys, ResetNeedsAYes) {
  Keys keys;
  const DashboardModel model = Model();
  EXPECT_FALSE(keys.Press('x', model));
  EXPECT_FALSE(keys.Press('x', model));
  EXPECT_FALSE(keys.Press('x', model));
  EXPECT_EQ(keys.Press('y', model)->method, "reset");
}

TEST(TopKeys, APausedRunIsResumed) {
  DashboardModel model = Model();
  Json status = Status(5);
  status["paused"] = true;
  model.Add("status", status);
  EXPECT_EQ(Keys().Press('p', model)->method, "resume");
}

TEST(TopKeys, NoiseStaysInsideTheWiresLimits) {
  Json noise = {{"preset", "paper"}, {"position_m", 0.001}, {"force_n", 0.0}};
  EXPECT_EQ(ChangeNoise(noise, true).params, (Json{{"position_m", 0.00125}}));
  EXPECT_EQ(ChangeNoise(noise, false).params, (Json{{"position_m", 0.0008}}));
  Json taxel = noise;
  taxel.update({{"taxel_pitch_m", 0.003}, {"object_rate_hz", 15.0}, {"object_delay_frames", 1}});
  EXPECT_EQ(ChangeNoise(taxel, true).params, ChangeNoise(noise, true).params);
  const double most = FindParam(*FindMethod("noise.set"), "position_m")->max;
  for (int i = 0; i < 100; ++i) noise["position_m"] = ChangeNoise(noise, true).params["position_m"];
  EXPECT_EQ(noise["position_m"], most);
  EXPECT_EQ(ChangeNoise({{"preset", "off"}, {"position_m", 0.0}}, true).params,
            (Json{{"preset", "fine"}}));
}

}  // namespace
}  // namespace regrasp::cli
