// Holding: `claims hold` with gravity from six sides, `claims objects` several objects.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "bench/claims/claims.h"
#include "bench/claims/parallel.h"
#include "bench/trial.h"

namespace regrasp::claims {
namespace {

/// {held, max deviation mm, rms mm, mean force residual / weight, foreign contacts, largest
/// link-link count}
Row HoldTrial(Session& session, double seconds) {
  if (!GraspObject(session)) return {kFailed, 0, 0, 0, 0, 0};
  const Vector3d p0 = session.truth().p_WO;
  double worst = 0, square = 0, foreign = 0, links = 0;
  Vector3d force = Vector3d::Zero();
  const int ticks = static_cast<int>(seconds * 1000);
  for (int k = 0; k < ticks; ++k) {
    session.Tick();
    session.TakeEvents();
    const double d = (session.truth().p_WO - p0).norm();
    worst = std::max(worst, d);
    square += d * d;
    for (const ObjectContact& c : session.truth().contacts) {
      force += c.force_W;
      foreign += c.finger < 0;
    }
    links = std::max(links, static_cast<double>(session.truth().link_link_contacts));
  }
  const double weight = session.world().mass_kg() * session.world().gravity_W().norm();
  const Vector3d mean_force = force / ticks;
  const double residual =
      (mean_force + session.world().mass_kg() * session.world().gravity_W()).norm() / weight;
  return {session.state() == SessionState::kHolding ? 1.0 : 0.0,
          worst * 1e3,
          std::sqrt(square / ticks) * 1e3,
          residual,
          foreign,
          links};
}

void PrintHold(const char* label, const std::vector<Row>& rows) {
  int held = 0, failed = 0;
  std::vector<double> worst, rms, residual, foreign, links;
  for (const Row& r : rows) {
    if (r.empty() || r[0] == kFailed) {
      ++failed;
      continue;
    }
    held += r[0] == 1.0;
    worst.push_back(r[1]);
    rms.push_back(r[2]);
    residual.push_back(r[3]);
    foreign.push_back(r[4]);
    links.push_back(r[5]);
  }
  std::printf(
      "%-16s held %2d/%-2zu  not grasped %d  max deviation %5.2f mm  rms %5.2f mm  "
      "force balance %5.2f %%  foreign contacts %.0f  link-link %.0f\n",
      label, held, rows.size(), failed, Max(worst), Mean(rms), 100 * Max(residual), Max(foreign),
      Max(links));
  std::fflush(stdout);
}

}  // namespace

int Hold(const Options& o) {
  const std::pair<const char*, Vector3d> directions[] = {
      {"gravity +x", {9.81, 0, 0}},  {"gravity -x", {-9.81, 0, 0}}, {"gravity +y", {0, 9.81, 0}},
      {"gravity -y", {0, -9.81, 0}}, {"gravity +z", {0, 0, 9.81}},  {"gravity -z", {0, 0, -9.81}}};
  for (const auto& [label, gravity] : directions) {
    const auto rows = Parallel(o.seeds, o.jobs, [&, g = gravity](int k) {
      SessionConfig config = MakeConfig(o, o.first + k, o.object);
      config.parameters.gravity_W = g;
      Session session(std::move(config));
      return HoldTrial(session, o.seconds);
    });
    PrintHold(label, rows);
  }
  return 0;
}

int Objects(const Options& o) {
  std::istringstream list(o.object.empty() ? "sphere_45mm,sphere,sphere_60mm,egg" : o.object);
  for (std::string object; std::getline(list, object, ',');) {
    const auto rows = Parallel(o.seeds, o.jobs, [&](int k) {
      Session session(MakeConfig(o, o.first + k, object));
      return HoldTrial(session, o.seconds);
    });
    PrintHold(object.c_str(), rows);
  }
  return 0;
}

}  // namespace regrasp::claims
