#include "core/hand/scenario_names.h"

#include <fmt/ranges.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "core/common/limits.h"
#include "core/common/nearest_name.h"
#include "core/hand/hand_tree.h"
#include "core/hand/urdf.h"

namespace regrasp {
namespace {

using Names = std::set<std::string>;

/// "there is no joint "a"; did you mean 'b'?; joints are ...".
std::string NoSuch(const char* kind, const std::string& name, const Names& names) {
  constexpr std::size_t kMost = 64;  // bytes of a name that are shown
  return fmt::format("there is no {} \"{}\"{}; {}s are {}", kind, name.substr(0, kMost),
                     OrNearest(name, names), kind, fmt::join(names, ", "));
}

/// What a scenario names, against the URDF: locked and coupled joints first, as they decide which
/// joints drive a finger.
class NameCheck {
 public:
  NameCheck(const TomlFile& file, UrdfFile urdf)
      : file_(file), urdf_(std::move(urdf)), tree_(urdf_, layout_) {
    for (const UrdfLink& link : urdf_.links) links_.insert(link.name);
    for (const UrdfJoint& joint : urdf_.joints) joints_.insert(joint.name);
  }

  void Check(bool sees_all) {
    const std::size_t before = file_.count();
    const toml::array* fingers = file_.root()["finger"].as_array();
    for (std::size_t f = 0; fingers != nullptr && f < fingers->size(); ++f)
      if (const toml::table* finger = fingers->get(f)->as_table())
        layout_.fingers.push_back({"", (*finger)["tip_link"].value_or(std::string())});
    if (const toml::table* locked = file_.root()["locked_deg"].as_table())
      for (const auto& [key, angle] : *locked)
        if (IsJoint(file_.LineOf(key), "locked_deg", std::string(key.str())))
          layout_.locked[std::string(key.str())] = 0;
    if (const toml::table* coupled = file_.root()["coupled"].as_table()) {
      for (const auto& [key, node] : *coupled) ReadCoupling(key, node);
      if (file_.count() == before)
        for (const auto& [key, node] : *coupled) CheckCoupling(std::string(key.str()), node);
    }
    const bool joints_known = sees_all && file_.count() == before;
    for (std::size_t f = 0; fingers != nullptr && f < fingers->size(); ++f)
      if (const toml::table* finger = fingers->get(f)->as_table())
        CheckFinger(*finger, joints_known);
  }

 private:
  bool IsJoint(int line, const std::string& what, const std::string& name) {
    if (joints_.contains(name)) return true;
    file_.Add(line, "{}: {}", what, NoSuch("joint", name, joints_));
    return false;
  }

  void ReadCoupling(const toml::key& key, const toml::node& node) {
    const std::string name(key.str());
    const bool is_joint = IsJoint(file_.LineOf(key), "coupled", name);
    if (!node.is_table()) return;
    const toml::table& table = *node.as_table();
    const auto driver = table["driver"].value_exact<std::string>();
    if (!driver || driver->empty()) return;
    const std::string what = fmt::format("coupled.{} driver", name.substr(0, 64));
    if (IsJoint(file_.LineOf(*table.get("driver")), what, *driver) && is_joint)
      urdf_.joints[static_cast<std::size_t>(urdf_.FindJoint(name))].mimic = {
          *driver, table["ratio"].value_or(1.0), 0};
  }

  void CheckCoupling(const std::string& name, const toml::node& node) const {
    if (!node.is_table()) return;
    const toml::table& table = *node.as_table();
    const int j = urdf_.FindJoint(name);
    const HandTree::Coupling c = tree_.CouplingOf(j);
    const toml::node* driver = table.get("driver");
    const toml::node* ratio = table.get("ratio");
    if (c.driver < 0)
      file_.Add(driver ? *driver : node,
                "coupled.{} driver: leads in a ring or to a joint that is not there", name);
    else if (const std::string fault = HandTree::RatioFault(c.ratio);
             !fault.empty() && ratio != nullptr && ratio->is_number())
      file_.Add(*ratio, "coupled.{} ratio, with those of what its driver follows, {}", name, fault);
  }

  void CheckFinger(const toml::table& table, bool joints_known) const {
    const auto tip = table["tip_link"].value_exact<std::string>();
    if (!tip || tip->empty()) return;
    const std::string name = table["name"].value_or(std::string()).substr(0, 64);
    const toml::node& at = *table.get("tip_link");
    const int link = urdf_.FindLink(*tip);
    if (link < 0) return file_.Add(at, "finger \"{}\": {}", name, NoSuch("link", *tip, links_));
    const std::size_t count = joints_known ? tree_.DriversTo(link).size() : 1;
    if (const std::string fault = HandTree::FingerFault(count, *tip); !fault.empty())
      file_.Add(at, "finger \"{}\": {}", name, fault);
  }

  const TomlFile& file_;
  UrdfFile urdf_;
  HandLayout layout_;
  HandTree tree_;
  Names links_, joints_;
};

}  // namespace

void CheckScenarioNames(const TomlFile& file, UrdfFile urdf, bool sees_all) {
  NameCheck(file, std::move(urdf)).Check(sees_all);
}

}  // namespace regrasp
