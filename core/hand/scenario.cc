#include "core/hand/scenario.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <system_error>

#include "core/files/names.h"
#include "core/hand/scenario_names.h"
#include "core/hand/toml_file.h"
#include "core/hand/urdf.h"
#include "core/hand/urdf_file.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = M_PI / 180;

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

void ReadFingers(const TomlFile& file, HandLayout* layout) {
  const toml::node* node = file.Require(file.root(), "finger");
  if (node == nullptr) return;
  const toml::array* fingers = node->as_array();
  if (fingers == nullptr || fingers->empty() ||
      fingers->size() > static_cast<std::size_t>(kMaxFingers))
    return file.Add(*node, "there must be 1 .. {} [[finger]] tables", kMaxFingers);
  std::set<std::string> names, tips;
  for (const toml::node& item : *fingers) {
    if (!item.is_table()) {
      file.Add(item, "finger must be an array of tables");
      continue;
    }
    const toml::table& finger = *item.as_table();
    file.CheckKeys(finger, {"name", "tip_link"});
    layout->fingers.push_back({file.Text(finger, "name"), file.Text(finger, "tip_link")});
    const HandLayout::Finger& read = layout->fingers.back();
    for (const std::string* text : {&read.name, &read.tip_link})
      if (const std::string fault = text->empty() ? "" : NameFault(*text); !fault.empty())
        file.Add(item, "the name \"{}\" {}", *text, fault);
    if (!read.name.empty() && !names.insert(read.name).second)
      file.Add(item, "finger name \"{}\" is used twice", read.name);
    if (!read.tip_link.empty() && !tips.insert(read.tip_link).second)
      file.Add(item, "tip_link \"{}\" is used twice", read.tip_link);
  }
}

void ReadCoupling(const TomlFile& file, const std::string& joint, const toml::node& node,
                  HandLayout* layout) {
  if (!node.is_table()) return file.Add(node, "coupled.{} must be a table", joint);
  const toml::table& table = *node.as_table();
  file.CheckKeys(table, {"driver", "ratio", "offset_deg"});
  HandLayout::Coupling& coupling = layout->coupled[joint];
  coupling.driver = file.Text(table, "driver");
  if (const toml::node* ratio = table.get("ratio"))
    coupling.ratio = file.Number(*ratio, "ratio", -100, 100);
  if (const toml::node* offset = table.get("offset_deg"))
    coupling.offset = file.Number(*offset, "offset_deg", -360, 360) * kDegree;
}

/// What a hand can be built with, whatever is wrong with it.
void ReadNumbers(const TomlFile& file, HandLayout* layout) {
  const toml::table& root = file.root();
  layout->armature = file.Number(root, "armature_kg_m2", 0, 0.1);
  if (const toml::node* damping = root.get("damping_nm_s_rad"))
    layout->damping = file.Number(*damping, "damping_nm_s_rad", 0, 10);
  if (const toml::node* least = root.get("least_damping_nm_s_rad"))
    layout->least_damping = file.Number(*least, "least_damping_nm_s_rad", 0, 10);
  if (!root.contains("palm")) return;
  const toml::table& palm = file.Table(root, "palm");
  file.CheckKeys(palm, {"rotation_deg", "position_m"});
  if (palm.contains("rotation_deg"))
    layout->X_HR.linear() =
        FromRotationVector(file.Vector(palm, "rotation_deg", 360) * kDegree).toRotationMatrix();
  if (palm.contains("position_m")) layout->X_HR.translation() = file.Vector(palm, "position_m", 10);
}

/// Fingers, and which joints move. False where something is wrong: no hand can be built then.
bool ReadJoints(const TomlFile& file, HandLayout* layout) {
  const std::size_t before = file.count();
  const toml::table& root = file.root();
  ReadFingers(file, layout);
  if (root.contains("locked_deg"))
    for (const auto& [joint, angle] : file.Table(root, "locked_deg"))
      layout->locked[std::string(joint.str())] =
          file.Number(angle, "locked_deg." + std::string(joint.str()), -360, 360) * kDegree;
  if (root.contains("coupled"))
    for (const auto& [joint, node] : file.Table(root, "coupled"))
      ReadCoupling(file, std::string(joint.str()), node, layout);
  return file.count() == before;
}

