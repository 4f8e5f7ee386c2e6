#include "core/hand/urdf_unused.h"

#include <string>
#include <string_view>

#include "core/hand/object_model.h"
#include "core/hand/urdf_file.h"
#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

using tinyxml2::XMLElement;

std::string NameOf(const XMLElement& node) {
  return node.Attribute("name") ? node.Attribute("name") : "";
}

/// What a <contact> holds: the names of its first elements, that of friction with its value.
std::string Contents(const XMLElement& contact) {
  std::string text;
  int count = 0;
  constexpr int kMost = 8;
  for (const XMLElement* part = contact.FirstChildElement(); part != nullptr;
       part = part->NextSiblingElement()) {
    if (++count > kMost) return text + ", ...";
    text += (text.empty() ? "" : ", ") + std::string(part->Name()).substr(0, 40);
    if (part->Name() == std::string_view("lateral_friction") && part->Attribute("value"))
      text += " = " + Quoted(part->Attribute("value"));
  }
  return text;
}

/// Whether a number as it is written is other than 0.
bool Counts(const char* number) {
  return number != nullptr &&
         std::string_view(number).find_first_of("123456789") != std::string_view::npos;
}

bool HasFriction(const XMLElement& joint) {
  const XMLElement* dynamics = joint.FirstChildElement("dynamics");
  return dynamics != nullptr && Counts(dynamics->Attribute("friction"));
}

bool HasSoftLimits(const XMLElement& joint) {
  const XMLElement* safety = joint.FirstChildElement("safety_controller");
  return safety != nullptr && (Counts(safety->Attribute("soft_lower_limit")) ||
                               Counts(safety->Attribute("soft_upper_limit")));
}

void WarnOfContact(const XMLElement& robot, Problems* problems) {
  for (const XMLElement* link = robot.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    const XMLElement* contact = link->FirstChildElement("contact");
    if (contact == nullptr || contact->FirstChildElement() == nullptr) continue;
    return problems->Warn(
        contact->GetLineNum(), LinkElement(NameOf(*link)),
        fmt::format("<contact> is not used: {}; the friction of every contact is that of the "
                    "object, \"friction\" in the .toml beside its URDF, or {:g} where it says none",
                    Contents(*contact), ObjectModel().friction));
  }
}

/// One warning, by the first of the joints that move and have it.
template <typename Has>
void WarnOfJoints(const XMLElement& robot, const char* child, const Has& has, const char* what,
                  Problems* problems) {
  const XMLElement* first = nullptr;
  int more = 0;
  for (const XMLElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const char* type = joint->Attribute("type");
    if (type == nullptr || type == std::string_view("fixed") || !has(*joint)) continue;
    more += first != nullptr;
    if (first == nullptr) first = joint;
  }
  if (first == nullptr) return;
  const std::string others =
      more > 0 ? fmt::format(" (nor of {} more joint{})", more, more > 1 ? "s" : "") : "";
  problems->Warn(first->FirstChildElement(child)->GetLineNum(), JointElement(NameOf(*first)),
                 what + others);
}

}  // namespace

void WarnOfUnused(const XMLElement& robot, Problems* problems) {
  WarnOfContact(robot, problems);
  WarnOfJoints(robot, "dynamics", HasFriction, "<dynamics> friction is not simulated", problems);
  WarnOfJoints(robot, "safety_controller", HasSoftLimits,
               "soft limits of <safety_controller> are not simulated: the joint goes as far as its "
               "<limit>",
               problems);
}

}  // namespace regrasp
