#include "core/hand/body_check.h"

#include <fmt/ranges.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/hand/link_body.h"

namespace regrasp {
namespace {

const UrdfLink& LinkOf(const UrdfFile& file, const Link& link) {
  return file.links[static_cast<std::size_t>(file.FindLink(link.name))];
}

/// The moment that a link with shapes has in all axes [kg m²]; 0 of others.
double MomentInAllAxes(const UrdfFile& file, const Link& link) {
  const std::optional<UrdfInertial>& body = LinkOf(file, link).inertial;
  if (!body || link.shapes.empty()) return 0;
  const double moment = body->inertia(0, 0);
  return body->inertia == moment * Matrix3d::Identity() ? moment : 0;
}

/// Such moments that several links have: written for want of better ones.
std::set<double> Placeholders(const UrdfFile& file, const HandModel& hand) {
  constexpr int kSeveral = 3;
  std::map<double, int> links;
  for (std::size_t l = 1; l < hand.links.size(); ++l) ++links[MomentInAllAxes(file, hand.links[l])];
  std::set<double> placeholders;
  for (const auto& [moment, count] : links)
    if (moment > 0 && count >= kSeveral) placeholders.insert(moment);
  return placeholders;
}

}  // namespace

std::string WhatLacks(const UrdfInertial& body) {
  if (body.has_mass && body.has_inertia) return "";
  if (body.has_mass) return "<inertial> has no <inertia>";
  return body.has_inertia ? "<inertial> has no <mass>" : "<inertial> has no <mass>, no <inertia>";
}

int BodyLine(const UrdfLink& link) {
  return link.inertial ? link.inertial->inertia_line : link.line;
}

void CheckBodies(const UrdfFile& file, const std::map<int, const UrdfLink*>& lacking,
                 const LoadOptions& options, HandModel* hand, Problems* problems) {
  const std::set<double> placeholders = Placeholders(file, *hand);
  std::map<double, std::vector<std::string>> guessed;  // links, by their placeholder
  for (std::size_t l = 1; l < hand->links.size(); ++l) {
    Link& link = hand->links[l];
    const UrdfLink& in = LinkOf(file, link);
    if (in.inertial && in.inertial->mass < 0) continue;  // told by AddBody
    const auto part = lacking.find(static_cast<int>(l));
    const UrdfLink& told = part != lacking.end() ? *part->second : in;
    const int line = part != lacking.end() ? told.inertial->line : BodyLine(in);
    const std::string element = LinkElement(told.name);
    std::string why = part != lacking.end() ? WhatLacks(*told.inertial)
                                            : WhyNoBody(link, in.inertial.has_value());
    const bool impossible = !why.empty();
    if (!impossible) why = WhyUnlikely(link);
    const double moment = MomentInAllAxes(file, link);
    const bool guess = why.empty() && placeholders.contains(moment);
    if (guess) why = fmt::format("<inertia> is {:g} kg m² in all axes, as of other links", moment);
    if (const std::string heavy = WhyTooHeavy(link); !heavy.empty())
      problems->Warn(line, element, heavy);
    if (why.empty()) continue;
    if (options.inertia_from_shape) {
      InventBody(&link);
      problems->Warn(
          line, element,
          fmt::format("{}; {:.3g} g with the inertia of its shape taken", why, 1e3 * link.mass));
    } else if (impossible) {
      problems->Add(line, "{}: {}; --inertia-from-shape computes what is missing", element, why);
    } else if (guess) {
      guessed[moment].push_back(link.name);
    } else {
      problems->Warn(line, element, why + "; --inertia-from-shape computes it");
    }
  }
  for (const auto& [moment, links] : guessed)
    problems->Warn(0, "",
                   fmt::format("<inertia> is {:g} kg m² in all axes of several links ({}): a "
                               "placeholder; --inertia-from-shape computes it",
                               moment, fmt::join(links, ", ")));
}

}  // namespace regrasp