/// An angle within the limits of a joint [rad].
double ReadAngle(const TomlFile& file, const toml::node& node, const char* key,
                 const std::string& joint, double lower, double upper) {
  // An angle rounded to 0.01 deg must not be refused where it stands on a limit.
  constexpr double kSlack = 0.005 + 1e-9;
  const double degrees = file.Number(node, fmt::format("{}.{} [deg]", key, joint),
                                     lower / kDegree - kSlack, upper / kDegree + kSlack);
  return std::clamp(degrees * kDegree, lower, upper);
}

/// One angle per driven joint, by joint name.
JointVector ReadPosture(const TomlFile& file, const char* key, const HandModel& hand) {
  const toml::table& table = file.Table(file.root(), key);
  std::vector<std::string> names;
  for (int j = 0; j < hand.num_joints(); ++j)
    names.push_back(hand.joints[static_cast<std::size_t>(j)].name);
  file.CheckKeys(table, names);
  JointVector q(hand.num_joints());
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
    const toml::node* node = file.Require(table, joint.name.c_str());
    q[j] = node == nullptr ? joint.lower
                           : ReadAngle(file, *node, key, joint.name, joint.lower, joint.upper);
  }
  return q;
}

/// The same where no hand could be built: as far as its URDF tells, if it can be read.
void CheckPosture(const TomlFile& file, const char* key, const std::optional<UrdfFile>& urdf) {
  const toml::table& table = file.Table(file.root(), key);
  for (const auto& [name, node] : table) {
    double lower = -2 * M_PI, upper = 2 * M_PI;
    if (urdf) {
      const auto joint = std::ranges::find(urdf->joints, name.str(), &UrdfJoint::name);
      if (joint == urdf->joints.end()) continue;
      if (joint->type == UrdfJoint::Type::kRevolute && joint->lower < joint->upper)
        lower = joint->lower, upper = joint->upper;
    }
    ReadAngle(file, node, key, std::string(name.str().substr(0, 64)), lower, upper);
  }
  if (!urdf) return;
  std::vector<std::string> names;
  for (const UrdfJoint& joint : urdf->joints) names.push_back(joint.name);
  file.CheckKeys(table, names);
}

/// A hand's URDF as far as the scenario needs it.
struct ReadHand {
  std::optional<UrdfFile> urdf;
  std::optional<ModelError> refused;  ///< why not
};

ReadHand ReadHandUrdf(const fs::path& file) {
  try {
    Problems problems(file.string());
    UrdfFile urdf = ReadUrdf(file, &problems);
    problems.ThrowIfAny();
    return {std::move(urdf), {}};
  } catch (const ModelError& error) {
    return {{}, error};
  }
}

/// Throws the problems of a scenario with those of its hand, which could not be built.
void RefuseWithoutHand(const TomlFile& file, const ReadHand& hand) {
  for (const char* key : {"q_preshape_deg", "q_closed_deg"}) CheckPosture(file, key, hand.urdf);
  if (hand.refused) file.Add(*hand.refused);
  file.ThrowIfAny();
}

fs::path Beside(fs::path urdf_file) { return urdf_file.replace_extension(".toml"); }

/// The URDF that a scenario names, or the one beside it.
fs::path UrdfOf(const TomlFile& file, const fs::path& toml_file) {
  if (!file.root().contains("urdf")) return fs::path(toml_file).replace_extension(".urdf");
  const std::string named = file.Text(file.root(), "urdf");
  file.ThrowIfAny();
  const fs::path urdf = toml_file.parent_path() / named;  // an absolute one stays as it is
  if (!IsFile(urdf))
    throw ModelError::NoModel(
        fmt::format("{}: urdf = \"{}\": file not found", toml_file.string(), named));
  return urdf;
}

}  // namespace

HandFiles FindHandFiles(const std::string& hand, const std::vector<fs::path>& search_path) {
  fs::path toml_file = hand;
  if (toml_file.extension() == ".toml") {
    if (!IsFile(toml_file)) throw ModelError::NoModel(fmt::format("{}: file not found", hand));
    const fs::path urdf = UrdfOf(TomlFile(toml_file), toml_file);
    if (!IsFile(urdf))
      throw ModelError::NoModel(
          fmt::format("{}: there is no {} beside it; urdf = \"FILE.urdf\" names one", hand,
                      urdf.filename().string()));
    return {urdf, toml_file};
  }
  // A scenario of this name whose URDF stands elsewhere.
  if (fs::path(hand).filename() == hand && !hand.empty())
    for (const fs::path& directory : search_path) {
      toml_file = directory / "hands" / (hand + ".toml");
      if (!IsFile(fs::path(toml_file).replace_extension(".urdf")) && IsFile(toml_file))
        return {UrdfOf(TomlFile(toml_file), toml_file), toml_file};
      if (IsFile(toml_file)) break;
    }
  const fs::path urdf = FindModel(hand, "hands", search_path);
  toml_file = Beside(urdf);
  return {urdf, IsFile(toml_file) ? toml_file : fs::path()};
}

