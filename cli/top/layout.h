#pragma once

/// Which panels of `top` are on the screen, and where.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/top/panels.h"

namespace regrasp::cli {

/// What is drawn over and below the panels.
struct Overlay {
  std::string finger = {};  ///< whose manipulability is drawn; see DrawGraphs
  std::string keys = {};    ///< the last row, when `items` is empty
  std::vector<std::pair<std::string, std::string>> items = {};  ///< key and label, in the last row
  std::string message = {};  ///< the answer to the last key; takes the last row
  Ink message_ink = Ink::kPlain;
  bool help = false;
};

/// A panel and its box.
struct Placed {
  std::string_view
      name;  ///< "header", "object", "fingers", "exploration", "graphs", "events", "keys"
  Box box;
};

/// The panels for a terminal of this size, top to bottom. Where there is no room for all, these go,
/// in this order: events, exploration, graphs, object, the header's second row, keys, fingers.
std::vector<Placed> Layout(int rows, int columns, int fingers);

/// The whole screen.
Screen DrawDashboard(int rows, int columns, bool utf8, const DashboardModel& model,
                     const Overlay& overlay);

}  // namespace regrasp::cli
