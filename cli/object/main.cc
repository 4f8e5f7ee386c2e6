// regrasp-object: what `regrasp object` does that needs meshes or pictures. `regrasp` checks the
// arguments and executes it.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/files/json_text.h"
#include "core/files/names.h"
#include "core/files/output_file.h"
#include "core/hand/model_path.h"
#include "core/hand/object_loader.h"
#include "core/hand/solid.h"
#include "core/protocol/errors.h"
#include "snapshots/plot_object.h"

namespace regrasp::object {
namespace {

using Json = nlohmann::ordered_json;
using Options = std::map<std::string, std::string>;

/// An object as the file has it, and why it would be refused.
struct Shown {
  std::filesystem::path file;
  ObjectModel object;
  ObjectFacts facts;
  std::vector<std::string> warnings, refusals;
};

std::vector<std::string> Lines(const std::string& message) {
  std::vector<std::string> lines;
  std::istringstream text(message);
  for (std::string line; std::getline(text, line);) {
    if (line.ends_with(" errors:")) continue;
    lines.push_back(line.substr(std::min(line.size(), line.find_first_not_of(' '))));
  }
  return lines;
}

/// A body that is refused is shown as the file tells it. Throws ModelError where that cannot be.
Shown Load(const std::string& name, LoadOptions options) {
  Shown shown;
  shown.file = FindModel(name, "objects", ModelSearchPath(""));
  const auto load = [&] {
    ModelReport report;
    shown.object = LoadObjectFile(shown.file, options, &report, &shown.facts);
    for (const ModelWarning& warning : report.warnings) shown.warnings.push_back(warning.Line());
  };
  try {
    load();
    return shown;
  } catch (const ModelError& error) {
    shown.refusals = Lines(error.what());
    options.force = options.inertia_as_told = true;
    try {
      load();
    } catch (const ModelError&) {
      throw error;
    }
  }
  return shown;
}

Vector3d Size(const ObjectModel& object) {
  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
      return Vector3d::Constant(2 * object.radius);
    case ObjectModel::Kind::kBox:
      return 2 * object.half_extents;
    case ObjectModel::Kind::kMesh:
      break;
  }
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : object.vertices_O) box.extend(v);
  return box.sizes();
}

const char* KindName(ObjectModel::Kind kind) {
  if (kind == ObjectModel::Kind::kSphere) return "sphere";
  return kind == ObjectModel::Kind::kBox ? "box" : "mesh";
}

