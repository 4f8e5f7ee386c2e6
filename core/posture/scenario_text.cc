#include "core/posture/scenario_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/files/names.h"

namespace regrasp {
namespace {

constexpr double kDegree = M_PI / 180;

/// A string of TOML, in which no control character may stand as it is.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      quoted += fmt::format("\\u{:04x}", byte);
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::string Key(const std::string& name) {
  const bool bare = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
  return bare ? name : Quoted(name);
}

std::string Triple(const Vector3d& v, int digits) {
  return fmt::format("[{:.{}f}, {:.{}f}, {:.{}f}]", v.x(), digits, v.y(), digits, v.z(), digits);
}

}  // namespace

std::string WriteScenario(const ScenarioText& text, const HandModel& hand) {
  std::string out;
  for (const std::string& line : text.comments) out += "# " + ShownText(line) + "\n";
  out += "# Every key, its unit and its meaning: models/README.md.\n";
  const HandLayout& layout = text.layout;
  const Scenario& scenario = text.scenario;
  if (!text.urdf.empty()) out += fmt::format("urdf = {}\n", Quoted(text.urdf));
  out += fmt::format("object = {}\n", Quoted(scenario.object));
  out += fmt::format("gravity_m_s2 = {}\n", Triple(scenario.gravity_W, 6));
  out += fmt::format("armature_kg_m2 = {:g}\ndamping_nm_s_rad = {:g}\n", layout.armature,
                     layout.damping);
  if (layout.least_damping > 0)
    out += fmt::format("least_damping_nm_s_rad = {:g}\n", layout.least_damping);
  if (text.options.inertia_from_shape) out += "inertia_from_shape = true\n";
  if (text.options.fill_missing_meshes) out += "fill_missing_meshes = true\n";
  const Vector3d turn = RotationVector(Quaterniond(layout.X_HR.linear()));
  out += fmt::format("\n[palm]\nrotation_deg = {}\nposition_m = {}\n", Triple(turn / kDegree, 4),
                     Triple(layout.X_HR.translation(), 5));
  out += fmt::format("\n[object_pose]\nposition_m = {}\n", Triple(scenario.X_WO.translation(), 5));
  if (!scenario.X_WO.linear().isIdentity(0))
    out += fmt::format("rotation_deg = {}\n",
                       Triple(RotationVector(Quaterniond(scenario.X_WO.linear())) / kDegree, 4));
  for (const auto& finger : layout.fingers)
    out += fmt::format("\n[[finger]]\nname = {}\ntip_link = {}\n", Quoted(finger.name),
                       Quoted(finger.tip_link));
  if (!layout.locked.empty()) out += "\n[locked_deg]\n";
  for (const auto& [name, angle] : layout.locked)
    out += fmt::format("{} = {:.2f}\n", Key(name), angle / kDegree);
  for (const auto& [name, c] : layout.coupled)
    out += fmt::format("\n[coupled.{}]\ndriver = {}\nratio = {:g}\noffset_deg = {:.2f}\n",
                       Key(name), Quoted(c.driver), c.ratio, c.offset / kDegree);
  for (const auto& [table, q] : {std::pair{"q_preshape_deg", &scenario.q_preshape},
                                 std::pair{"q_closed_deg", &scenario.q_closed}}) {
    out += fmt::format("\n[{}]\n", table);
    for (int j = 0; j < hand.num_joints(); ++j)
      out += fmt::format("{} = {:.2f}\n", Key(hand.joints[static_cast<std::size_t>(j)].name),
                         (*q)[j] / kDegree);
  }
  return out;
}

}  // namespace regrasp
