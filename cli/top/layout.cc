#include "cli/top/layout.h"

#include <algorithm>
#include <map>

namespace regrasp::cli {
namespace {

constexpr std::string_view kHelp[] = {
    "p space  pause, go on            + -   noise up, down",
    "g        grasp                   l     plot a picture",
    "e        explore with a finger   f     whose curve",
    "r        rotate                  x     reset",
    "s        stop the job            q     quit",
    "",
    "Fingers  T thumb, F first, M middle, R ring, L little",
    "Roles    H hold, E explore, M move, - free",
    "LIMIT    to the nearest joint limit; ! is under 3°",
    "Curves   the last 30 s of simulated time; the dotted",
    "         line is the threshold of stability",
};

void DrawHelp(Screen* screen) {
  int width = 0;
  for (const auto line : kHelp) width = std::max(width, Cells(line));
  const Box box{std::max((screen->rows() - static_cast<int>(std::size(kHelp)) - 2) / 2, 0),
                std::max((screen->columns() - width - 4) / 2, 0),
                std::min(static_cast<int>(std::size(kHelp)) + 2, screen->rows()),
                std::min(width + 4, screen->columns())};
  screen->Frame(box, "Keys");
  for (int i = 0; i < box.rows - 2; ++i)
    screen->Put(box.row + 1 + i, box.column + 2, kHelp[i], Ink::kPlain, box.columns - 4);
}

void DrawKeys(Screen* screen, const Box& box, const Overlay& overlay) {
  if (!overlay.message.empty()) {
    screen->Put(box.row, box.column + 1, overlay.message, overlay.message_ink, box.columns - 1);
    return;
  }
  int column = screen->Put(box.row, box.column + 1, overlay.keys, Ink::kBold, box.columns - 1);
  if (!overlay.keys.empty()) column += 2;
  for (const auto& [key, label] : overlay.items) {
    if (column + Cells(key) + 1 + Cells(label) > box.column + box.columns) break;
    column = screen->Put(box.row, column, key, Ink::kBold) + 1;
    column = screen->Put(box.row, column, label, Ink::kDim) + 2;
  }
}

}  // namespace

std::vector<Placed> Layout(int rows, int columns, int fingers) {
  if (rows < 1 || columns < 1) return {};
  // What is kept longest first. A second entry of a name makes the panel taller.
  const std::pair<std::string_view, int> kept[] = {
      {"header", 1},      {"fingers", std::min(fingers + 1, std::max(rows - 2, 1))},
      {"keys", 1},        {"header", 1},
      {"object", 1},      {"graphs", 4},
      {"exploration", 1}, {"events", 2}};
  std::map<std::string_view, int> height;
  int left = rows;
  for (const auto& [name, need] : kept) {
    if (need > left) continue;
    height[name] += need;
    left -= need;
  }
  const auto grow = [&](std::string_view name, int most) {
    if (!height.contains(name)) return;
    const int more = std::clamp(most - height[name], 0, left);
    height[name] += more;
    left -= more;
  };
  grow("graphs", 8);
  grow("events", 6);
  grow("graphs", std::max(8, rows / 2 - 4));
  grow("events", rows);
  grow("graphs", rows);
  std::vector<Placed> placed;
  int row = 0;
  for (const std::string_view name :
       {"header", "object", "exploration", "fingers", "graphs", "events"}) {
    if (!height.contains(name)) continue;
    placed.push_back({name, {row, 0, height[name], columns}});
    row += height[name];
  }
  if (height.contains("keys")) placed.push_back({"keys", {rows - 1, 0, 1, columns}});
  return placed;
}

Screen DrawDashboard(int rows, int columns, bool utf8, const DashboardModel& model,
                     const Overlay& overlay) {
  Screen screen(rows, columns, utf8);
  for (const auto& [name, box] : Layout(rows, columns, static_cast<int>(model.Fingers().size()))) {
    if (name == "header") DrawHeader(&screen, box, model);
    if (name == "object") DrawObject(&screen, box, model);
    if (name == "exploration") DrawExploration(&screen, box, model);
    if (name == "fingers") DrawFingers(&screen, box, model);
    if (name == "graphs") DrawGraphs(&screen, box, model, overlay.finger);
    if (name == "events") DrawEvents(&screen, box, model);
    if (name == "keys") DrawKeys(&screen, box, overlay);
  }
  if (overlay.help) DrawHelp(&screen);
  return screen;
}

}  // namespace regrasp::cli