Json ToJson(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json Describe(const Shown& shown) {
  const ObjectModel& o = shown.object;
  const Solid solid = ObjectSolid(o);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(o.I_OCom);
  const double density = o.mass / solid.volume;
  Json inertia, moments, axes;
  if (shown.facts.inertia_told) moments = ToJson(principal.eigenvalues());
  for (int k = 0; shown.facts.inertia_told && k < 3; ++k) {
    inertia.push_back(ToJson(o.I_OCom.row(k)));
    axes.push_back(ToJson(principal.eigenvectors().col(k)));
  }
  return {{"object", o.name},
          {"file", shown.file.string()},
          {"accepted", shown.refusals.empty()},
          {"shape", KindName(o.kind)},
          {"size_m", ToJson(Size(o))},
          {"bounding_radius_m", o.bounding_radius},
          {"closed", true},  // one that is not is refused before
          {"collisions", shown.facts.collisions},
          {"pieces", shown.facts.pieces},
          {"triangles", o.triangles.size()},
          {"volume_m3", solid.volume},
          {"overlap_m3", shown.facts.overlap_m3},
          {"mass_kg", o.mass},
          {"density_kg_m3", density},
          {"friction", o.friction},
          {"centre_of_mass_m", ToJson(shown.facts.p_LCom)},
          {"middle_of_volume_m", ToJson(shown.facts.p_LCom + solid.centre)},
          {"inertia_kg_m2", inertia},
          {"principal_moments_kg_m2", moments},
          {"principal_axes", axes},
          {"homogeneous_moments_kg_m2", ToJson(PrincipalMoments(solid.inertia * density))},
          {"warnings", shown.warnings},
          {"refusals", shown.refusals}};
}

std::string Three(const Json& v, double scale, bool rounded = false) {
  const auto number = [&](std::size_t k) {
    const double value = v[k].get<double>() * scale;
    return rounded ? fmt::format("{:.3f}", std::abs(value) < 5e-4 ? 0.0 : value)
                   : fmt::format("{:.4g}", value);
  };
  return number(0) + ", " + number(1) + ", " + number(2);
}

/// What is said of it: for the terminal and for the picture.
std::vector<TableRow> Table(const Json& json) {
  const auto number = [&](const char* key) { return json[key].get<double>(); };
  std::vector<TableRow> rows = {
      {"shape", json["shape"].get<std::string>() + ", closed"},
      {"pieces", fmt::format("{} in {} <collision>, {} triangles", json["pieces"].get<int>(),
                             json["collisions"].get<int>(), json["triangles"].get<int>())},
      {"size", Three(json["size_m"], 1e3) + " mm"},
      {"reach",
       fmt::format("{:.4g} mm from the centre of mass", number("bounding_radius_m") * 1e3)},
      {"mass", fmt::format("{:.4g} g", number("mass_kg") * 1e3)},
      {"volume", fmt::format("{:.4g} cm³", number("volume_m3") * 1e6)},
      {"density", DensityText(number("density_kg_m3"))},
      {"centre", Three(json["centre_of_mass_m"], 1e3, true) + " mm in the file"},
      {"of volume", Three(json["middle_of_volume_m"], 1e3, true) + " mm", true},
      {"moments", json["principal_moments_kg_m2"].is_null()
                      ? "none in the file"
                      : Three(json["principal_moments_kg_m2"], 1e6) + " kg mm²"},
      {"if uniform", Three(json["homogeneous_moments_kg_m2"], 1e6) + " kg mm²", true},
      {"friction", fmt::format("{:g}", number("friction"))}};
  if (number("overlap_m3") > 0)
    rows.insert(
        rows.begin() + 6,
        {"overlap", fmt::format("{:.4g} cm³, counted once", number("overlap_m3") * 1e6), true});
  return rows;
}

ExitCode Show(const std::string& name, const Options& given) {
  if (const auto picture = given.find("--output"); picture != given.end())
    CheckWritable(picture->second, Draft::Existing::kReplace);
  LoadOptions options;
  options.force = given.contains("--force");
  options.inertia_from_shape = given.contains("--inertia-from-shape");
  const Shown shown = Load(name, options);
  Json json = Describe(shown);
  const std::vector<TableRow> table = Table(json);
  if (const auto picture = given.find("--output"); picture != given.end()) {
    PlotObject(shown.object, table, {}, picture->second);
    json["picture"] = picture->second;
  }
  if (given.contains("--quiet")) return shown.refusals.empty() ? ExitCode::kOk : ExitCode::kFailed;
  if (given.contains("--json")) {
    fmt::print("{}\n", JsonText(json));
  } else {
    fmt::print("{}\n", shown.file.string());
    for (const TableRow& row : table)
      fmt::print("  {:<13}{}\n", (row.below ? "  " : "") + row.name, row.value);
    for (const std::string& warning : shown.warnings) fmt::print("  warning: {}\n", warning);
    for (const std::string& refusal : shown.refusals) fmt::print("  refused: {}\n", refusal);
    if (json.contains("picture")) fmt::print("{}\n", json["picture"].get<std::string>());
  }
  if (std::fflush(stdout) != 0)
    throw std::runtime_error(std::string("cannot write to standard output: ") +
                             std::strerror(errno));
  return shown.refusals.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

int Fail(const Options& given, const std::string& message, ExitCode code) {
  constexpr const char* kNext = "regrasp help object show";
  if (given.contains("--json"))
    fmt::print(stderr, "{}\n", JsonText(Json{{"error", {{"message", message}, {"hint", kNext}}}}));
  else
    fmt::print(stderr, "regrasp: {}\n  try: {}\n", message, kNext);
  return static_cast<int>(code);
}

int Main(int argc, char** argv) {
  Options given;
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--output" && i + 1 < argc)
      given[argument] = argv[++i];
    else if (argument.starts_with("--"))
      given[argument] = "";
    else
      words.push_back(argument);
  }
  try {
    if (words.size() != 2 || words[0] != "show")
      return Fail(given, "regrasp-object show FILE is the only way to run this", ExitCode::kUsage);
    return static_cast<int>(Show(words[1], given));
  } catch (const ModelError& e) {
    return Fail(given, e.what(), e.names_no_model ? ExitCode::kNotFound : ExitCode::kFailed);
  } catch (const std::exception& e) {
    return Fail(given, ShownText(e.what()), ExitCode::kIo);
  }
}

}  // namespace
}  // namespace regrasp::object

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error, not the end
  return regrasp::object::Main(argc, argv);
}