LoadedScenario LoadScenario(const std::string& hand, const std::string& object,
                            const std::vector<fs::path>& search_path, const LoadOptions& options) {
  HandFiles files;
  std::optional<ModelError> no_urdf;  // the rest of such a scenario is told with it
  try {
    files = FindHandFiles(hand, search_path);
  } catch (const ModelError& error) {
    if (fs::path(hand).extension() != ".toml" || !IsFile(hand)) throw;
    files.scenario = hand;
    no_urdf = error;
  }
  const auto& [urdf_file, toml_file] = files;
  if (toml_file.empty())
    throw ModelError::NoModel(fmt::format(
        "{}: scenario not found; a hand needs one beside its URDF: regrasp hand new {} -o {}",
        Beside(urdf_file).string(), urdf_file.string(), Beside(urdf_file).string()));
  const TomlFile file(toml_file);
  const toml::table& root = file.root();
  file.CheckKeys(
      root, {"object", "gravity_m_s2", "armature_kg_m2", "object_pose", "finger", "q_preshape_deg",
             "q_closed_deg", "palm", "locked_deg", "coupled", "damping_nm_s_rad",
             "least_damping_nm_s_rad", "inertia_from_shape", "fill_missing_meshes", "urdf"});
  LoadOptions of_hand = options;
  of_hand.inertia_from_shape |= file.Flag(root, "inertia_from_shape");
  of_hand.fill_missing_meshes |= file.Flag(root, "fill_missing_meshes");
  // A misspelt `locked_deg`, say: the hand without it would be blamed for what is in order.
  const bool sees_all = file.count() == 0;
  LoadedScenario loaded;
  Scenario& scenario = loaded.scenario;
  scenario.object = file.Text(root, "object");
  scenario.gravity_W = file.Vector(root, "gravity_m_s2", 100);
  const toml::table& pose = file.Table(root, "object_pose");
  if (root.contains("object_pose")) {
    file.CheckKeys(pose, {"position_m", "rotation_deg"});
    scenario.X_WO.translation() = file.Vector(pose, "position_m", 10);
    if (pose.contains("rotation_deg"))
      scenario.X_WO.linear() =
          FromRotationVector(file.Vector(pose, "rotation_deg", 360) * kDegree).toRotationMatrix();
  }
  HandLayout layout;
  ReadNumbers(file, &layout);
  bool can_build = ReadJoints(file, &layout) && sees_all;
  ReadHand read = no_urdf ? ReadHand{{}, no_urdf} : ReadHandUrdf(urdf_file);
  if (read.urdf) {
    const std::size_t before = file.count();
    CheckScenarioNames(file, *read.urdf, sees_all);
    can_build = can_build && file.count() == before;
  }
  if (!can_build || read.refused) RefuseWithoutHand(file, read);
  try {
    loaded.hand = LoadHand(urdf_file, layout, of_hand, &loaded.report);
  } catch (const ModelError& error) {
    read.refused = error;
    RefuseWithoutHand(file, read);
  }
  loaded.hand.name = toml_file.stem().string();
  scenario.name = scenario.hand = loaded.hand.name;
  scenario.q_preshape = ReadPosture(file, "q_preshape_deg", loaded.hand);
  scenario.q_closed = ReadPosture(file, "q_closed_deg", loaded.hand);
  file.ThrowIfAny();
  // What the scenario says of its models counts for its own object, whose file is named from there.
  // One that is not there is looked for as any other.
  std::error_code error;
  const fs::path beside = toml_file.parent_path() / scenario.object;
  const bool is_beside = beside.extension() == ".urdf" && fs::exists(beside, error);
  loaded.object = object.empty() ? LoadObject(is_beside ? beside.string() : scenario.object,
                                              search_path, of_hand, &loaded.report)
                                 : LoadObject(object, search_path, options, &loaded.report);
  return loaded;
}

ObjectModel LoadObject(const std::string& object, const std::vector<fs::path>& search_path,
                       const LoadOptions& options, ModelReport* report) {
  return LoadObjectFile(FindModel(object, "objects", search_path), options, report);
}

std::vector<std::string> ListObjects(const std::vector<fs::path>& search_path) {
  return ListModels(search_path, "objects");
}

}  // namespace regrasp
