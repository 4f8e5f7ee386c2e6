#include "core/hand/scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include "core/hand/urdf.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = M_PI / 180;

int EditDistance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitute = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

std::string Nearest(std::string_view name, const std::vector<std::string>& allowed) {
  const auto best = std::min_element(
      allowed.begin(), allowed.end(),
      [&](const auto& a, const auto& b) { return EditDistance(name, a) < EditDistance(name, b); });
  return best == allowed.end() ? "" : *best;
}

/// A TOML file whose every refusal names file, line, key, value and what is allowed.
class TomlFile {
 public:
  explicit TomlFile(const fs::path& path) : path_(path) {
    try {
      root_ = toml::parse_file(path.string());
    } catch (const toml::parse_error& error) {
      throw ModelError(fmt::format("{}:{}: not valid TOML: {}", path.string(),
                                   error.source().begin.line, error.description()));
    }
  }
  const toml::table& root() const { return root_; }

  template <typename... Args>
  [[noreturn]] void Fail(const toml::node& at, fmt::format_string<Args...> format,
                         Args&&... args) const {
    throw ModelError(fmt::format("{}:{}: ", path_.string(), at.source().begin.line) +
                     fmt::format(format, std::forward<Args>(args)...));
  }
  void CheckKeys(const toml::table& table, const std::vector<std::string>& allowed) const {
    for (const auto& [key, value] : table)
      if (std::find(allowed.begin(), allowed.end(), key.str()) == allowed.end())
        throw ModelError(fmt::format("{}:{}: unknown key \"{}\"; nearest is \"{}\"; allowed are {}",
                                     path_.string(), key.source().begin.line, key.str(),
                                     Nearest(key.str(), allowed), fmt::join(allowed, ", ")));
  }
  const toml::node& Require(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) Fail(table, "key \"{}\" is missing", key);
    return *node;
  }
  double Number(const toml::node& node, std::string_view key, double min, double max) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) Fail(node, "{} must be a number", key);
    if (!(*value >= min && *value <= max))
      Fail(node, "{} = {:.6g}; allowed {:.6g} .. {:.6g}", key, *value, min, max);
    return *value;
  }
  std::string Text(const toml::table& table, const char* key) const {
    const toml::node& node = Require(table, key);
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty()) Fail(node, "{} must be a string that is not empty", key);
    return *value;
  }
  const toml::table& Table(const toml::table& table, const char* key) const {
    const toml::node& node = Require(table, key);
    if (!node.is_table()) Fail(node, "{} must be a table", key);
    return *node.as_table();
  }
  /// Each component within +-limit.
  Vector3d Vector(const toml::table& table, const char* key, double limit) const {
    const toml::node& node = Require(table, key);
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 3) Fail(node, "{} must be an array of 3 numbers", key);
    Vector3d v;
    for (int i = 0; i < 3; ++i)
      v[i] = Number(*array->get(static_cast<std::size_t>(i)), key, -limit, limit);
    return v;
  }

 private:
  fs::path path_;
  toml::table root_;
};

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool IsDirectory(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::vector<std::string> ListModels(const std::vector<fs::path>& search_path, const char* kind) {
  std::set<std::string> names;
  for (const fs::path& directory : search_path) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory / kind, ignored))
      if (entry.path().extension() == ".urdf") names.insert(entry.path().stem().string());
  }
  return {names.begin(), names.end()};
}

/// The URDF file of a model given by name or as a file. `kind`: "hands" or "objects".
fs::path FindModel(const std::string& name, const char* kind,
                   const std::vector<fs::path>& search_path) {
  if (name.ends_with(".urdf")) {
    if (IsFile(name)) return name;
    throw ModelError(fmt::format("{}: file not found", name));
  }
  // A name is one path component, so that it cannot lead out of the search path.
  if (!name.empty() && fs::path(name).filename() == name)
    for (const fs::path& directory : search_path) {
      const fs::path file = directory / kind / (name + ".urdf");
      if (IsFile(file)) return file;
    }
  std::vector<std::string> directories;
  for (const fs::path& directory : search_path) directories.push_back((directory / kind).string());
  throw ModelError(fmt::format("there is no model \"{}\" in {}; available are {}", name,
                               fmt::join(directories, ", "),
                               fmt::join(ListModels(search_path, kind), ", ")));
}

HandLayout ReadLayout(const TomlFile& file) {
  HandLayout layout;
  layout.armature =
      file.Number(file.Require(file.root(), "armature_kg_m2"), "armature_kg_m2", 0, 0.1);
  const toml::node& node = file.Require(file.root(), "finger");
  const toml::array* fingers = node.as_array();
  if (fingers == nullptr || fingers->empty() ||
      fingers->size() > static_cast<std::size_t>(kMaxFingers))
    file.Fail(node, "there must be 1 .. {} [[finger]] tables", kMaxFingers);
  std::set<std::string> names, tips;
  for (const toml::node& item : *fingers) {
    if (!item.is_table()) file.Fail(item, "finger must be an array of tables");
    const toml::table& finger = *item.as_table();
    file.CheckKeys(finger, {"name", "tip_link"});
    layout.fingers.push_back({file.Text(finger, "name"), file.Text(finger, "tip_link")});
    if (!names.insert(layout.fingers.back().name).second)
      file.Fail(item, "finger name \"{}\" is used twice", layout.fingers.back().name);
    if (!tips.insert(layout.fingers.back().tip_link).second)
      file.Fail(item, "tip_link \"{}\" is used twice", layout.fingers.back().tip_link);
  }
  return layout;
}

/// One angle per joint, by joint name.
JointVector ReadPosture(const TomlFile& file, const char* key, const HandModel& hand) {
  const toml::table& table = file.Table(file.root(), key);
  std::vector<std::string> names;
  for (const Joint& joint : hand.joints) names.push_back(joint.name);
  file.CheckKeys(table, names);
  JointVector q(hand.num_joints());
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[j];
    // Limits rounded to decimals of a radian must not refuse a posture that stands on them.
    const double slack = 1e-4;
    const double degrees = file.Number(
        file.Require(table, joint.name.c_str()), fmt::format("{}.{} [deg]", key, joint.name),
        joint.lower / kDegree - slack, joint.upper / kDegree + slack);
    q[j] = std::clamp(degrees * kDegree, joint.lower, joint.upper);
  }
  return q;
}

fs::path Beside(fs::path urdf_file) { return urdf_file.replace_extension(".toml"); }

}  // namespace

std::vector<fs::path> ModelSearchPath(const std::string& models_dir) {
  std::vector<fs::path> path;
  const auto add = [&](const fs::path& directory) {
    std::error_code ignored;
    const fs::path clean = fs::weakly_canonical(directory, ignored);
    if (IsDirectory(clean) && std::find(path.begin(), path.end(), clean) == path.end())
      path.push_back(clean);
  };
  if (!models_dir.empty()) {
    if (!IsDirectory(models_dir))
      throw ModelError(fmt::format("{}: models directory not found", models_dir));
    add(models_dir);
  }
  if (const char* named = std::getenv("REGRASP_MODELS_DIR"); named != nullptr && *named != '\0') {
    if (!IsDirectory(named))
      throw ModelError(fmt::format("{}: $REGRASP_MODELS_DIR is not a directory", named));
    add(named);
  }
  add(REGRASP_SOURCE_MODELS_DIR);
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) add(program.parent_path().parent_path() / "share/regrasp/models");
  add(REGRASP_INSTALLED_MODELS_DIR);
  return path;
}

LoadedScenario LoadScenario(const std::string& hand, const std::string& object,
                            const std::vector<fs::path>& search_path) {
  const fs::path urdf_file = FindModel(hand, "hands", search_path);
  const fs::path toml_file = Beside(urdf_file);
  if (!IsFile(toml_file))
    throw ModelError(fmt::format("{}: scenario not found; a hand needs one beside its URDF",
                                 toml_file.string()));
  const TomlFile file(toml_file);
  file.CheckKeys(file.root(), {"object", "gravity_m_s2", "armature_kg_m2", "object_pose", "finger",
                               "q_preshape_deg", "q_closed_deg"});

  LoadedScenario loaded;
  loaded.hand = LoadHand(urdf_file, ReadLayout(file));
  loaded.hand.name = urdf_file.stem().string();
  Scenario& scenario = loaded.scenario;
  scenario.name = scenario.hand = loaded.hand.name;
  scenario.object = file.Text(file.root(), "object");
  scenario.gravity_W = file.Vector(file.root(), "gravity_m_s2", 100);
  const toml::table& pose = file.Table(file.root(), "object_pose");
  file.CheckKeys(pose, {"position_m", "rotation_deg"});
  scenario.X_WO.translation() = file.Vector(pose, "position_m", 10);
  if (pose.contains("rotation_deg"))
    scenario.X_WO.linear() =
        FromRotationVector(file.Vector(pose, "rotation_deg", 360) * kDegree).toRotationMatrix();
  scenario.q_preshape = ReadPosture(file, "q_preshape_deg", loaded.hand);
  scenario.q_closed = ReadPosture(file, "q_closed_deg", loaded.hand);
  loaded.object = LoadObject(object.empty() ? scenario.object : object, search_path);
  return loaded;
}

ObjectModel LoadObject(const std::string& object, const std::vector<fs::path>& search_path) {
  const fs::path urdf_file = FindModel(object, "objects", search_path);
  ObjectModel model = LoadObjectUrdf(urdf_file);
  model.name = urdf_file.stem().string();
  if (const fs::path toml_file = Beside(urdf_file); IsFile(toml_file)) {
    const TomlFile file(toml_file);
    file.CheckKeys(file.root(), {"friction"});
    model.friction = file.Number(file.Require(file.root(), "friction"), "friction", 1e-3, 1);
  }
  return model;
}

std::vector<std::string> ListObjects(const std::vector<fs::path>& search_path) {
  return ListModels(search_path, "objects");
}

}  // namespace regrasp
